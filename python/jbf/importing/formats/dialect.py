"""Dialect of a text file: its encoding, delimiter, and marks of decimals and thousands.

The delimiter is the one for which most lines have the same number of cells and most cells are
numbers. The decimal mark is determined together with it, since a comma between digits may be
either.
"""

from __future__ import annotations

import codecs
import csv
import gzip
import io
import re
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

from jbf.errors import InputError, quoted
from jbf.importing.formats.dates import is_instant

DELIMITERS = ("\t", ";", ",", "|", " ")
_EMPTY_WORDS = frozenset(
    [
        "nan",
        "n/a",
        "na",
        "#n/a",
        "#nv",
        "null",
        "none",
        "-",
        "--",
        "---",
        "?",
        "inf",
        "-inf",
        "#div/0!",
        "#value!",
        "nodata",
    ]
)
_NUMBER = r"[+-]?(?:\d+{d}?\d*|{d}\d+)(?:[eE][+-]?\d+)?"
_GROUPED = {
    ",": re.compile(r"[+-]?\d{1,3}(?:[.' \u00a0\u202f]\d{3})+(?:,\d*)?(?:[eE][+-]?\d+)?"),
    ".": re.compile(r"[+-]?\d{1,3}(?:[,' \u00a0\u202f]\d{3})+(?:\.\d*)?(?:[eE][+-]?\d+)?"),
}
_PLAIN = {mark: re.compile(_NUMBER.format(d=re.escape(mark))) for mark in ",."}
_PARTS = re.compile(r"[+-]?(\d+)([.,])(\d+)")


@dataclass(frozen=True)
class Dialect:
    """Delimiter of cells, and notation of numbers, in a text file.

    Attributes
    ----------
    delimiter
        Separator of cells; a blank means any number of blanks.
    decimal, thousands
        Marks within a number; `thousands` is empty if numbers are not grouped.
    question
        Open question on the notation, in one line; None if the notation is unambiguous.
    """

    delimiter: str
    decimal: str
    thousands: str = ""
    question: str | None = None

    def cells(self, line: str) -> list[str]:
        """Split a line into cells without surrounding blanks."""
        return [cell.strip() for cell in self.split(line)]

    def split(self, line: str) -> list[str]:
        """Split a line at the delimiter into cells, which may have surrounding blanks."""
        if self.delimiter == " ":
            return line.split()
        if '"' not in line:
            return line.split(self.delimiter)
        return next(csv.reader([line], delimiter=self.delimiter, skipinitialspace=True), [])

    def is_number(self, cell: str) -> bool:
        """Whether a cell holds a number."""
        return _is_number(cell, self.decimal)

    def plain(self, text: str) -> str:
        """Rewrite a number with a decimal point and without thousands separators."""
        if self.thousands:
            for mark in " \u00a0\u202f" if self.thousands == " " else self.thousands:
                text = text.replace(mark, "")
        return text.replace(",", ".") if self.decimal == "," else text


def is_empty(cell: str, words: frozenset[str] = frozenset()) -> bool:
    """Whether a cell denotes a missing sample (empty, or one of `words`)."""
    low = cell.strip().lower()
    return not low or low in _EMPTY_WORDS or low in words


def decode(data: bytes) -> str:
    """Determine the encoding of a text file from its first bytes.

    A byte order mark comes first, then UTF-8 if the bytes are valid, cp1252 if valid, and Latin-1.
    """
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        return "utf-16"
    # The data may end within a character.
    for cut in range(4):
        try:
            data[: len(data) - cut].decode("utf-8")
        except UnicodeDecodeError:
            continue
        return "utf-8-sig"
    try:
        data.decode("cp1252")
    except UnicodeDecodeError:
        return "latin-1"
    return "cp1252"


