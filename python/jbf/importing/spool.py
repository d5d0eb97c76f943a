"""Intermediate storage of a recording: one binary file per clock, with its columns.

The file is read in blocks, so that the memory required does not depend on the duration.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from jbf.arrays import Array, Mask
from jbf.importing.expression import Node
from jbf.importing.file_clock import FileClock
from jbf.importing.formats.dates import as_date
from jbf.importing.formats.table import BLOCK, Values
from jbf.records.channels import SEPARATE_CLOCK_SHARE

if TYPE_CHECKING:
    from jbf.importing.alignment import Alignment


@dataclass
class Stream:
    """Stored columns that share a clock; the first column is the time.

    Attributes
    ----------
    columns
        Names, `time_s` first.
    segments
        First row and end (exclusive) of each segment of increasing time.
    file
        Rows of float64; NaN for a missing sample.
    rows
        Number of rows.
    missing
        Number of rows without a value of each column.
    source
        File from which the stream was read.
    """

    columns: tuple[str, ...]
    file: Path
    rows: int = 0
    segments: list[tuple[int, int]] = field(default_factory=list)
    missing: npt.NDArray[np.int64] | None = None
    source: Path | None = None

    @property
    def needed(self) -> list[int]:
        """Indices of columns whose few gaps are missing values; rows with them are dropped.

        A column with more gaps is a channel with a separate clock, and its empty cells remain. The
        same rule applies when runs are read.
        """
        if self.missing is None:
            return []
        few = (self.missing > 0) & (self.missing < SEPARATE_CLOCK_SHARE * self.rows)
        return [int(column) for column in np.flatnonzero(few)]

    @property
    def empty(self) -> list[int]:
        """Indices of columns without any value."""
        if self.missing is None:
            return []
        return [int(column) for column in np.flatnonzero(self.missing == self.rows)]

    def complete(self, block: Array) -> Mask:
        """Mask of the rows of a block that have values in all `needed` columns."""
        mask: Mask = np.all(np.isfinite(block[:, self.needed]), axis=1)
        return mask

    def append(self, block: Array) -> None:
        """Append rows, shape (n, columns)."""
        missing = np.isnan(block).sum(axis=0)
        self.missing = missing if self.missing is None else self.missing + missing
        with self.file.open("ab") as file:
            np.ascontiguousarray(block, dtype=np.float64).tofile(file)
        self.rows += len(block)

    def read(self, first: int, end: int) -> Array:
        """Read the rows from `first` to `end`, exclusive, shape (n, columns)."""
        width = len(self.columns)
        first, end = max(first, 0), min(end, self.rows)
        count = max(end - first, 0)
        values = np.fromfile(self.file, np.float64, count * width, offset=first * width * 8)
        return values.reshape(count, width)

    def blocks(self, first: int = 0, end: int | None = None, size: int = BLOCK) -> Iterator[Array]:
        """Yield the rows from `first` to `end`, exclusive, in blocks."""
        last = self.rows if end is None else min(end, self.rows)
        for begin in range(first, last, size):
            yield self.read(begin, min(begin + size, last))

    def overlapping(
        self, first: int, end: int, margin: int, size: int = BLOCK
    ) -> Iterator[tuple[int, int, Array]]:
        """Yield blocks with up to `margin` additional rows on both sides, if available.

        Each item consists of the first row of the block without its margin, the index of this row
        in the array, and the array, shape (rows, columns).
        """
        for begin in range(first, end, size):
            low = max(begin - margin, first)
            high = min(begin + size + margin, end)
            yield begin, begin - low, self.read(low, high)

    def rewrite(self, column: int, values: Iterator[Array]) -> None:
        """Replace the values of a column, block by block."""
        width = len(self.columns)
        with self.file.open("r+b") as file:
            first = 0
            for part in values:
                block = self.read(first, first + len(part))
                block[:, column] = part
                file.seek(first * width * 8)
                block.tofile(file)
                first += len(part)

    def at(self, row: int) -> float:
        """Time, s, at a row index."""
        return float(self.read(row, row + 1)[0, 0])

    def rows_between(self, segment: int, first_s: float, last_s: float) -> tuple[int, int]:
        """First row and end (exclusive) of the rows within two instants, both included."""
        low, high = self.segments[segment]
        return self._search(low, high, first_s, right=False), self._search(
            low, high, last_s, right=True
        )

    def _search(self, low: int, high: int, instant: float, *, right: bool) -> int:
        while low < high:
            middle = (low + high) // 2
            now = self.at(middle)
            if now < instant or (right and now == instant):
                low = middle + 1
            else:
                high = middle
        return low


@dataclass
class Dropped:
    """Rows that were omitted, and why; the file is stated if it is not the main one."""

    rows: int
    why: str
    first_row: int | None = None
    file: str | None = None


@dataclass
class Recording:
    """Contents of one recording as read: its streams, and remarks on the reading.

    Attributes
    ----------
    name
        Stem of the file.
    path, format
        The file, and the name of its format.
    streams
        Columns by clock.
    dropped
        Omitted rows.
    channels
        Ledger entry of each channel.
    notes
        Remarks on the reading.
    labels
        Words of text columns, in the order of their codes.
    start
        First instant as a date, if the file states it.
    clocks
        Clock of each file.
    beside
        Further files with separate clocks.
    alignments
        Alignments of the clocks of further files to that of `path`.
    steady
        Whether each row is a steady state without a time.
    """

    name: str
    path: Path
    format: str
    streams: list[Stream] = field(default_factory=list)
    dropped: list[Dropped] = field(default_factory=list)
    channels: list[dict[str, object]] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    start: str | None = None
    clocks: dict[Path, FileClock] = field(default_factory=dict)
    beside: tuple[Path, ...] = ()
    alignments: list[Alignment] = field(default_factory=list)
    labels: list[str] = field(default_factory=list)
    steady: bool = False

    def stream_of(self, *keys: str) -> tuple[Stream, str] | None:
        """Stream and name of the first of these columns that has values, or None."""
        for key in keys:
            for stream in self.streams:
                if key in stream.columns and stream.columns.index(key) not in stream.empty:
                    return stream, key
        return None

    def clock_of(self, file: Path) -> FileClock:
        """Return the clock of a file."""
        return self.clocks.setdefault(file, FileClock())

    def seconds(
        self, file: Path, node: Node, values: Mapping[str, Values], units: Mapping[str, str]
    ) -> Array:
        """Evaluate the time expression of a file and return times of the recording, s."""
        clock = self.clock_of(file)
        time = clock.seconds(node, values, units)
        note = f"times count from {clock.origin_s:.0f} s after 1970"
        if clock.origin_s and file == self.path and note not in self.notes:
            self.start = as_date(int(clock.origin_s) * 10**9)
            self.notes.append(note)
        return time

    @property
    def segments(self) -> int:
        """Number of segments of increasing time."""
        return max((len(stream.segments) for stream in self.streams), default=0)
