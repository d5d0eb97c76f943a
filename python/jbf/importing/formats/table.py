"""What every format gives: tables of columns that share their rows, read in blocks.

A recording with several clocks is several tables. Values come as they stand in the file: units and
meaning are others' work.
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

DAMAGED = 1e-3
"""Share of the rows of a text that may be damaged; one always may."""
BLOCK = 50_000
"""Rows that are held at a time."""
Values = npt.NDArray[Any]
"""float64, nan where there is no sample; text (object) of a column of words."""


@dataclass(frozen=True)
class Column:
    """One column of a file.

    Attributes
    ----------
    name
        As the file has it, one of its kind in the table.
    unit
        What the file says of its unit, apart from the name; empty where it says nothing.
    kind
        `number`; `instant`: read as seconds from the table's first instant; `word`: text.
    note
        What was seen of it that a person should know.
    """

    name: str
    unit: str = ""
    kind: Literal["number", "instant", "word"] = "number"
    note: str = ""


@dataclass(frozen=True)
class Table:
    """Columns that share their rows.

    Attributes
    ----------
    name
        Sheet, group or topic; empty where the file has but one.
    clock
        The column that the format itself gives as time, in seconds; None where it gives none.
    rows
        How many; None where only reading would tell.
    rate_hz
        The rate that the file states, where it states one.
    start
        The first instant as a date, where it is known.
    questions
        What cannot be decided of how it is written, each in a line.
    """

    name: str
    columns: tuple[Column, ...]
    clock: str | None = None
    rows: int | None = None
    rate_hz: float | None = None
    start: str | None = None
    questions: tuple[str, ...] = ()

    def column(self, name: str) -> Column:
        """The column of a name; an InputError says which there are."""
        for column in self.columns:
            if column.name == name:
                return column
        names = [column.name for column in self.columns]
        raise InputError(column=name, problem="is not there", mend=did_you_mean(name, names))


@dataclass(frozen=True)
class Options:
    """How a file is to be read, where a person knows better; None leaves it to be found out.

    Attributes
    ----------
    delimiter, decimal, thousands, encoding
        Of text.
    header
        The row of the names, the first being 1; 0 where there is none.
    units
        The row of the units; 0 where there is none.
    table
        The sheet, group, topic or variable; all by default.
    rate_hz
        Samples a second of a file without times.
    steady
        Whether each row is a steady state, in the place of a time: a table of a Stribeck curve.
    dates
        `day_first` or `month_first`, of dates written with slashes.
    empty
        Words that stand where there is no sample.
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
    """An open file."""

    path: Path
    tables: tuple[Table, ...]

    @abstractmethod
    def read_blocks(self, table: Table, names: Sequence[str]) -> Iterator[dict[str, Values]]:
        """What a format does of `blocks`; what its library raises, may leave it."""

    def blocks(self, table: Table, names: Sequence[str]) -> Iterator[dict[str, Values]]:
        """The columns of those names, in blocks of rows in the order of the file.

        Raises
        ------
        InputError
            A cell is wrong, or the file is broken there; names file, row and column.
        """
        with library_errors(self.path, "cannot be read"):
            yield from self.read_blocks(table, names)

    def head(self, table: Table, rows: int = 20_000) -> dict[str, Values]:
        """The first rows of every column."""
        names = [column.name for column in table.columns]
        parts: list[Mapping[str, Values]] = []
        there = 0
        for block in self.blocks(table, names):
            parts.append(block)
            there += len(next(iter(block.values()), ()))
            if there >= rows:
                break
        if not parts:
            return {name: np.empty(0) for name in names}
        return {name: np.concatenate([p[name] for p in parts])[:rows] for name in names}

    def row_of(self, table: Table, sample: int) -> int | None:
        """The row in the file, the first being 1, of a sample that is counted from 0; None where
        rows have no numbers that a person could go to."""
        return None

    def left_out(self) -> list[tuple[int, str, int | None]]:
        """How many rows the last reading passed over, why, and the first of them."""
        return []

    def read_bytes(self) -> tuple[int, int]:
        """How much of the file has been read, and its size; noughts where that is not known."""
        return 0, 0

    def close(self) -> None:  # noqa: B027 (most have nothing to let go of)
        """Let the file go."""

    def __enter__(self) -> Source:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


@contextmanager
def library_errors(path: Path, problem: str) -> Iterator[None]:
    """Whatever a broken file makes a library raise, in one line."""
    try:
        yield
    except (InputError, ModuleNotFoundError, MemoryError):
        raise
    except Exception as error:
        said = str(error).splitlines()[0].strip() if str(error).strip() else type(error).__name__
        mend = "save it anew, or name another file"
        raise InputError(file=path, problem=f"{problem} ({said})", mend=mend) from error


def unique(names: Sequence[str]) -> list[str]:
    """Names, each once: what stands twice is told apart by its place."""
    found: list[str] = []
    for at, name in enumerate(names, 1):
        if names.count(name) > 1 and name:
            name = f"{name} #{names[:at].count(name)}"
        found.append(name or f"column {at}")
    return found


def in_blocks(columns: Mapping[str, Values], size: int = BLOCK) -> Iterator[dict[str, Values]]:
    """Arrays that are there already, in blocks."""
    rows = max((len(values) for values in columns.values()), default=0)
    for first in range(0, rows, size):
        yield {name: values[first : first + size] for name, values in columns.items()}


def as_numbers(values: Any) -> Values:
    """An array as float64, or as text where it holds some."""
    array = np.asarray(values)
    if array.dtype.kind in "biuf":
        return array.astype(np.float64)
    return np.array([None if v is None else str(v) for v in array.tolist()], dtype=object)
