"""Import of a recording through the page: its columns, the result of a map, its runs."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from itertools import chain, count
from pathlib import Path, PurePosixPath
from typing import Any

import numpy as np

from jbf.errors import InputError
from jbf.importing.formats.table import Options, Source
from jbf.importing.guessed import Guess
from jbf.importing.import_files import ReadFiles, look, read_files, write_import
from jbf.importing.joints import JointNotChosen
from jbf.importing.map_text import map_text
from jbf.importing.overview import Overview
from jbf.importing.preview import Preview, preview
from jbf.records.run import PathLike
from jbf.workbench.files import Folder
from jbf.workbench.map_form import (
    additional_names,
    changed_by,
    cut_name,
    file_columns,
    form_of,
    map_of,
    quantities,
    without_path,
)
from jbf.workbench.open_points import of_joints, open_points, remaining
from jbf.workbench.reading import Cancelled, Reading
from jbf.workbench.series import listed
from jbf.workbench.source_cache import SourceCache

SI_UNITS = {
    "time_s": "s",
    "angle_rad": "rad",
    "load_n": "N",
    "temperature_c": "°C",
    "pressure_pa": "Pa",
}


def guess_map(folder: Folder, name: str, joint: str | None = None) -> dict[str, Any]:
    """Propose a map for a file of the folder, or for one of several joints in it.

    Returns the text of the map, its open points, and a name for the new campaign.
    """
    stem = PurePosixPath(name).stem
    names = chain([stem], (f"{stem}_{k}" for k in count(2)))
    path = folder.path(name)
    proposal, of_joint = _of_joint(path, joint)
    text = map_text(proposal)
    columns = file_columns(path)
    points = open_points(map_of(text), columns)
    return {
        "file": name,
        "into": next(n for n in names if not folder.path(n).exists()),
        "format": proposal.format,
        "map": text,
        "form": form_of(text),
        "columns": columns,
        "quantities": quantities(),
        "why": {entry.key: entry.why for entry in proposal.entries},
        "joint": of_joint,
        "open": points,
        "confirm": remaining(proposal.questions, points),
    }


def _of_joint(path: Path, joint: str | None) -> tuple[Guess, list[dict[str, Any]]]:
    """Proposed map of a file, and the choice of the joint if there are several.

    Without a chosen joint, the map is that of the first.
    """
    try:
        return look(path), []
    except JointNotChosen as several:
        chosen = joint or several.joints[0]
        return look(path, chosen), of_joints(several.joints, chosen)


def try_map(
    folder: Folder,
    names: Sequence[str],
    text: str,
    form: Mapping[str, Any] | None = None,
    *,
    cache: SourceCache | None = None,
    reading: Reading | None = None,
) -> dict[str, Any]:
    """Apply a map to files, and summarize the resulting runs without an import.

    The summary has the smallest, median and largest value of each column in SI units, and curves
    with the pieces that the recording is cut into. If a form is given, it changes the map first.
    Errors and open points are reported as data, together with the current map.
    """
    if form is not None:
        rate = form.get("rate_hz")
        rate_hz = None if rate is None else float(rate)
        text = changed_by(text, list(form["rows"]), dict(form["rig"]), rate_hz)
    _cut_file(folder, text), _additional_files(folder, text)  # refused outside the folder
    answer: dict[str, Any] = {"map": text, "form": form_of(text), "runs": [], "problem": None}
    answer["open"] = open_points(map_of(text), file_columns(_paths(folder, names)[0]))
    if answer["open"]:
        return answer
    try:
        with _read(folder, names, text, cache, reading) as read:
            answer |= _content_of(preview(read))
    except Cancelled:
        raise
    except InputError as error:
        answer["problem"] = str(without_path(error))
    return answer


def import_runs(
    folder: Folder,
    names: Sequence[str],
    text: str,
    into: str,
    *,
    cache: SourceCache | None = None,
    reading: Reading | None = None,
) -> dict[str, Any]:
    """Import files into a new folder of a given name; return the names of its rig and runs."""
    out = folder.path(into)
    if out.exists():
        raise InputError(file=into, problem="already exists", remedy="name another folder")
    try:
        with _read(folder, names, text, cache, reading) as read:
            campaign = write_import(read, out, None if reading is None else reading.progress)
    except Cancelled:
        raise
    except InputError as error:
        raise without_path(error) from None
    runs = [folder.name(out / f"{piece.name}.csv") for piece in campaign.pieces if piece.keep]
    return {"rig": folder.name(out / "rig.toml"), "files": runs}


@contextmanager
def _read(
    folder: Folder,
    names: Sequence[str],
    text: str,
    cache: SourceCache | None,
    reading: Reading | None,
) -> Iterator[ReadFiles]:
    """Read files of the folder through the text of a map."""
    store = cache or SourceCache()

    def opener(path: Path, beside: Sequence[PathLike], options: Options) -> Source:
        tick = (lambda done, total: None) if reading is None else reading.tick
        return store.open(path, beside, options, tick)

    with (
        tempfile.TemporaryDirectory(prefix="jbf-map-") as scratch,
        read_files(
            _paths(folder, names),
            _map_file(scratch, text),
            cut_file=_cut_file(folder, text),
            beside=_additional_files(folder, text),
            progress=None if reading is None else reading.progress,
            opener=opener,
        ) as read,
    ):
        yield read


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


def _content_of(result: Preview) -> dict[str, Any]:
    of_rig, runs = result.rig.quantities, []
    units = {"friction_n": of_rig.force, "velocity_m_s": of_rig.speed, "position_m": of_rig.length}
    for run in result.runs:
        from_map = {called: key for key, called in run.called.items()}
        columns = [
            {
                "name": name,
                "from": from_map.get(name, name),
                "unit": units.get(name, SI_UNITS.get(name, "")),
                **{k: float(f"{v:.6g}") for k, v in zip(_ENDS, ends, strict=True)},
            }
            for name, ends in run.ranges.items()
        ]
        runs.append({"name": run.name, "samples": run.samples, "columns": columns})
    return {
        "runs": runs,
        "pieces": [vars(piece) for piece in result.pieces],
        "curves": [_curves(overview) for overview in result.overviews],
        "notes": list(result.notes),
    }


_ENDS = ("least", "median", "most")


def _curves(overview: Overview) -> dict[str, Any]:
    """Curves of a recording for a plot; smallest and largest value of each interval in turn.

    Segments of increasing time are separated by a gap, a null value.
    """
    columns = {}
    for key, (time, low, high) in overview.curves.items():
        gap = np.isnan(time)
        instants = np.where(gap, np.roll(time, 1), time)[:-1]
        values = np.column_stack([low, high])[:-1]
        columns[key] = {
            "time_s": listed(np.repeat(instants, 2), 11),
            "values": listed(values.ravel()),
        }
    return {
        "file": overview.file,
        "starts_s": list(overview.starts_s),
        "columns": columns,
    }
