"""A recording on its way: columns of each clock, in a file of plain numbers, read in blocks.

A day at 50 Hz is as large in memory as an hour: a block.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from jbf.importing.expression import Node
from jbf.importing.file_clock import FileClock
from jbf.importing.formats.dates import as_date
from jbf.importing.formats.table import BLOCK, Values
from jbf.records.channels import OWN_CLOCK

if TYPE_CHECKING:
    from jbf.importing.alignment import Alignment

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]


@dataclass
class Stream:
    """Columns that share a clock; time is the first of them.

    Attributes
    ----------
    columns
        Names, `time_s` first.
    segments
        First row and end of each stretch in which time grows.
    file
        Rows of float64; nan where a column has no sample.
    missing
        How many rows lack a value of each column.
    source
        The file that it was read from.
    """

    columns: tuple[str, ...]
    file: Path
    rows: int = 0
    segments: list[tuple[int, int]] = field(default_factory=list)
    missing: npt.NDArray[np.int64] | None = None
    source: Path | None = None

    @property
    def needed(self) -> list[int]:
        """Columns whose few gaps are missing values; one with more has a clock of its own, and its
        empty cells stay. By the rule that a run is read by."""
        if self.missing is None:
            return []
        few = (self.missing > 0) & (self.missing < OWN_CLOCK * self.rows)
        return [int(column) for column in np.flatnonzero(few)]

    @property
    def empty(self) -> list[int]:
        """Columns without a single value."""
        if self.missing is None:
            return []
        return [int(column) for column in np.flatnonzero(self.missing == self.rows)]

    def complete(self, block: Array) -> Mask:
        """Rows that have what is needed."""
        mask: Mask = np.all(np.isfinite(block[:, self.needed]), axis=1)
        return mask

    def append(self, block: Array) -> None:
        """Add rows, shape (n, columns)."""
        lacking = np.isnan(block).sum(axis=0)
        self.missing = lacking if self.missing is None else self.missing + lacking
        with self.file.open("ab") as file:
            np.ascontiguousarray(block, dtype=np.float64).tofile(file)
        self.rows += len(block)

    def read(self, first: int, end: int) -> Array:
        """Rows from `first` to before `end`, shape (n, columns)."""
        width = len(self.columns)
        first, end = max(first, 0), min(end, self.rows)
        count = max(end - first, 0)
        values = np.fromfile(self.file, np.float64, count * width, offset=first * width * 8)
        return values.reshape(count, width)

    def blocks(self, first: int = 0, end: int | None = None, size: int = BLOCK) -> Iterator[Array]:
        """The same in blocks."""
        last = self.rows if end is None else min(end, self.rows)
        for begin in range(first, last, size):
            yield self.read(begin, min(begin + size, last))

    def overlapping(
        self, first: int, end: int, margin: int, size: int = BLOCK
    ) -> Iterator[tuple[int, int, Array]]:
        """Blocks with `margin` rows more at both sides, where there are so many: the row that the
        block proper begins with, its place in what is given, and the rows."""
        for begin in range(first, end, size):
            low = max(begin - margin, first)
            high = min(begin + size + margin, end)
            yield begin, begin - low, self.read(low, high)

    def rewrite(self, column: int, values: Iterator[Array]) -> None:
        """Put other values into a column, block by block."""
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
        """The time of a row, s."""
        return float(self.read(row, row + 1)[0, 0])

    def rows_between(self, segment: int, first_s: float, last_s: float) -> tuple[int, int]:
        """First row and end of those within two instants, both included."""
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
    """Rows that were left out, and why; the file where it is not the recording's own."""

    rows: int
    why: str
    first_row: int | None = None
    file: str | None = None


@dataclass
class Recording:
    """One file, read: its streams, and what was done on the way.

    Attributes
    ----------
    name
        The file's stem.
    start
        The first instant as a date, where the file tells.
    clocks
        The clock of each file.
    beside
        Further files with separate clocks.
    alignments
        How the clocks of further files were aligned to that of `path`.
    steady
        Whether each row is a steady state and has no time.
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
        """The stream that holds the first of these columns that is there, and has values."""
        for key in keys:
            for stream in self.streams:
                if key in stream.columns and stream.columns.index(key) not in stream.empty:
                    return stream, key
        return None

    def clock_of(self, file: Path) -> FileClock:
        """The clock of a file."""
        return self.clocks.setdefault(file, FileClock())

    def seconds(
        self, file: Path, node: Node, values: Mapping[str, Values], units: Mapping[str, str]
    ) -> Array:
        """Times of a file, s."""
        clock = self.clock_of(file)
        time = clock.seconds(node, values, units)
        note = f"times count from {clock.origin_s:.0f} s after 1970"
        if clock.origin_s and file == self.path and note not in self.notes:
            self.start = as_date(int(clock.origin_s) * 10**9)
            self.notes.append(note)
        return time

    @property
    def segments(self) -> int:
        """Stretches in which time grows."""
        return max((len(stream.segments) for stream in self.streams), default=0)
