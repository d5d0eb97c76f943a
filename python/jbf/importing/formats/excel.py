"""Excel workbooks, by openpyxl, with the same layout rules for each sheet as for text files."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from datetime import date, datetime, time, timedelta
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
import openpyxl

from jbf.errors import InputError, quoted
from jbf.importing.formats.dialect import Dialect, is_empty, sniff
from jbf.importing.formats.layout import Layout, lay_out
from jbf.importing.formats.table import BLOCK, Column, Options, Source, Table, Values

_HEAD = 400
_EPOCH = datetime(1970, 1, 1)


class ExcelSource(Source):
    """Open Excel workbook; each sheet with samples is a table."""

    def __init__(self, path: Path, options: Options) -> None:
        self.path = path
        self.options = options
        self._book = openpyxl.load_workbook(path, read_only=True, data_only=True)
        self._layouts: dict[str, tuple[Layout, Dialect]] = {}
        # All sheets share one origin for dates and one for times of day, to compare their clocks.
        self._origins: dict[bool, float] = {}
        tables = [t for name in self._book.sheetnames if (t := self._table(name)) is not None]
        if not tables:
            raise InputError(
                file=path, problem="contains no numeric rows", remedy="name another file"
            )
        self.tables = tuple(tables)

    def _table(self, name: str) -> Table | None:
        rows = [
            (number, [_shown(cell) for cell in cells])
            for number, cells in islice(self._cells(name), _HEAD)
            if any(cell is not None for cell in cells)
        ]
        texts = [cell for _, cells in rows for cell in cells if "," in cell]
        dialect = sniff(texts[:50], ";", None, None) if texts else Dialect(";", ".")
        try:
            layout = lay_out(rows, _is_number, self.options.header, self.options.units)
        except InputError:
            return None
        self._layouts[name] = layout, dialect
        first = [cells for n, cells in islice(self._cells(name), _HEAD) if n >= layout.first]
        columns = []
        start = None
        for at, (column, unit) in enumerate(zip(layout.names, layout.units, strict=True)):
            cells = [row[at] for row in first if at < len(row) and row[at] is not None]
            if not cells:
                continue
            entry = Column(column, unit)
            if isinstance(cells[0], datetime | date | time | timedelta):
                entry = Column(column, "", "instant")
                self._origins.setdefault(_is_dated(cells[0]), _seconds(cells[0]))
                start = cells[0].isoformat() if isinstance(cells[0], datetime) else start
            elif isinstance(cells[0], str) and not dialect.is_number(cells[0].strip()):
                entry = Column(column, "", "word")
            columns.append(entry)
        return Table(name, tuple(columns), rate_hz=layout.rate_hz, start=start)

    def _cells(self, name: str) -> Iterator[tuple[int, Sequence[Any]]]:
        yield from enumerate(self._book[name].iter_rows(values_only=True), 1)

    def read_blocks(self, table: Table, names: Sequence[str]) -> Iterator[dict[str, Values]]:
        """Yield the named columns of a sheet in blocks of rows."""
        layout, dialect = self._layouts[table.name]
        places = {name: layout.names.index(name) for name in names}
        rows = (
            (number, cells)
            for number, cells in self._cells(table.name)
            if number >= layout.first and any(cell is not None for cell in cells)
        )
        while block := list(islice(rows, BLOCK)):
            columns: dict[str, Values] = {}
            for name, at in places.items():
                kind = table.column(name).kind
                cells = [(n, row[at] if at < len(row) else None) for n, row in block]
                if kind == "word":
                    columns[name] = np.array([_shown(cell) for _, cell in cells], dtype=object)
                elif kind == "instant":
                    columns[name] = np.array([self._instant(name, *cell) for cell in cells])
                else:
                    columns[name] = np.array([self._number(name, n, c, dialect) for n, c in cells])
            yield columns

    def _number(self, name: str, row: int, cell: Any, dialect: Dialect) -> float:
        if isinstance(cell, int | float):
            return float(cell)
        if cell is None or (
            isinstance(cell, str) and is_empty(cell, frozenset(self.options.empty))
        ):
            return float("nan")
        text = str(cell).strip()
        if dialect.is_number(text):
            return float(dialect.plain(text))
        raise self._wrong(name, row, cell, "a number")

    def _instant(self, name: str, row: int, cell: Any) -> float:
        if cell is None:
            return float("nan")
        if isinstance(cell, datetime | date | time | timedelta):
            return round(_seconds(cell) - self._origins.get(_is_dated(cell), 0.0), 6)
        raise self._wrong(name, row, cell, "a date")

    def _wrong(self, name: str, row: int, cell: Any, expected: str) -> InputError:
        problem = f"{quoted(cell)} is not {expected}"
        return InputError(
            file=self.path, row=row, column=name, problem=problem, remedy="correct the cell"
        )

    def row_of(self, table: Table, sample: int) -> int | None:
        """Row number of a sample in its sheet, without regard to empty rows."""
        return self._layouts[table.name][0].first + sample

    def close(self) -> None:
        """Close the file."""
        self._book.close()


def _is_dated(cell: datetime | date | time | timedelta) -> bool:
    return isinstance(cell, date)


def _seconds(cell: datetime | date | time | timedelta) -> float:
    if isinstance(cell, timedelta):
        return cell.total_seconds()
    if isinstance(cell, datetime):
        return (cell.replace(tzinfo=None) - _EPOCH).total_seconds()
    if isinstance(cell, time):
        return timedelta(
            hours=cell.hour, minutes=cell.minute, seconds=cell.second, microseconds=cell.microsecond
        ).total_seconds()
    return (datetime(cell.year, cell.month, cell.day) - _EPOCH).total_seconds()


def _shown(cell: Any) -> str:
    if cell is None:
        return ""
    if isinstance(cell, datetime):
        return cell.isoformat(" ")
    return str(cell).strip()


def _is_number(cell: str) -> bool:
    return Dialect(";", ".").is_number(cell) or Dialect(";", ",").is_number(cell)


def open_excel(path: Path, options: Options) -> Source:
    """Open an Excel workbook as a source of tables."""
    return ExcelSource(path, options)
