"""Content of a session as JSON data: one rig with its runs, trims and models."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import PurePath
from typing import Any

from jbf.errors import InputError
from jbf.workbench.bench import Bench
from jbf.workbench.files import Folder
from jbf.workbench.models import Models

Content = dict[str, Any]
Key = tuple[str, tuple[str, ...]]
"""Names of the files of a rig and of its runs."""
_RENAMED = {
    "power": {"found": "detectable", "alone": "distinguishable", "like": "confounded_with"},
    "directions": {"way": "direction"},
}
"""Current keys of the rows of two tables, by their key in older session files."""


def key_of(rig: str, runs: Sequence[str]) -> Key:
    """Key of a rig and its runs, in any order."""
    return rig, tuple(sorted(runs))


def content_of(bench: Bench, models: Models, law: str) -> Content:
    """Files and names of rig and runs, trims, and all models.

    The name of a run contains folders if two files have the same stem, so that it may change when
    the files are moved.
    """
    return {
        "rig": bench.rig_name,
        "runs": list(bench.run_names),
        "run_names": [run.name for run in bench.runs],
        "trims": dict(bench.trims),
        "excluded": sorted(bench.excluded),
        "law": law,
        "current": models.current,
        "models": [
            {k: v for k, v in node.items() if k != "records"} for node in models.nodes.values()
        ],
    }


def key_of_content(content: Mapping[str, Any]) -> Key:
    """Key of the rig and the runs of a content."""
    return key_of(str(content["rig"]), list(map(str, content["runs"])))


def read_content(
    folder: Folder,
    content: Content,
    place: PurePath,
    progress: Callable[[str, int, int], None] | None = None,
) -> tuple[Bench, Models, str]:
    """Read the rig and the runs of a content, and return these, the models and the law.

    Raises
    ------
    InputError
        The content, which was read from `place`, is not complete, or names files that do not exist.
    """
    try:
        run_names = [str(name) for name in content["runs"]]
        bench = Bench.read(folder, str(content["rig"]), run_names, progress)
        current_names = [run.name for run in bench.runs]
        # Older session files have no names.
        saved_names = map(str, content.get("run_names", current_names))
        names = dict(zip(saved_names, current_names, strict=True))
        for name, span in content["trims"].items():
            bench.trim(names[name], (float(span[0]), float(span[1])))
        for name in content["excluded"]:
            bench.leave_out(names[name], True)
        models = Models({int(node["id"]): _node(node, names) for node in content["models"]})
        models.choose(content["current"])
        return bench, models, str(content["law"])
    except (KeyError, TypeError, ValueError, AttributeError, IndexError) as error:
        if isinstance(error, InputError):
            raise
        problem = f"is not valid ({type(error).__name__}: {error})"
        raise InputError(file=place, problem=problem, remedy="remove it") from None


def _node(node: dict[str, Any], names: Mapping[str, str]) -> dict[str, Any]:
    """Check that the entry of a model has all keys that the page requires, and return it.

    `names` are the current names of the runs by saved name. A test of candidates that was not
    completed before saving is marked as not carried out.
    """
    for key in ("id", "words", "law", "effects", "model", "rms", "noise_rms"):
        node[key]
    node = {**node, "trials": node.get("trials") or []}
    for key, field in (("runs", "name"), ("findings", "run")):
        if key in node:
            node[key] = [{**row, field: names.get(row[field], row[field])} for row in node[key]]
    if "power" in node:
        node["power"] = _with_current_keys(node["power"], _RENAMED["power"])
    if "ways" in node.get("stribeck", {}):
        branches = _with_current_keys(node["stribeck"]["ways"], _RENAMED["directions"])
        node["stribeck"] = {**node["stribeck"], "directions": branches}
    if "used" in node:
        node["used"] = {names.get(name, name): span for name, span in node["used"].items()}
    if "record_names" in node:
        node["record_names"] = [names.get(name, name) for name in node["record_names"]]
    return node


def _with_current_keys(
    rows: Iterable[Mapping[str, Any]], renamed: Mapping[str, str]
) -> list[dict[str, Any]]:
    """Rows of a table with the current names of their keys."""
    return [{renamed.get(key, key): value for key, value in row.items()} for row in rows]
