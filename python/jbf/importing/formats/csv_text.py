"""Text files of loggers, oscilloscopes, spreadsheets and drives (CSV), plain or gzipped.

Files are read in blocks of lines. A block is converted to numbers as a whole. If this conversion
fails, the block is converted cell by cell, so that errors state the row and column.
"""

from __future__ import annotations

import gzip
import io
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import islice
from pathlib import Path

import numpy as np

from jbf.errors import InputError, quoted
from jbf.importing.formats.arrays import table_name
from jbf.importing.formats.channel_rows import lay_out_channels
from jbf.importing.formats.damaged_rows import DamagedRows
from jbf.importing.formats.dates import (
    Instants,
    as_date,
    day_or_month_first,
    is_file_time,
    is_instant,
    seconds_since,
)
from jbf.importing.formats.dialect import (
    Dialect,
    decode,
    is_empty,
    known_encoding,
    opened,
    sniff,
)
from jbf.importing.formats.layout import LABEL, Layout, Part, lay_out, merged
from jbf.importing.formats.plain_lines import exact_integers, is_long_integer, plain_columns
from jbf.importing.formats.table import BLOCK, Column, Options, Source, Table, Values
from jbf.importing.formats.trace_blocks import is_trace, open_trace

SUFFIXES = (".csv", ".txt", ".tsv", ".dat", ".asc", ".lvm", ".log", ".prn", ".gz")
_HEAD_LINES = 400
_HEAD_BYTES = 1 << 20
_TRACE_BYTES = 1 << 14
_COMMENTS = ("#", "%", "//")


