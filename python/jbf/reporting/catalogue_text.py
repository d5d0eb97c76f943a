"""Catalogue of effects as plain text: a list of all effects, or the page of one effect."""

from __future__ import annotations

from collections.abc import Iterable

from jbf.models.catalogue import Effect, Parameter, built_in, find_law, reason_not_applicable
from jbf.records.quantities import BEARING, LINEAR, Quantities
from jbf.reporting.effect_words import summary_of
from jbf.reporting.paragraphs import columns, hanging

REQUIREMENTS = {
    "transmitted": "another effect whose force the drive transmits: gravity, spring, inertia",
    "angle": "the column angle_rad in every run",
    "path": "the column angle_rad, or position_m on a linear axis, in every run",
    "position": "the column angle_rad or position_m in every run",
    "temperatures": "the column temperature_c in every run, with different temperatures",
    "loads": "runs at several loads (load_n, pressure_pa on an axis without a bearing, "
    "or load_n_m on a rotary drive)",
}


def refused_words(effect: Effect) -> str:
    """List the laws with which an effect cannot be combined, with the reasons."""
    reasons = dict.fromkeys(effect.refused.values())
    return "; ".join(
        f"{', '.join(law for law, r in effect.refused.items() if r == reason)} ({reason})"
        for reason in reasons
    )


def effects_page(
    pages: Iterable[Effect], law: str | None = None, quantities: Quantities = BEARING
) -> str:
    """List the effects in the order of the signal chain, one line each, under a heading per stage.

    Parameters
    ----------
    pages
        Catalogue entries of the effects.
    law
        If given, effects that cannot be combined with this law follow in a separate block, each
        with the reason. The quantities are then those of a bearing if the law needs one, otherwise
        those of a linear axis.
    quantities
        Names of the motion and of the measured quantity. Overridden if `law` is given.
    """
    pages = list(pages)
    if law is not None:
        reasons_of = {e.name: reason_not_applicable(e, law) for e in pages}
        refused = {name: reason for name, reason in reasons_of.items() if reason is not None}
        quantities = BEARING if find_law(law).needs_bearing else LINEAR
        applicable = effects_page([e for e in pages if e.name not in refused], None, quantities)
        widest = max(map(len, refused), default=0)
        reasons = [x for n, r in refused.items() for x in hanging(f"{n:<{widest}}  ", r)]
        head = ["", f"[not with {law}: the law ...]"] if reasons else []
        return "\n".join([applicable, *head, *reasons])
    widest = max((len(e.name) for e in pages), default=0)
    lines: list[str] = []
    stage = None
    for effect in pages:
        prefix = "" if effect.name in built_in() else "user-defined, "
        if prefix + effect.stage != stage:
            stage = prefix + effect.stage
            lines += ([""] if lines else []) + [f"[{stage}]"]
        lines += hanging(f"{effect.name:<{widest}}  ", summary_of(effect, quantities))
    return "\n".join(lines)


def effect_page(effect: Effect) -> str:
    """Format all catalogue data of one effect."""
    lines = [f"{effect.name}: {effect.summary}", ""]
    facts = [
        ("stage", effect.stage),
        ("equation", effect.equation),
        ("source", effect.source),
        ("limits", effect.limits),
    ]
    for need, words in REQUIREMENTS.items():
        if need in effect.needs:
            facts.append(("needs", words))
    if effect.columns:
        facts.append(("columns", ", ".join(effect.columns)))
    if effect.refused:
        facts.append(("not with", refused_words(effect)))
    for name, words in facts:
        lines += hanging(f"{name:<10}", words)
    head = ("parameter", "unit", "from", "to", "vanishes at", "meaning")
    rows = columns([head, *map(_parameter_row, effect.parameters)], "<<>>><")
    return "\n".join([*lines, "", *rows])


def _parameter_row(p: Parameter) -> tuple[str, str, str, str, str, str]:
    null = "" if p.null is None else f"{p.null:g}"
    return p.name, p.unit, f"{p.lower:g}", f"{p.upper:g}", null, meaning_of(p)


def meaning_of(p: Parameter) -> str:
    """Description of a parameter, marked if the user provides its value."""
    return f"{p.meaning} (specified, not fitted)" if p.stated else p.meaning
