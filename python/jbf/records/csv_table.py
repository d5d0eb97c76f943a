"""Lines and cells of a CSV file: the rows of a table, or its columns if the table is regular."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from jbf.arrays import Array
from jbf.errors import InputError
from jbf.text_files import read_text

HEADER_EXAMPLE = "time_s,velocity_m_s,friction_n"


def lines_of(path: Path) -> tuple[list[str], int, str]:
    """Return the lines of a file, the index of the header, and the delimiter."""
    # Universal newlines only; str.splitlines would also split at other characters.
    lines = list(io.StringIO(read_text(path), newline=None))
    first = 0
    while first < len(lines) and (
        not lines[first].strip() or lines[first].lstrip().startswith("#")
    ):
        first += 1
    if first == len(lines):
        raise InputError(
            file=path, problem="is empty", remedy=f"start with a header such as {HEADER_EXAMPLE}"
        )
    return lines, first, max(",;\t", key=lines[first].count)


def plain_columns(lines: Sequence[str], first: int, delimiter: str) -> Array | None:
    """Values of a regular table, shape (columns, rows); None if any line is not regular.

    In a regular table every line after the header has the same number of finite numbers. It is read
    by `numpy.loadtxt`, which returns the same bits as `float` in a fifth of the time.
    """
    rows = lines[first + 1 :]
    width = lines[first].count(delimiter) + 1
    if not rows or '"' in lines[first]:
        return None
    try:
        values = np.loadtxt(rows, delimiter=delimiter, comments=None, ndmin=2, unpack=True)
    except ValueError:
        return None
    # Blank lines are skipped without an error.
    return values if values.shape == (width, len(rows)) and np.isfinite(values).all() else None


def read_table(
    path: Path, lines: Sequence[str], first: int, delimiter: str
) -> tuple[list[list[str]], list[int]]:
    """Return the rows of cells with the header first, and the line of each row.

    Blank lines are skipped.
    """
    reader = csv.reader(lines[first:], delimiter=delimiter)
    records: list[list[str]] = []
    numbers: list[int] = []
    line = first

    def wrong(row: int, problem: str) -> InputError:
        remedy = "correct the row; one line is one row"
        return InputError(file=path, row=row, problem=problem, remedy=remedy)

    try:
        for cells in reader:
            line += 1
            if first + reader.line_num > line:
                raise wrong(line, "a quotation mark is not closed")
            if cells:
                records.append(cells)
                numbers.append(line)
    except csv.Error as error:
        raise wrong(line + 1, str(error)) from None
    return records, numbers
