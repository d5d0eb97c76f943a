"""Text of the CSV file of a run, written from a piece of a recording block by block.

If clocks differ, there is a row at each instant of any clock, and cells without a sample are
empty. Nothing is resampled.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from jbf.arrays import Array
from jbf.importing.channels import CUTTING_COLUMNS
from jbf.importing.cutting.piece import Piece
from jbf.importing.formats.table import BLOCK
from jbf.importing.spool import Recording, Stream
from jbf.records.checks import COLUMNS, POINT


def run_columns(recording: Recording) -> list[str]:
    """Names of the columns in the runs of a recording, known columns first."""
    keys = [stream.columns[at] for stream in recording.streams for at in _written(stream)[1:]]
    standard = [key for key in COLUMNS if key in keys or key == "time_s"]
    return standard + [key for key in keys if key not in COLUMNS]


def _written(stream: Stream) -> list[int]:
    """Indices of the columns of a stream that are written to the files of its runs."""
    of_cutting = [at for at, key in enumerate(stream.columns) if key in CUTTING_COLUMNS]
    return [at for at in range(len(stream.columns)) if at not in (*of_cutting, *stream.empty)]


def run_text(recording: Recording, piece: Piece) -> Iterator[str]:
    """Yield the CSV text of a run in parts."""
    columns = run_columns(recording)
    called = [POINT if recording.steady and c == "time_s" else c for c in columns]
    yield ",".join(called) + "\n"
    for block in run_rows(recording, piece, columns):
        yield _lines(block)


def run_rows(recording: Recording, piece: Piece, columns: list[str]) -> Iterator[Array]:
    """Yield the rows of a run, shape (n, columns), with NaN for missing samples."""
    parts = [_Part(stream, piece) for stream in recording.streams]
    indices = [_written(p.stream) for p in parts]
    places = [
        [columns.index(part.stream.columns[at]) for at in columns_of_part]
        for part, columns_of_part in zip(parts, indices, strict=True)
    ]
    while True:
        # Fill every part, not only the first that has rows.
        filled = [part.fill() for part in parts]
        if not any(filled):
            return
        # Process rows only up to the last time that every clock has reached.
        horizon = min((p.last for p in parts if p.has_rows), default=np.inf)
        blocks = [part.take(horizon) for part in parts]
        times = np.unique(np.concatenate([block[:, 0] for block in blocks]))
        rows = np.full((len(times), len(columns)), np.nan)
        for block, columns_of_part, into in zip(blocks, indices, places, strict=True):
            rows[np.searchsorted(times, block[:, 0])[:, None], np.array(into)] = block[
                :, columns_of_part
            ]
        rows[:, columns.index("time_s")] = times
        full = np.isfinite(rows).sum(axis=1) > 1
        if full.any():
            yield rows[full]


class _Part:
    """Buffered rows of a stream within a piece."""

    def __init__(self, stream: Stream, piece: Piece) -> None:
        self.stream = stream
        self.next, self.end = stream.rows_between(piece.segment, piece.from_s, piece.to_s)
        self.rows = np.empty((0, len(stream.columns)))
        self._needed = bool(stream.needed)

    @property
    def has_rows(self) -> bool:
        """Whether rows of the run have not been read yet."""
        return self.next < self.end

    @property
    def last(self) -> float:
        """Last instant that was read, s."""
        return float(self.rows[-1, 0]) if len(self.rows) else -np.inf

    def fill(self) -> bool:
        """Read a block if no rows are buffered; return False at the end."""
        while not len(self.rows) and self.has_rows:
            rows = self.stream.read(self.next, min(self.next + BLOCK, self.end))
            self.next += len(rows)
            self.rows = rows[self.stream.complete(rows)] if self._needed else rows
        return bool(len(self.rows))

    def take(self, horizon: float) -> Array:
        """Remove the buffered rows up to an instant, and return them."""
        count = int(np.searchsorted(self.rows[:, 0], horizon, side="right"))
        rows, self.rows = self.rows[:count], self.rows[count:]
        return rows


def _lines(block: Array) -> str:
    # repr of a float is the shortest text that is parsed to the same float.
    columns = []
    for column in block.T:
        cells = list(map(repr, column.tolist()))
        if np.isnan(column).any():
            cells = ["" if cell == "nan" else cell for cell in cells]
        columns.append(cells)
    return "\n".join(map(",".join, zip(*columns, strict=True))) + "\n"
