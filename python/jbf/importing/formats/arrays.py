"""Source of tables whose columns are arrays that can be sliced (NumPy, MAT, HDF5)."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from jbf.errors import InputError
from jbf.importing.formats.table import (
    BLOCK,
    Column,
    Options,
    Source,
    Table,
    Values,
    as_numbers,
    unique,
)

Slice = Callable[[int, int], Any]
"""Function that returns the values of a column between two rows (end exclusive)."""
_WIDEST = 64
"""Largest number of columns of a matrix of channels; wider matrices are ignored."""
_NAMED = 3
"""Largest number of columns that are listed in the generated name of a table."""
CLOCK = "time"
"""Name of the time column of signals with separate times."""


@dataclass(frozen=True)
class Signal:
    """One channel with its own times.

    Attributes
    ----------
    name
        Name of the channel.
    times
        Times of the samples, in `time_unit`.
    read
        Samples, one for each time.
    unit, time_unit
        Units of the samples and of the times; empty if the file states none.
    """

    name: str
    times: npt.NDArray[Any]
    read: Slice
    unit: str = ""
    time_unit: str = ""


class ArraySource(Source):
    """Open file whose tables have columns that are read by slices."""

    def __init__(self, path: Path, close: Callable[[], None] | None = None) -> None:
        self.path = path
        self.tables = ()
        self._columns: dict[str, dict[str, Slice]] = {}
        self._close = close
        self._origin: np.datetime64 | None = None
        self.passed_over: list[tuple[int, str, int | None]] = []

    def add(
        self,
        name: str,
        columns: Mapping[str, tuple[Slice, str]],
        rows: int,
        clock: str | None = None,
        start: str | None = None,
        rate_hz: float | None = None,
    ) -> None:
        """Add a table to the source, from column names with their slices and units."""
        if rows == 0 or not columns:
            return
        kept_columns = []
        for column, (read, unit) in columns.items():
            kind = np.asarray(read(0, min(rows, 2))).dtype.kind
            if kind in "biuf":
                kept_columns.append(Column(column, unit))
            elif kind == "M":
                kept_columns.append(Column(column, "", "instant"))
            elif kind in "OSU":
                kept_columns.append(Column(column, "", "word"))
        self._columns[name] = {c.name: columns[c.name][0] for c in kept_columns}
        self.tables = (*self.tables, Table(name, tuple(kept_columns), clock, rows, rate_hz, start))

    def read_blocks(self, table: Table, names: Sequence[str]) -> Iterator[dict[str, Values]]:
        """Yield the named columns of a table in blocks of rows."""
        readers = {name: self._columns[table.name][table.column(name).name] for name in names}
        kinds = {name: table.column(name).kind for name in names}
        assert table.rows is not None
        for first in range(0, table.rows, BLOCK):
            block = {}
            for name, read in readers.items():
                values = np.asarray(read(first, min(first + BLOCK, table.rows)))
                if kinds[name] == "instant":
                    # All columns of dates share one origin, so that their clocks can be compared.
                    self._origin = self._origin or first_instant(values)
                    block[name] = seconds(values, self._origin)
                else:
                    block[name] = as_numbers(values)
            yield block

    def skipped_rows(self) -> list[tuple[int, str, int | None]]:
        """Number, reason and first row of the rows or records that the format skipped."""
        return self.passed_over

    def close(self) -> None:
        """Close the file."""
        if self._close is not None:
            self._close()


def first_instant(instants: Any) -> np.datetime64 | None:
    """First valid date of an array of dates, or None."""
    fine = np.asarray(instants).astype("datetime64[ns]")
    valid = fine[~np.isnat(fine)]
    return valid[0] if valid.size else None


def seconds(instants: Any, origin: np.datetime64 | None) -> Values:
    """Convert dates to seconds since `origin`; NaN for a missing date."""
    fine = np.asarray(instants).astype("datetime64[ns]")
    if origin is None:
        return np.full(len(fine), np.nan)
    elapsed_s: Values = (fine - origin).astype(np.int64) / 1e9
    elapsed_s[np.isnat(fine)] = np.nan
    return elapsed_s


def slices(values: Any) -> Slice:
    """Function that reads rows from a vector in memory, `first` to `end` exclusive."""
    return lambda first, end: values[first:end]


def add_by_length(
    source: ArraySource, vectors: Mapping[str, tuple[Any, str]], options: Options
) -> None:
    """Group vectors of equal length into tables and add these to the source."""
    lengths = dict.fromkeys(len(values) for values, _ in vectors.values())
    for length in lengths:
        if length < 2:
            continue
        group = {n: (slices(v), unit) for n, (v, unit) in vectors.items() if len(v) == length}
        source.add(f"{length} samples" if _several(lengths) else "", group, length)
    if not source.tables:
        raise InputError(
            file=source.path, problem="contains no numeric columns", remedy="name another file"
        )


def add_by_clock(source: ArraySource, signals: Iterable[Signal], only_table: bool = True) -> None:
    """Group signals with equal times into tables and add these to the source.

    Times in seconds become the clock of the table.

    Parameters
    ----------
    only_table
        Whether the file has no other tables, so that a single table needs no name.
    """
    sampled = [signal for signal in signals if len(signal.times)]
    _, *names = unique([CLOCK, *(signal.name for signal in sampled)])
    groups: dict[tuple[str, bytes], dict[str, Signal]] = {}
    for name, signal in zip(names, sampled, strict=True):
        groups.setdefault((signal.time_unit, signal.times.tobytes()), {})[name] = signal
    for (unit, _), group in groups.items():
        times = next(iter(group.values())).times
        columns = {name: (signal.read, signal.unit) for name, signal in group.items()}
        source.add(
            "" if only_table and len(groups) == 1 else table_name(list(group)),
            {CLOCK: (slices(times), unit), **columns},
            len(times),
            CLOCK if unit == "s" else None,
        )


def table_name(columns: Sequence[str]) -> str:
    """Name for an unnamed table: its column names, or the first and the number of others."""
    if len(columns) <= _NAMED:
        return ", ".join(columns)
    return f"{columns[0]} and {len(columns) - 1} more"


def _several(lengths: Mapping[int, None]) -> bool:
    """Whether at least two of the lengths of the vectors exceed one sample."""
    return sum(length > 1 for length in lengths) > 1


def vectors_of(name: str, values: Any) -> dict[str, Any]:
    """Split an array into numeric columns with names.

    A vector is one column; a matrix or an array of records has several. The result is empty for any
    other array and for a matrix that is too wide.
    """
    array = values
    if array.dtype.names:
        flat = array.reshape(-1)
        return {f"{name}.{n}" if name else n: flat[n] for n in array.dtype.names}
    if array.ndim == 1:
        return {name or "column 1": array}
    if array.ndim != 2:
        return {}
    if 1 in array.shape:
        return {name or "column 1": array.reshape(-1)}
    if array.shape[0] < array.shape[1]:
        array = array.T
    if array.shape[1] > _WIDEST:
        return {}
    lead = f"{name} " if name else ""
    return {f"{lead}column {i + 1}": array[:, i] for i in range(array.shape[1])}