def sniff(
    lines: list[str], delimiter: str | None, decimal: str | None, thousands: str | None
) -> Dialect:
    """Determine the dialect from the first lines of a text; arguments that are given are kept."""
    lines = [line for line in lines if line.strip() and not line.lstrip().startswith(("#", "%"))]
    # Titles come before the samples: use the later lines only.
    sample = lines[len(lines) // 3 :][-200:] or lines
    # A quoted number may contain the delimiter.
    quotes = any('"' in line for line in sample)
    best: tuple[tuple[float, float, int], Dialect] | None = None
    for place, mark in enumerate([delimiter] if delimiter else DELIMITERS):
        for point in [decimal] if decimal else [".", ","]:
            if mark == point and not quotes:
                continue
            dialect = Dialect(mark, point, thousands or "")
            score = (*_score(dialect, sample), -place if point == "." else -place - 10)
            if best is None or score > best[0]:
                best = (score, dialect)
    assert best is not None
    likeliest = best[1]
    cells = [cell for line in sample for cell in likeliest.cells(line)]
    if thousands is None:
        likeliest = Dialect(
            likeliest.delimiter, likeliest.decimal, _thousands(cells, likeliest.decimal)
        )
    if decimal is None and likeliest.delimiter != ",":
        question = _ambiguity(cells)
        likeliest = Dialect(likeliest.delimiter, likeliest.decimal, likeliest.thousands, question)
    return likeliest


def _score(dialect: Dialect, lines: list[str]) -> tuple[float, float]:
    """Score of a dialect for given lines: share of regular numeric cells, and width (at most 2).

    The first value is the share of lines of the most common length, times the share of numbers in
    their non-empty cells.
    """
    rows = [dialect.cells(line) for line in lines]
    if not rows:
        return 0.0, 0.0
    width, count = Counter(map(len, rows)).most_common(1)[0]
    cells = [cell for row in rows if len(row) == width for cell in row]
    regular = sum(
        dialect.is_number(cell) or is_instant(cell) for cell in cells if not is_empty(cell)
    )
    # Empty cells are neutral; a text has one column only if no delimiter divides it.
    full = sum(not is_empty(cell) for cell in cells)
    share = (count / len(rows)) * (regular / full if full else 0.0)
    return round(share, 2), float(min(width, 2))


def _is_number(cell: str, decimal: str) -> bool:
    return bool(_PLAIN[decimal].fullmatch(cell) or _GROUPED[decimal].fullmatch(cell))


def _thousands(cells: list[str], decimal: str) -> str:
    """Thousands separator of numbers with this decimal mark; empty if they have none."""
    for cell in cells:
        if _GROUPED[decimal].fullmatch(cell) and not _PLAIN[decimal].fullmatch(cell):
            mark = next(c for c in cell if not c.isdigit() and c not in "+-")
            return " " if mark in " \u00a0\u202f" else mark
    return ""


def _ambiguity(cells: list[str]) -> str | None:
    """Question to the user if each comma precedes three digits (thousands or decimals), or None."""
    matches = [m for cell in cells if (m := _PARTS.fullmatch(cell)) is not None]
    commas = [m for m in matches if m[2] == ","]
    if not commas or any(m[2] == "." for m in matches) or len(commas) < len(matches):
        return None
    if all(len(m[3]) == 3 and 1 <= len(m[1]) <= 3 and m[1][0] != "0" for m in commas):
        return (
            f'{quoted(commas[0][0])} is ambiguous; set decimal = "," or decimal = '
            '"." and thousands = "," under [file]'
        )
    return None


def opened(path: Path) -> io.BufferedReader | gzip.GzipFile:
    """Open a plain or gzipped file as a stream of bytes."""
    try:
        file = path.open("rb")
        if file.read(2) == b"\x1f\x8b":
            file.seek(0)
            return gzip.GzipFile(fileobj=file)
        file.seek(0)
    except OSError as error:
        reason = (error.strerror or type(error).__name__).lower()
        remedy = "check the path and its permissions"
        raise InputError(file=path, problem=f"cannot be read ({reason})", remedy=remedy) from None
    return file


def known_encoding(encoding: str) -> str:
    """Name of an encoding if Python knows it, otherwise Latin-1."""
    try:
        return codecs.lookup(encoding).name
    except LookupError:
        return "latin-1"
