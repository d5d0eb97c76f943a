"""File of a session with rig, runs and models, from which it can be continued."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from jbf.errors import InputError
from jbf.text_files import read_text, write_text
from jbf.workbench.bench import Bench
from jbf.workbench.models import Models
from jbf.workbench.session import Session

FILE = "workbench.json"
FORMAT = "jbf workbench 1"
_RENAMED = {
    "power": {"found": "detectable", "alone": "distinguishable", "like": "confounded_with"},
    "directions": {"way": "direction"},
}
"""Current keys of the rows of two tables, by their key in older session files."""


def content_of(session: Session) -> dict[str, Any]:
    """Content of the session file: files and names of rig and runs, trims, and all models.

    The name of a run contains folders if two files have the same stem, so that it may change when
    the files are moved.

    Raises
    ------
    InputError
        No rig is open.
    """
    with session.lock:
        bench, models = session.on_bench(), session.models
        return {
            "format": FORMAT,
            "rig": bench.rig_name,
            "runs": list(bench.run_names),
            "run_names": [run.name for run in bench.runs],
            "trims": bench.trims,
            "excluded": sorted(bench.excluded),
            "law": session.law,
            "current": models.current,
            "models": [
                {k: v for k, v in node.items() if k != "records"} for node in models.nodes.values()
            ],
        }


def save(session: Session) -> Path:
    """Write the session file into the session's folder, and return its path.

    Raises
    ------
    InputError
        No rig is open, or the file cannot be written.
    """
    path = session.folder.path(FILE)
    write_text(path, json.dumps(content_of(session), indent=1))
    return path


def load(session: Session) -> bool:
    """Restore a session from the file in its folder; return False if there is no file.

    Raises
    ------
    InputError
        The file is broken, has another format, or names files that no longer exist.
    """
    path = session.folder.path(FILE)
    if not path.exists():
        return False
    try:
        content = json.loads(read_text(path))
    except json.JSONDecodeError as error:
        remedy = "remove it"
        raise InputError(
            file=path, row=error.lineno, problem="is not valid JSON", remedy=remedy
        ) from None
    restore(session, checked(content, path), path)
    return True


def checked(content: object, path: Path) -> dict[str, Any]:
    """Return the content of a session file; an InputError if it has another format."""
    if not isinstance(content, dict) or content.get("format") != FORMAT:
        raise InputError(
            file=path, problem=f"does not have the format {FORMAT!r}", remedy="remove it"
        )
    return content


def restore(session: Session, content: dict[str, Any], path: Path) -> None:
    """Open the rig, the runs and the models of a session file, read from `path`.

    Raises
    ------
    InputError
        The content is not complete, or names files that do not exist.
    """
    try:
        bench = Bench.read(session.folder, str(content["rig"]), list(map(str, content["runs"])))
        current_names = [run.name for run in bench.runs]
        # Older session files have no names.
        saved_names = map(str, content.get("run_names", current_names))
        names = dict(zip(saved_names, current_names, strict=True))
        for name, span in content["trims"].items():
            bench.trim(names[name], (float(span[0]), float(span[1])))
        for name in content["excluded"]:
            bench.leave_out(names[name], True)
        models = Models({int(node["id"]): _node(node, names) for node in content["models"]})
        law, current = str(content["law"]), content["current"]
        models.choose(current)
    except (KeyError, TypeError, ValueError, AttributeError, IndexError) as error:
        if isinstance(error, InputError):
            raise
        problem = f"is not valid ({type(error).__name__}: {error})"
        raise InputError(file=path, problem=problem, remedy="remove it") from None
    session.put(bench, models, law)
    if current is not None:
        session.show(int(current))
    session.say("done", f"the session of {path.name} was restored")


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
    if "record_names" in node:
        node["record_names"] = [names.get(name, name) for name in node["record_names"]]
    return node


def _with_current_keys(
    rows: Iterable[Mapping[str, Any]], renamed: Mapping[str, str]
) -> list[dict[str, Any]]:
    """Rows of a table with the current names of their keys."""
    return [{renamed.get(key, key): value for key, value in row.items()} for row in rows]
