"""Each step as the command and the lines of Python that do the same."""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence
from typing import Any

Trims = Mapping[str, tuple[float, float]]


def commands(node: Mapping[str, Any], rig: str, runs: Sequence[str], trims: Trims) -> str:
    """The `jbf` command of a model; a note where the runs were trimmed on the bench."""
    files = [rig, *runs]
    note = ""
    if trims:
        note = "# the trimmed runs: Keep, Save trimmed runs\n"
        files = [rig, "trimmed"]
    named = " ".join(shlex.quote(file) for file in files)
    law = f" --law {node['law']}"
    if "diagnosis" in node:
        return f"{note}jbf diagnose {named}{law} --out model.toml --report report.html"
    effects = f" --effects {','.join(node['effects'])}" if node["effects"] else ""
    return f"{note}jbf fit {named}{law}{effects} --out model.toml"


def python(node: Mapping[str, Any], rig: str, runs: Sequence[str], trims: Trims) -> str:
    """The same in Python."""
    lines = [
        "import jbf",
        "",
        f"rig = jbf.read_rig({rig!r})",
        f"runs = jbf.read_runs({list(runs)!r}, rig)",
    ]
    if trims:
        lines += [
            f"trims = {dict(trims)!r}",
            "runs = [",
            "    r.select((r.time_s >= trims[r.name][0]) & (r.time_s <= trims[r.name][1]))",
            "    if r.name in trims else r",
            "    for r in runs",
            "]",
        ]
    law = f", law={node['law']!r}"
    if "diagnosis" in node:
        lines += [f"found = jbf.diagnose(rig, runs{law})", "print(found.summary())"]
    else:
        effects = f", {list(node['effects'])!r}" if node["effects"] else ""
        lines += [f"found = jbf.fit(rig, runs{effects}{law})", "print(found.summary())"]
    return "\n".join([*lines, 'found.model.save("model.toml")'])
