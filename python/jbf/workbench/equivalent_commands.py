"""Commands and Python code equivalent to the steps of a session."""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pprint import pformat
from typing import Any

TRIMMED = "trimmed"
WIDTH = 88


@dataclass(frozen=True)
class Steps:
    """Steps of a session before the first model: rig, runs, import and trims.

    Attributes
    ----------
    rig, runs
        Names of the rig file and of the files of the used runs.
    imported
        Recordings from which the runs were imported; empty if they were opened directly.
    map
        Map of that import.
    out
        Output folder of that import.
    trims
        Used interval of each trimmed run, s.
    """

    rig: str
    runs: Sequence[str]
    imported: Sequence[str] = ()
    map: str = ""
    out: str = ""
    trims: Mapping[str, tuple[float, float]] = field(default_factory=dict)


def commands(node: Mapping[str, Any] | None, steps: Steps) -> str:
    """`jbf` commands that lead to a model (`node`); without a model, those for the runs alone."""
    lines = []
    if steps.imported:
        files = shlex.join(steps.imported)
        into = f"--map {shlex.quote(steps.map)} --folder {shlex.quote(steps.out)}"
        lines.append(f"jbf import {files} {into} --force")
    if steps.trims:
        lines.append("# trimmed/ is saved in section 4 (Export): Trimmed runs")
    files = shlex.join([steps.rig, *([TRIMMED] if steps.trims else steps.runs)])
    if node is None:
        lines.append(f"jbf diagnose {files} --out model.toml --report report.html")
    elif "diagnosis" in node:
        law = node.get("asked_law", node["law"])
        lines.append(f"jbf diagnose {files} --law {law} --out model.toml --report report.html")
    else:
        effects = f" --effects {','.join(node['effects'])}" if node["effects"] else ""
        options = "".join(
            f" --{option} {shlex.quote(f'{name}={value!r}')}"
            for option, key in (("fix", "fixed"), ("start", "start"))
            for name, value in node.get("settings", {}).get(key, {}).items()
        )
        options += "".join(
            f" --bounds {shlex.quote(f'{name}={low!r}:{high!r}')}"
            for name, (low, high) in node.get("settings", {}).get("bounds", {}).items()
        )
        lines.append(f"jbf fit {files} --law {node['law']}{effects}{options} --out model.toml")
    return "\n".join(lines)


def python(node: Mapping[str, Any] | None, steps: Steps) -> str:
    """Python code that leads to a model (`node`); without a model, that for the runs alone."""
    lines = ["import jbf", ""]
    if steps.imported:
        into = f", {steps.map!r}, {steps.out!r}, replace_folder=True)"
        lines.append(_call("jbf.import_files(", steps.imported, into))
    lines.append(f"rig = jbf.read_rig({steps.rig!r})")
    lines.append(_call("runs = jbf.read_runs(", steps.runs, ", rig)"))
    if steps.trims:
        lines += [
            f"trims = {dict(steps.trims)!r}",
            "runs = [",
            "    r.select((r.time_s >= trims[r.name][0]) & (r.time_s <= trims[r.name][1]))",
            "    if r.name in trims else r",
            "    for r in runs",
            "]",
        ]
    if node is None or "diagnosis" in node:
        law = "" if node is None else f", law={node.get('asked_law', node['law'])!r}"
        lines.append(f"found = jbf.diagnose(rig, runs{law})")
    else:
        effects = f", {list(node['effects'])!r}" if node["effects"] else ""
        settings = "".join(
            f", {key}={value!r}" for key, value in node.get("settings", {}).items() if value
        )
        lines.append(f"found = jbf.fit(rig, runs{effects}, law={node['law']!r}{settings})")
    return "\n".join([*lines, "print(found.summary())", 'found.model.save("model.toml")'])


def _call(head: str, files: Sequence[str], tail: str) -> str:
    """Format a call with a list of files, one line per file if the list is long."""
    formatted = pformat(list(files), width=WIDTH - len(head))
    return head + formatted.replace("\n", "\n" + " " * len(head)) + tail
