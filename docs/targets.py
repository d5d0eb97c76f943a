"""Write the table of export targets, docs/reference/targets.md: `.venv/bin/python docs/targets.py`.

Every entry is the status in the ledger of an export of a model with that law or effect.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from pathlib import Path

import jbf
import numpy as np
from jbf.export import TARGETS, Settings, to
from jbf.models.catalogue import built_in, built_in_laws, reason_not_applicable
from jbf.reporting.export_text import STATUS

PAGE = Path(__file__).resolve().parent / "reference" / "targets.md"
HEAD = """# Export targets and what they carry

This page lists what each target of `jbf export --to` carries, for users who choose a target.
Every entry is the status in the ledger of an export of a model with that law or effect and the
starting values of the catalogue. The ledger of your export can differ where a term depends on its
values. It lists every term with its values, and the error is computed along your runs.

[Measured losses](target_losses.md) has the error of each law in each target.

*(Written by `docs/targets.py`.)*

| status | meaning |
| --- | --- |
| exact | the same equation and values |
| approximate | another equation, whose values are fitted or interpolated |
| not carried | no element of the target; the loss contains the term |
| not included | another part of the target (mass, weight, spring), or a property of the \
recording; not part of the loss |
| refused | the target has no form for this rig, law or effect |
"""
RIGS: Mapping[bool, jbf.Rig] = {
    True: jbf.Rig.thesis(),
    False: jbf.Rig(drive=jbf.Drive("rotary", "torque")),
}
"""The rig of a model, by whether its law needs a bearing."""


def motion(rig: jbf.Rig) -> jbf.Run:
    """Return a motion with all columns that an effect can need."""
    time_s = np.arange(0.0, 8.0, 0.02)
    velocity = 0.3 * np.sin(time_s) * (1.0 + 0.3 * np.sin(0.3 * time_s))
    path = np.concatenate([[0.0], np.cumsum(0.01 * (velocity[1:] + velocity[:-1]))])
    return jbf.Run.from_arrays(
        time_s,
        velocity,
        angle_rad=path / (rig.radius_m or 1.0),
        load_n=100.0 + 20.0 * np.sin(0.7 * time_s),
        temperature_c=30.0 + time_s,
    )


def statuses(law: str, effect: str | None = None) -> dict[str, str]:
    """Return the status of a law, or of an effect that is added to it, by target."""
    rig = RIGS[built_in_laws()[law].needs_bearing]
    names = [] if effect is None else [effect]
    if effect is not None and built_in()[effect].further_of is not None:
        names.append(built_in()[effect].further_of)
    values = {f"{n}.{p.name}": p.starts[0] for n in names for p in built_in()[n].parameters}
    if "cogging.pitch" in values:
        values["cogging.pitch"] = values["cogging_2.pitch"] = 2.0 * np.pi / 20.0
    values = {name: value for name, value in values.items() if name.partition(".")[0] in names}
    model = jbf.Model(rig, law, names, values)
    result = {}
    for target in TARGETS.values():
        try:
            ledger = to(model, target.name, [motion(rig)], settings=Settings()).ledger
            result[target.name] = STATUS[ledger.term(effect or law).status]
        except jbf.InputError:
            result[target.name] = "refused"
    return result


def law_for(effect: str) -> str:
    """Return a law that an effect can be combined with, `coulomb` if possible."""
    laws = ("coulomb", "lugre", "journal")
    return next(law for law in laws if reason_not_applicable(built_in()[effect], law) is None)


def page() -> str:
    """Return the text of docs/reference/targets.md."""
    names = [*TARGETS]
    lines = [HEAD, "| target | form |", "| --- | --- |"]
    lines += [f"| `{target.name}` | {target.summary} |" for target in TARGETS.values()]
    rule = "| --- |" + " --- |" * len(names)
    for title, rows in (
        ("law", [(law, statuses(law)) for law in built_in_laws()]),
        ("effect", [(name, statuses(law_for(name), name)) for name in built_in()]),
    ):
        lines += ["", f"## {title.capitalize()}s", f"| {title} | {' | '.join(names)} |", rule]
        for name, row in rows:
            link = f"../effects/{name}.md" if title == "effect" else f"../laws.md#{name}"
            lines.append(f"| [{name}]({link}) | {' | '.join(row[n] for n in names)} |")
    return "\n".join([*lines, ""])


if __name__ == "__main__":
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        PAGE.write_text(page(), encoding="utf-8")
