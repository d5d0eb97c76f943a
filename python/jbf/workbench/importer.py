"""A stranger's file through the page: its columns, what a map makes of them, its runs."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from itertools import chain, count
from pathlib import Path, PurePosixPath
from typing import Any

import numpy as np

from jbf.errors import InputError
from jbf.importing.import_files import import_files, look
from jbf.importing.map_text import map_text
from jbf.importing.result import Import
from jbf.workbench.files import Folder


def looked(folder: Folder, name: str) -> dict[str, Any]:
    """A guess at a file: the text of its map, what is open, and a name for what it becomes."""
    stem = PurePosixPath(name).stem
    names = chain([stem], (f"{stem}_{k}" for k in count(2)))
    found = look(folder.path(name))
    return {
        "file": name,
        "into": next(n for n in names if not folder.path(n).exists()),
        "format": found.format,
        "map": map_text(found),
        "entries": [
            {"key": e.key, "expression": e.expression, "why": e.why, "sure": e.sure}
            for e in found.entries
        ],
        "questions": [str(question) for question in found.questions],
        "ignored": dict(found.ignored),
    }


def tried(folder: Folder, names: Sequence[str], text: str) -> dict[str, Any]:
    """What a map makes of files: each run's columns in SI, least, median and largest."""
    with tempfile.TemporaryDirectory(prefix="jbf-map-") as there:
        return _told(import_files(_paths(folder, names), _map_file(there, text)))


def imported(folder: Folder, names: Sequence[str], text: str, into: str) -> dict[str, Any]:
    """Import for good, into a new folder of that name; its rig and its runs."""
    out = folder.path(into)
    if out.exists():
        raise InputError(file=into, problem="is there already", mend="name another folder")
    with tempfile.TemporaryDirectory(prefix="jbf-map-") as there:
        found = import_files(_paths(folder, names), _map_file(there, text), out)
        told = _told(found)
    runs = [folder.name(out / f"{piece.name}.csv") for piece in found.pieces if piece.keep]
    return {**told, "rig": folder.name(out / "rig.toml"), "files": runs}


def _paths(folder: Folder, names: Sequence[str]) -> list[Path]:
    if not names:
        raise InputError(problem="no recording is chosen", mend="tick one")
    return [folder.path(name) for name in names]


def _map_file(folder: str, text: str) -> Path:
    path = Path(folder) / "map.toml"
    path.write_text(text, encoding="utf-8")
    return path


def _told(found: Import) -> dict[str, Any]:
    runs = []
    for run in found.runs:
        columns = [
            {"name": name, **dict(zip(("least", "median", "most"), _spread(values), strict=True))}
            for name, values in run.columns().items()
        ]
        runs.append({"name": run.name, "samples": len(run), "columns": columns})
    return {"runs": runs, "pieces": [vars(piece) for piece in found.pieces]}


def _spread(values: Any) -> list[float]:
    return [float(f"{v:.6g}") for v in np.nanquantile(values, [0.0, 0.5, 1.0])]
