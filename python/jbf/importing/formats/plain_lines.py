"""Fast conversion of regular blocks of text lines by `numpy.loadtxt`.

`numpy.loadtxt` is several times faster than a loop over cells, and returns the same bits as
`float`. It cannot report the row and column of an invalid cell, nor keep the other rows. The caller
must convert a block that is not accepted.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from jbf.importing.formats.dialect import Dialect

_LONG = re.compile(r"[+-]?\d{16,19}")


def is_long_integer(cell: str) -> bool:
    """Whether a cell is an integer too long for float64, such as nanoseconds since 1970."""
    return _LONG.fullmatch(cell.strip()) is not None


def exact_integers(cells: Sequence[str]) -> npt.NDArray[np.int64] | None:
    """Convert cells to int64; None if a cell is not an integer of 64 bits."""
    try:
        return np.array(cells, dtype=np.str_).astype(np.int64)
    except (ValueError, OverflowError):
        return None


def plain_columns(
    lines: Sequence[str], dialect: Dialect, width: int, numeric: Sequence[int], text: Sequence[int]
) -> tuple[npt.NDArray[np.float64], list[list[str]]] | None:
    """Convert a block of regular lines to columns of numbers and of text.

    Parameters
    ----------
    width
        Number of cells of each line.
    numeric, text
        Positions of the columns to be read as numbers (at least one) and as text.

    Returns
    -------
    tuple of array and list, or None
        Numbers, one row for each numeric column, and cells of each text column. None if a line has
        another number of cells or a quote, or if a cell of a numeric column is not a finite number.
    """
    mark = dialect.delimiter
    if not numeric or dialect.thousands or any('"' in line for line in lines):
        return None
    if mark == " ":
        rows = [line.split() for line in lines]
        if any(len(row) != width for row in rows):
            return None
        cells = [[row[at] for row in rows] for at in text]
    else:
        if any(line.count(mark) != width - 1 for line in lines):
            return None
        cells = [[line.split(mark, at + 1)[at] for line in lines] for at in text]
    if dialect.decimal == ",":
        lines = [line.replace(",", ".") for line in lines]
    try:
        values = np.loadtxt(
            lines,
            delimiter=None if mark == " " else mark,
            comments=None,
            usecols=numeric,
            ndmin=2,
            unpack=True,
        )
    except ValueError:
        return None
    return (values, cells) if np.isfinite(values).all() else None