class TextSource(Source):
    """Open text file with one table, or with several tables in adjacent columns."""

    def __init__(self, path: Path, options: Options) -> None:
        self.path = path
        self.options = options
        with opened(path) as file:
            data = file.read(_HEAD_BYTES)
        if b"\0" in data and not data.startswith((b"\xff\xfe", b"\xfe\xff")):
            raise InputError(file=path, problem="is binary, not text", remedy="name another file")
        self.encoding = options.encoding or decode(data)
        self._words: list[int] = []
        self._exact: set[str] = set()
        self._damage = DamagedRows(path)
        self._firsts: dict[bool, int] = {}
        self._origins: dict[str, tuple[int, str | None]] = {}
        self._handle: io.BufferedReader | gzip.GzipFile | None = None
        lines = [line for _, line in islice(self._lines(), _HEAD_LINES)]
        if not any(line.strip() for line in lines):
            raise InputError(file=path, problem="is empty", remedy="name a file with samples")
        self.dialect = sniff(lines, options.delimiter, options.decimal, options.thousands)
        self.empty = frozenset(word.lower() for word in options.empty)
        self.layout = self._laid_out(lines)
        self.tables = tuple(self._tables())

    def _lines(self) -> Iterator[tuple[int, str]]:
        """Yield every line of the file with its number."""
        with opened(self.path) as raw:
            self._handle = raw
            try:
                text = io.TextIOWrapper(raw, self.encoding, errors="replace", newline=None)
            except LookupError:
                raise InputError(
                    file=self.path,
                    problem=f"the encoding {quoted(self.encoding)} is not known",
                    remedy='write one such as "utf-8" or "latin-1"',
                ) from None
            try:
                for number, line in enumerate(text, 1):
                    # Some programs write the typographic minus sign.
                    yield number, line.replace("\u2212", "-")
            except (OSError, EOFError, UnicodeError) as error:
                problem = f"cannot be read ({error})"
                raise InputError(file=self.path, problem=problem, remedy="save it again") from None

    def _laid_out(self, lines: list[str]) -> Layout:
        """Determine the layout from the first lines of the file."""
        rows = [
            (number, self.dialect.cells(line.rstrip("\n")))
            for number, line in enumerate(lines, 1)
            if line.strip() and not line.lstrip().startswith(_COMMENTS)
        ]
        options = self.options
        if options.header is None and (channels := lay_out_channels(rows)) is not None:
            if self.dialect.delimiter == " ":
                raise InputError(
                    file=self.path,
                    problem="is separated by blanks, which channel names may contain",
                    remedy="export it with tabs or semicolons",
                )
            return channels
        try:
            layout = lay_out(rows, self.dialect.is_number, options.header, options.units)
        except InputError as error:
            raise error.within(file=self.path) from None
        if layout.headless and options.header is None:
            # The names may be in a comment, as numpy.savetxt writes them.
            comment_rows = [
                (n, self.dialect.cells(line.strip().lstrip("#%/ ")))
                for n, line in enumerate(lines[: layout.first - 1], 1)
                if line.lstrip().startswith(_COMMENTS)
            ]
            fitting = [row for row in comment_rows if len(row[1]) == len(layout.names)]
            if fitting:
                samples = [row for row in rows if row[0] >= layout.first]
                layout = lay_out([*fitting, *samples], self.dialect.is_number)
        return layout

    def _tables(self) -> Iterator[Table]:
        """Yield the tables of the file."""
        first = list(islice(self._rows(self._samples()), 500))
        columns: list[Column] = []
        questions, start = list[str](), self.layout.start
        if self.dialect.question:
            questions.append(self.dialect.question)
        for at, (name, unit) in enumerate(zip(self.layout.names, self.layout.units, strict=True)):
            cells = [c for _, row in first if not is_empty(c := row[at].strip(), self.empty)]
            column = Column(name, unit)
            if cells and not any(map(self.dialect.is_number, cells)):
                dated = sum(map(is_instant, cells)) > 0.9 * len(cells)
                column = replace(column, kind="instant" if dated else "word", unit="")
            elif cells and all(map(is_file_time, cells)):
                column = replace(column, kind="instant", unit="")
            elif cells and all(map(is_long_integer, cells)):
                self._exact.add(name)
            if column.kind == "instant":
                order = self.options.dates or day_or_month_first(cells)
                if order is None:
                    questions.append(
                        f"column {name}: {quoted(cells[0])} is ambiguous; set dates = "
                        '"day_first" or "month_first" under [file]'
                    )
                try:
                    instant = int(Instants(order or "day_first").parse(cells[:1], [False])[0])
                except InputError as error:
                    raise InputError(
                        file=self.path, column=name, problem=error.problem, remedy=error.remedy
                    ) from None
                start = as_date(instant) or start
                # All columns of dates share one origin, and all columns of times of day another, so
                # that their clocks can be compared.
                dated = as_date(instant) is not None
                self._firsts.setdefault(dated, instant)
                self._origins[name] = (self._firsts[dated], order)
            columns.append(column)
        kept = [c for c in columns if self._is_kept(c, first)]
        parts = merged(self.layout.parts, (cells for _, cells in self._rows(self._samples()))) or (
            Part(tuple(range(len(columns))), None, self.layout.rate_hz),
        )
        for part in parts:
            table_columns = [columns[at] for at in part.columns if columns[at] in kept]
            channels = [c.name for c in table_columns if columns.index(c) != part.clock]
            yield Table(
                table_name(channels) if len(parts) > 1 else "",
                tuple(table_columns),
                rate_hz=self.options.rate_hz or part.rate_hz,
                start=start,
                questions=tuple(questions),
            )

    def _clock_of(self, table: Table) -> int | None:
        """Index of the time column of a table if the file has several tables, otherwise None.

        Rows without a time do not belong to the table.
        """
        if len(self.tables) < 2:
            return None
        places = [self.layout.names.index(column.name) for column in table.columns]
        clocks = [part.clock for part in self.layout.parts]
        return next((at for at in places if at in clocks), None)

    def _is_kept(self, column: Column, rows: Sequence[tuple[int, list[str]]]) -> bool:
        """Whether a column has a name or values.

        A column without name and values results from a delimiter at the end of each line.
        """
        at = self.layout.names.index(column.name)
        if column.name.startswith(LABEL):
            return column.kind != "word"
        return not column.name.startswith("column ") or any(row[at].strip() for _, row in rows)

    def _samples(self) -> Iterator[tuple[int, str]]:
        """Yield every line from the first row of samples, without blank lines and comments."""
        for number, line in self._lines():
            if number >= self.layout.first and line.strip() and not line.startswith(_COMMENTS):
                yield number, line

    def _rows(
        self,
        lines: Iterable[tuple[int, str]],
        damage: DamagedRows | None = None,
        words: list[int] | None = None,
    ) -> Iterator[tuple[int, list[str]]]:
        """Yield every row of samples with its number, with one cell for each name.

        Parameters
        ----------
        lines
            Lines from `_samples`.
        damage, words
            Counter of damaged rows, and list of text rows; both kinds of rows are skipped.
        """
        damage, words = damage or DamagedRows(self.path), [] if words is None else words
        names = self.layout.names
        width, first_name = len(names), names[0]
        split = self.dialect.split
        for number, line in lines:
            damage.rows += 1
            cells = split(line.rstrip("\n"))
            few = len(cells) < width and (self.dialect.delimiter == " " or len(cells) < width // 2)
            # Shorter tables may end before the tables next to them.
            few = few and not self.layout.parts
            if few or (len(cells) > width and any(cells[width:])):
                problem = f"has {len(cells)} cells where the header has {width}"
                remedy = "correct the row, or set delimiter and decimal under [file]"
                damage.add(InputError(row=number, problem=problem, remedy=remedy))
                continue
            # Empty cells at the end may be missing.
            cells += [""] * (width - len(cells))
            if cells[0].strip() == first_name and [c.strip() for c in cells[:width]] == [*names]:
                continue  # a restarted logger writes its header again
            if cells[0][:1].isalpha() and not any(map(self._counts, cells)):
                words.append(number)  # "End of data"
                continue
            yield number, cells if len(cells) == width else cells[:width]

    def _counts(self, cell: str) -> bool:
        """Whether a cell is a number or a date."""
        cell = cell.strip()
        return self.dialect.is_number(cell) or is_instant(cell)

    def skipped_rows(self) -> list[tuple[int, str, int | None]]:
        """Number, reason and first row of text rows among the samples, and of damaged rows."""
        words = [(len(self._words), "only words", self._words[0])] if self._words else []
        return [*words, *self._damage.skipped_rows()]

    def read_blocks(self, table: Table, names: Sequence[str]) -> Iterator[dict[str, Values]]:
        """Yield the named columns of a table in blocks of rows."""
        places = [self.layout.names.index(table.column(name).name) for name in names]
        kinds = [table.column(name).kind for name in names]
        readers = {
            name: Instants(self._origins[name][1] or "day_first")
            for name, kind in zip(names, kinds, strict=True)
            if kind == "instant"
        }
        self._words, self._damage = [], DamagedRows(self.path)
        clock = self._clock_of(table)
        columns = list(zip(places, names, kinds, strict=True))
        numeric = [at for at, name, kind in columns if kind == "number" and name not in self._exact]
        text = [at for at in places if at not in numeric]
        lines = self._samples()
        while block := list(islice(lines, BLOCK)):
            parsed = None
            if clock is None:
                parsed = plain_columns(
                    [line for _, line in block], self.dialect, len(self.layout.names), numeric, text
                )
            wrong: dict[int, InputError] = {}
            if parsed is not None:
                self._damage.rows += len(block)
                numbers = [number for number, _ in block]
                turned = dict(zip([*numeric, *text], [*parsed[0], *parsed[1]], strict=True))
            else:
                rows = [
                    (number, cells)
                    for number, cells in self._rows(block, self._damage, self._words)
                    if clock is None or cells[clock].strip()
                ]
                if not rows:
                    continue
                numbers = [number for number, _ in rows]
                turned = dict(enumerate(zip(*[cells for _, cells in rows], strict=True)))
            block_columns: dict[str, Values] = {}
            for at, name, kind in columns:
                cells = turned[at]
                if kind == "word":
                    block_columns[name] = np.array([cell.strip() for cell in cells], dtype=object)
                elif kind == "instant":
                    block_columns[name] = self._instants(name, cells, numbers, readers[name])
                elif name in self._exact and (whole := exact_integers(cells)) is not None:
                    block_columns[name] = whole
                elif parsed is not None and name not in self._exact:
                    block_columns[name] = cells
                else:
                    block_columns[name] = self._numbers(name, cells, numbers, wrong)
            if wrong:
                for at in sorted(wrong):
                    self._damage.add(wrong[at])
                valid = np.ones(len(numbers), dtype=bool)
                valid[list(wrong)] = False
                block_columns = {name: values[valid] for name, values in block_columns.items()}
            yield block_columns
        self._damage.check()

    def _numbers(
        self,
        name: str,
        cells: Sequence[str],
        rows: Sequence[int],
        wrong: dict[int, InputError],
    ) -> Values:
        """Convert the cells of a column to numbers; collect errors in `wrong` by their index."""
        dialect = self.dialect
        is_plain = dialect.decimal == "." and not dialect.thousands
        try:
            values = map(float, cells if is_plain else map(dialect.plain, cells))
            numbers = np.fromiter(values, np.float64, len(cells))
            if np.isfinite(numbers).all():
                return numbers
        except ValueError:
            pass
        numbers = np.full(len(cells), np.nan)
        for at, cell in enumerate(map(str.strip, cells)):
            if is_empty(cell, self.empty):
                continue
            if not dialect.is_number(cell):
                other_decimal = "," if dialect.decimal == "." else "."
                remedy = f'correct the cell; a missing value needs empty = ["{cell}"] under [file]'
                if Dialect(dialect.delimiter, other_decimal).is_number(cell):
                    remedy = "use one decimal mark in all cells"
                problem = f"{quoted(cell)} is not a number"
                error = InputError(row=rows[at], column=name, problem=problem, remedy=remedy)
                wrong.setdefault(at, error)
                continue
            numbers[at] = float(dialect.plain(cell))
        numbers[~np.isfinite(numbers)] = np.nan
        return numbers

    def _instants(
        self, name: str, cells: Sequence[str], rows: Sequence[int], reader: Instants
    ) -> Values:
        """Convert the cells of a column of dates to seconds from the first instant."""
        empty = [is_empty(cell, self.empty) for cell in cells]
        try:
            instants = reader.parse(cells, empty)
        except InputError as error:
            raise InputError(
                file=self.path,
                row=rows[error.row or 0],
                column=name,
                problem=error.problem,
                remedy=error.remedy,
            ) from None
        return seconds_since(instants, self._origins[name][0])

    def row_of(self, table: Table, sample: int) -> int | None:
        """Line number in the file of a sample, counted from 0."""
        bad, clock = self._damage.lines, self._clock_of(table)
        valid_rows = (
            number
            for number, cells in self._rows(self._samples())
            if number not in bad and (clock is None or cells[clock].strip())
        )
        return next(islice(valid_rows, sample, None), None)

    def read_bytes(self) -> tuple[int, int]:
        """Number of bytes read so far, and the size of the file."""
        size = self.path.stat().st_size
        handle = self._handle
        if handle is None or handle.closed:
            return 0, size
        raw = getattr(handle, "fileobj", None) or handle
        return min(int(raw.tell()), size), size


def open_text(path: Path, options: Options) -> Source:
    """Open a text file: a table, or a trace export with one block per variable."""
    with opened(path) as file:
        begin = file.read(_TRACE_BYTES)
    encoding = options.encoding or decode(begin)
    # An unknown encoding causes an error when the text is read.
    if is_trace(begin.decode(known_encoding(encoding), errors="replace").splitlines()):
        with opened(path) as file:
            return open_trace(path, io.TextIOWrapper(file, encoding, errors="replace"))
    return TextSource(path, options)
