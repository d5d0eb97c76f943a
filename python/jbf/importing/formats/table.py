"""Common interface of all file formats: tables of columns, read in blocks of rows.

A recording with several clocks has several tables. Values are those of the file: other modules
interpret units and meaning.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from jbf.errors import InputError, did_you_mean

MAX_DAMAGED_SHARE = 1e-3
"""Largest share of damaged rows in a text file; one damaged row is always permitted."""
BLOCK = 50_000
"""Number of rows in memory at a time."""
LARGEST_EXACT, LARGEST_INTEGER = 2.0**53, 2.0**63
"""Magnitudes up to which every integer is exact as float64, and up to which it fits in int64."""
Values = npt.NDArray[Any]
"""Values of a column: float64 with NaN for a missing sample, int64 if float64 would round, or text
(object) for words.
"""


@dataclass(frozen=True)
class Column:
    """One column of a file.

    Attributes
    ----------
    name
        Name in the file, unique in the table.
    unit
        Unit that the file states apart from the name; empty if not stated.
    kind
        `number`; `instant`: read as seconds from the table's first instant; `word`: text.
    note
        Remark on the column for the user.
    """

    name: str
    unit: str = ""
    kind: Literal["number", "instant", "word"] = "number"
    note: str = ""


@dataclass(frozen=True)
class Table:
    """Table of a file: columns that share their rows and their clock.

    Attributes
    ----------
    name
        Sheet, group or topic; empty if the file has only one.
    clock
        Time column, in seconds, that the format itself defines; None if it defines none.
    rows
        Number of rows; None if it is unknown before reading.
    rate_hz
        Sampling rate that the file states, if any, Hz.
    start
        First instant as a date, if known.
    questions
        Open questions about the notation of the file, one line each.
    """

    name: str
    columns: tuple[Column, ...]
    clock: str | None = None
    rows: int | None = None
    rate_hz: float | None = None
    start: str | None = None
    questions: tuple[str, ...] = ()

    def column(self, name: str) -> Column:
        """Column with a given name; an unknown name raises an InputError with a suggestion."""
        for column in self.columns:
            if column.name == name:
                return column
        names = [column.name for column in self.columns]
        raise InputError(column=name, problem="does not exist", remedy=did_you_mean(name, names))


@dataclass(frozen=True)
class Options:
    """Options for reading a file; None means that the option is detected.

    Attributes
    ----------
    delimiter, decimal, thousands, encoding
        Notation of a text file.
    header
        Row of the names, counted from 1; 0 for a file without names.
    units
        Row of the units; 0 for a file without units.
    table
        Sheet, group, topic or variable; all by default.
    rate_hz
        Sampling rate of a file without times, Hz.
    steady
        Whether each row is a steady state without a time, as in a table of a Stribeck curve.
    dates
        `day_first` or `month_first`, for dates with slashes.
    empty
        Words that denote a missing sample.
    """

    delimiter: str | None = None
    decimal: str | None = None
    thousands: str | None = None
    encoding: str | None = None
    header: int | None = None
    units: int | None = None
    table: str | None = None
    rate_hz: float | None = None
    steady: bool = False
    dates: str | None = None
    empty: tuple[str, ...] = field(default=())


class Source(ABC):
    """Open file with its tables.

    Attributes
    ----------
    path
        The file.
    tables
        Tables of the file.
    """

    path: Path
    tables: tuple[Table, ...]

    @abstractmethod
    def read_blocks(self, table: Table, names: Sequence[str]) -> Iterator[dict[str, Values]]:
        """Yield blocks as `blocks` does; errors of the format's library may be raised."""

    def blocks(self, table: Table, names: Sequence[str]) -> Iterator[dict[str, Values]]:
        """Yield the named columns in blocks of rows, in the order of the file.

        Raises
        ------
        InputError
            If a cell is invalid, or the file is broken; names file, row and column.
        """
        with library_errors(self.path, "cannot be read"):
            yield from self.read_blocks(table, names)

    def head(self, table: Table, rows: int = 20_000) -> dict[str, Values]:
        """First rows of every column of a table."""
        names = [column.name for column in table.columns]
        parts: list[Mapping[str, Values]] = []
        row_count = 0
        for block in self.blocks(table, names):
            parts.append(block)
            row_count += len(next(iter(block.values()), ()))
            if row_count >= rows:
                break
        if not parts:
            return {name: np.empty(0) for name in names}
        return {name: np.concatenate([p[name] for p in parts])[:rows] for name in names}

    def row_of(self, table: Table, sample: int) -> int | None:
        """Row number in the file, counted from 1, of a sample, counted from 0.

        Returns None if the rows of the file have no numbers that a user could look up.
        """
        return None

    def skipped_rows(self) -> list[tuple[int, str, int | None]]:
        """Number, reason and first row of the rows that the last reading skipped."""
        return []

    def read_bytes(self) -> tuple[int, int]:
        """Number of bytes read and size of the file; zeros if unknown."""
        return 0, 0

    def close(self) -> None:  # noqa: B027 (most have nothing to close)
        """Close the file."""

    def __enter__(self) -> Source:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


@contextmanager
def library_errors(path: Path, problem: str) -> Iterator[None]:
    """Context in which any error of a format's library becomes an InputError of one line."""
    try:
        yield
    except (InputError, ModuleNotFoundError, MemoryError):
        raise
    except Exception as error:
        reason = str(error).splitlines()[0].strip() if str(error).strip() else type(error).__name__
        remedy = "save it again, or name another file"
        raise InputError(file=path, problem=f"{problem} ({reason})", remedy=remedy) from error


def unique(names: Sequence[str]) -> list[str]:
    """Make names unique: repeated names are numbered, and empty names become `column N`."""
    unique_names: list[str] = []
    for at, name in enumerate(names, 1):
        if names.count(name) > 1 and name:
            name = f"{name} #{names[:at].count(name)}"
        unique_names.append(name or f"column {at}")
    return unique_names


def in_blocks(columns: Mapping[str, Values], size: int = BLOCK) -> Iterator[dict[str, Values]]:
    """Yield arrays in memory as blocks of rows."""
    rows = max((len(values) for values in columns.values()), default=0)
    for first in range(0, rows, size):
        yield {name: values[first : first + size] for name, values in columns.items()}


def as_numbers(values: Any) -> Values:
    """Convert an array to float64, or to text if it contains any.

    Integers that float64 would round, such as nanoseconds since 1970, become int64.
    """
    array = np.asarray(values)
    if array.dtype.kind in "biuf":
        numbers = array.astype(np.float64)
        size = np.abs(numbers).max(initial=0.0) if array.dtype.kind in "iu" else 0.0
        return array.astype(np.int64) if LARGEST_EXACT < size < LARGEST_INTEGER else numbers
    return np.array([None if v is None else str(v) for v in array.tolist()], dtype=object)
