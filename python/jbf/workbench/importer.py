"""A stranger's file through the page: its columns, what a map makes of them, its runs."""

from __future__ import annotations

import tempfile
from pathlib import Path, PurePosixPath
from typing import Any

import numpy as np

from jbf.errors import InputError
from jbf.importing.import_files import import_files, look
from jbf.importing.map_text import map_text
from jbf.importing.result import Import
from jbf.workbench.files import Folder


def looked(folder: Folder, name: str) -> dict[str, Any]:
    """A guess at a file: the text of its map, and what is open."""
    found = look(folder.path(name))
    return {
        "file": name,
        "format": found.format,
        "map": map_text(found),
        "entries": [
            {"key": e.key, "expression": e.expression, "why": e.why, "sure": e.sure}
            for e in found.entries
        ],
        "questions": [str(question) for question in found.questions],
        "ignored": dict(found.ignored),
    }


def tried(folder: Folder, name: str, text: str) -> dict[str, Any]:
    """What a map makes of a file: each run's columns in SI, least, median and largest."""
    with tempfile.TemporaryDirectory(prefix="jbf-map-") as there:
        return _told(import_files(folder.path(name), _map_file(there, text)))


def imported(folder: Folder, name: str, text: str) -> dict[str, Any]:
    """Import for good, into a folder called like the file; its rig and its runs."""
    out = folder.root / PurePosixPath(name).stem
    if out.exists():
        raise InputError(file=out, problem="is there already", mend="rename or remove it")
    with tempfile.TemporaryDirectory(prefix="jbf-map-") as there:
        found = import_files(folder.path(name), _map_file(there, text), out)
        told = _told(found)
    runs = [folder.name(out / f"{piece.name}.csv") for piece in found.pieces if piece.keep]
    return {**told, "rig": folder.name(out / "rig.toml"), "files": runs}


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
