"""Preview of an import: runs, curves and ranges of the columns, without writing files."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jbf.arrays import Array
from jbf.importing.cutting.piece import Piece
from jbf.importing.import_files import ReadFiles
from jbf.importing.overview import Overview, overview
from jbf.importing.run_text import run_columns, run_rows
from jbf.records.drive_columns import DriveColumns
from jbf.records.rig import Rig


@dataclass(frozen=True)
class RunPreview:
    """One run of an import that has not been written.

    Attributes
    ----------
    name, samples
        Name, and number of rows.
    ranges
        Smallest, median and largest value of each column of the run, in the units of the rig.
    called
        Column of the map to the column of the run that it is converted to.
    """

    name: str
    samples: int
    ranges: dict[str, tuple[float, float, float]]
    called: dict[str, str]


@dataclass(frozen=True)
class Preview:
    """Result that an import would have.

    Attributes
    ----------
    rig
        Rig of the recordings.
    runs, pieces
        The runs, and all pieces of the recordings, including those that are left out.
    overviews
        Each recording reduced to few points, for plotting.
    notes
        Remarks on each recording, such as how it was cut.
    """

    rig: Rig
    runs: tuple[RunPreview, ...]
    pieces: tuple[Piece, ...]
    overviews: tuple[Overview, ...]
    notes: tuple[str, ...]


def preview(read: ReadFiles) -> Preview:
    """Summarise the runs that recordings become."""
    return Preview(
        read.rig,
        tuple(_run(read, piece) for piece in read.pieces if piece.keep),
        tuple(read.pieces),
        tuple(overview(recording) for recording in read.recordings),
        tuple(note for recording in read.recordings for note in recording.notes),
    )


def _run(read: ReadFiles, piece: Piece) -> RunPreview:
    """Summary of the run that a piece becomes."""
    recording = next(r for r in read.recordings if r.path.name == piece.file)
    names = run_columns(recording)
    rows = list(run_rows(recording, piece, names))
    values = np.concatenate(rows) if rows else np.empty((0, len(names)))
    columns: dict[str, Array] = dict(zip(names, values.T, strict=True))
    called: dict[str, str] = {}
    if read.rig.drive is not None:
        of_drive = DriveColumns.of(read.rig.drive)
        called = of_drive.called(columns)
        columns, _ = of_drive.converted(piece.name, columns)
    return RunPreview(
        piece.name, len(values), {name: _range(v) for name, v in columns.items()}, called
    )


def _range(values: Array) -> tuple[float, float, float]:
    """Smallest, median and largest finite value."""
    finite = values[np.isfinite(values)]
    if not len(finite):
        return (np.nan, np.nan, np.nan)
    return float(finite.min()), float(np.median(finite)), float(finite.max())
