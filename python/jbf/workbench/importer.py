"""Import of a recording through the page: its columns, the result of a map, its runs."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping, Sequence
from itertools import chain, count
from pathlib import Path, PurePosixPath
from typing import Any

import numpy as np

from jbf.errors import InputError
from jbf.importing.guessed import Guess
from jbf.importing.import_files import import_files, look
from jbf.importing.joints import JointNotChosen
from jbf.importing.map_text import map_text
from jbf.importing.result import Import
from jbf.workbench.files import Folder
from jbf.workbench.map_form import (
    additional_names,
    changed_by,
    cut_name,
    file_columns,
    form_of,
    quantities,
    without_path,
)

SI_UNITS = {
    "time_s": "s",
    "angle_rad": "rad",
    "load_n": "N",
    "temperature_c": "°C",
    "pressure_pa": "Pa",
}


def guess_map(folder: Folder, name: str) -> dict[str, Any]:
    """Propose a map for a file of the folder.

    Returns the text of the map, open questions, and a name for the new campaign.
    """
    stem = PurePosixPath(name).stem
    names = chain([stem], (f"{stem}_{k}" for k in count(2)))
    path = folder.path(name)
    proposal, open_joint = _first_joint(path)
    text = map_text(proposal)
    return {
        "file": name,
        "into": next(n for n in names if not folder.path(n).exists()),
        "format": proposal.format,
        "map": text,
        "form": form_of(text),
        "columns": file_columns(path),
        "quantities": quantities(),
        "questions": [*open_joint, *map(str, proposal.questions)],
    }


def _first_joint(path: Path) -> tuple[Guess, list[str]]:
    """Proposed map of a file (of the first joint, if there are several), with notes.

    The notes name the other joints.
    """
    try:
        return look(path), []
    except JointNotChosen as several:
        first, *other_joints = several.joints
        question = f"joint: columns of {first}; others: {', '.join(other_joints)}"
        return look(path, first), [question]


def try_map(
    folder: Folder, names: Sequence[str], text: str, form: Mapping[str, Any] | None = None
) -> dict[str, Any]:
    """Apply a map to files, and summarize the resulting runs without an import.

    The summary has the smallest, median and largest value of each column in SI units. If a form is
    given, it changes the map first. Errors and open questions are reported as text, together with
    the current map.
    """
    if form is not None:
        text = changed_by(text, list(form["rows"]), dict(form["rig"]))
    paths, cut = _paths(folder, names), _cut_file(folder, text)
    additional = _additional_files(folder, text)
    answer: dict[str, Any] = {"map": text, "form": form_of(text), "runs": [], "problem": None}
    try:
        with tempfile.TemporaryDirectory(prefix="jbf-map-") as scratch:
            answer |= _content_of(
                import_files(paths, _map_file(scratch, text), cut_file=cut, beside=additional)
            )
    except InputError as error:
        answer["problem"] = str(without_path(error))
    return answer


def import_runs(folder: Folder, names: Sequence[str], text: str, into: str) -> dict[str, Any]:
    """Import files into a new folder of a given name; return the names of its rig and runs."""
    out = folder.path(into)
    if out.exists():
        raise InputError(file=into, problem="already exists", remedy="name another folder")
    paths, cut = _paths(folder, names), _cut_file(folder, text)
    additional = _additional_files(folder, text)
    with tempfile.TemporaryDirectory(prefix="jbf-map-") as scratch:
        try:
            campaign = import_files(
                paths, _map_file(scratch, text), out, cut_file=cut, beside=additional
            )
        except InputError as error:
            raise without_path(error) from None
        answer = _content_of(campaign)
    runs = [folder.name(out / f"{piece.name}.csv") for piece in campaign.pieces if piece.keep]
    return {**answer, "rig": folder.name(out / "rig.toml"), "files": runs}


def _paths(folder: Folder, names: Sequence[str]) -> list[Path]:
    if not names:
        raise InputError(problem="no recording is selected", remedy="select one")
    paths = [folder.path(name) for name in names]
    for name, path in zip(names, paths, strict=True):
        if not path.is_file():
            raise InputError(file=name, problem="does not exist", remedy="choose one of the list")
    return paths


def _cut_file(folder: Folder, text: str) -> Path | None:
    """Path of the trim file that a map names; it must be in the folder."""
    name = cut_name(text)
    return None if name is None else folder.path(name)


def _additional_files(folder: Folder, text: str) -> list[Path] | None:
    """Paths of the further files that a map names; these must be in the folder."""
    return [folder.path(name) for name in additional_names(text)] or None


def _map_file(folder: str, text: str) -> Path:
    path = Path(folder) / "map.toml"
    path.write_text(text, encoding="utf-8")
    return path


def _content_of(campaign: Import) -> dict[str, Any]:
    of_rig, runs = campaign.rig.quantities, []
    units = {"friction_n": of_rig.force, "velocity_m_s": of_rig.speed, "position_m": of_rig.length}
    for run in campaign.runs:
        columns = [
            {
                "name": name,
                "unit": units.get(name, SI_UNITS.get(name, "")),
                **dict(zip(("least", "median", "most"), _spread(values), strict=True)),
            }
            for name, values in run.columns().items()
        ]
        runs.append({"name": run.name, "samples": len(run), "columns": columns})
    return {"runs": runs, "pieces": [vars(piece) for piece in campaign.pieces]}


def _spread(values: Any) -> list[float]:
    return [float(f"{v:.6g}") for v in np.nanquantile(values, [0.0, 0.5, 1.0])]
