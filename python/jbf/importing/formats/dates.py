"""Dates and times of day in the notations of loggers, in whole nanoseconds.

Notations: ISO 8601, `31.12.2026 23:59:59,125`, `31-Dec-2026 23:59:59`,
`12/31/2026 11:59:59.125 PM`, `23:59:59.125`, file times of Windows. If times of
day decrease, they continue on the next day.

A column is converted by NumPy. Cells are grouped by their shape, which is the text with each digit
replaced by 0. The pattern is matched once for each shape, and the digits of all its cells are
combined.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from jbf.errors import InputError, quoted

Nanoseconds = npt.NDArray[np.int64]
DAY_FIRST, MONTH_FIRST = "day_first", "month_first"
NO_INSTANT = int(np.iinfo(np.int64).min)
"""Value of an empty cell; equal to the NaT of NumPy."""

_DAY_NS = 86_400 * 10**9
_FILE_TIME = re.compile(r"1[23]\d{16}")
_FILE_TIME_1970 = 116_444_736 * 10**9
"""The year 1970 as a file time of Windows, which counts 100 ns from 1601."""
_INSTANT = re.compile(
    r"(?:(?:(?P<y>\d{4})[-/.](?P<m>\d{1,2})[-/.](?P<d>\d{1,2})"
    r"|(?P<a>\d{1,2})(?P<mark>[-/.])(?P<b>\d{1,2})[-/.](?P<y2>\d{4}|\d{2})"
    r"|(?P<d3>\d{1,2})[- ](?P<name>(?u:[^\W\d_]{3,4}))(?u:[^\W\d_]*)\.?[- ](?P<y3>\d{4}))"
    r"\.?(?:\s*T?\s*|$))?"
    r"(?:(?P<h>\d{1,2}):(?P<min>\d\d)(?::(?P<s>\d\d)(?:[.,:](?P<f>\d+))?)?\s*(?P<half>[AaPp]\.?[Mm]\.?)?"
    r"\s*(?:Z|UTC|(?P<sign>[+-])(?P<zh>\d\d):?(?P<zmin>\d\d))?)?",
    re.ASCII,
)
_MONTHS = (
    "jan ene gen", "feb fév", "mar mär mrz", "apr avr abr", "may mai mag", "jun juin giu",
    "jul juil lug", "aug aoû ago", "sep set", "oct okt ott", "nov", "dec dez déc dic",
)  # fmt: skip
"""First letters of the months in English, German, French, Spanish and Italian."""
_MONTH = {name: n for n, names in enumerate(_MONTHS, 1) for name in names.split()}
_LONGEST = 64
_FIRST_YEAR, _LAST_YEAR = 1678, 2261
"""First and last year whose instants in nanoseconds fit into 64 bits."""


def is_file_time(cell: str) -> bool:
    """Whether a cell is a Windows file time of the years 1981 to 2041."""
    return _FILE_TIME.fullmatch(cell.strip()) is not None


def is_instant(cell: str) -> bool:
    """Whether a cell is written as a date, a time of day or both."""
    return _matched(cell) is not None


def _matched(cell: str) -> re.Match[str] | None:
    match = _INSTANT.fullmatch(cell.strip())
    # Both the date and the time are optional in the pattern.
    if match is None or not match[0] or len(match[0]) >= _LONGEST:
        return None
    return match if match["name"] is None or _month(match["name"]) else None


def _month(name: str) -> int | None:
    """Number of a month from the first letters of its name, or None."""
    word = name.lower()
    return _MONTH.get(word[:4]) or _MONTH.get(word[:3])


def day_or_month_first(cells: Sequence[str]) -> str | None:
    """Order of day and month in dates; None if these cells do not determine it.

    The order of ISO dates and of dates with full stops is known.
    """
    first = [m for c in cells if (m := _INSTANT.fullmatch(c.strip())) is not None and m["a"]]
    if not first:
        return DAY_FIRST
    if any(int(m["a"]) > 12 for m in first):
        return DAY_FIRST
    if any(int(m["b"]) > 12 for m in first):
        return MONTH_FIRST
    if all(m["mark"] == "." for m in first):
        return DAY_FIRST
    # If all dates are the same day, only the times of day differ.
    return DAY_FIRST if len({(m["a"], m["b"], m["y2"]) for m in first}) == 1 else None


class Instants:
    """Parser of columns of dates, block by block; times of day continue after midnight."""

    def __init__(self, order: str = DAY_FIRST) -> None:
        self.order = order
        self._last: int | None = None
        self._days = 0

    def parse(self, cells: Sequence[str], is_empty: Sequence[bool]) -> Nanoseconds:
        """Convert cells to ns since 1970 or since midnight; `NO_INSTANT` for an empty cell.

        Raises
        ------
        InputError
            If a cell is not an instant. Its row counts from 0, and the error names no file.
        """
        result = np.full(len(cells), NO_INSTANT, dtype=np.int64)
        full = np.flatnonzero(~np.asarray(is_empty, dtype=bool)).tolist()
        if not full:
            return result
        if all(is_file_time(cells[at]) for at in full):
            result[full] = [(int(cells[at]) - _FILE_TIME_1970) * 100 for at in full]
            return result
        text = np.array([cells[at].strip()[:_LONGEST] for at in full])
        letters = text.view(np.uint32).reshape(len(full), -1)
        digits = letters - ord("0")
        masked = np.where(digits < 10, ord("0"), letters).astype(np.uint32)
        shapes, shape_of = np.unique(masked.view(text.dtype)[:, 0], return_inverse=True)
        matches = [_matched(str(shape)) for shape in shapes]
        valid = np.array([match is not None for match in matches])[shape_of]
        without_date = np.zeros(len(full), dtype=bool)
        values = np.zeros(len(full), dtype=np.int64)
        for number, match in enumerate(matches):
            if match is None:
                continue
            rows = np.flatnonzero(shape_of == number)
            values[rows], valid[rows] = self._decoded(match, digits[rows].astype(np.int64))
            without_date[rows] = all(match[group] is None for group in ("y", "a", "name"))
        if not valid.all():
            at = full[int(np.argmin(valid))]
            raise InputError(
                row=at,
                problem=f"{quoted(cells[at].strip())} is not a date or a time of day",
                remedy="correct the cell or remove the row",
            )
        values[without_date] = self._continued(values[without_date])
        result[full] = values
        return result

    def _decoded(
        self, match: re.Match[str], digits: Nanoseconds
    ) -> tuple[Nanoseconds, npt.NDArray[np.bool_]]:
        """Time of each cell of one date format, ns, and whether its date is valid.

        The time counts from 1970, or from midnight if the format has no date.
        """

        def number(group: str, longest: int = 9) -> Nanoseconds:
            begin, end = match.span(group)
            total = np.zeros(len(digits), dtype=np.int64)
            for place in range(begin, min(end, begin + longest)):
                total = 10 * total + digits[:, place]
            return total

        hour = number("h")
        if match["half"]:
            hour = hour % 12 + (12 if match["half"][0] in "Pp" else 0)
        of_day = ((hour * 60 + number("min")) * 60 + number("s")) * 10**9
        of_day += number("f") * 10 ** max(9 - len(match["f"] or ""), 0)
        zone = (number("zh") * 60 + number("zmin")) * 60 * 10**9
        of_day += zone if match["sign"] == "-" else -zone
        if match["y"]:
            year, month, day = number("y"), number("m"), number("d")
        elif match["a"]:
            year, month, day = number("y2"), number("b"), number("a")
            year += 2000 if len(match["y2"]) == 2 else 0
            if self.order == MONTH_FIRST:
                month, day = day, month
        elif match["name"]:
            year, day = number("y3"), number("d3")
            month = np.full_like(year, _month(match["name"]) or 0)
        else:
            return of_day, np.ones(len(of_day), dtype=bool)
        first = (12 * (year - 1970) + month - 1).astype("datetime64[M]")
        date = first.astype("datetime64[D]") + (day - 1)
        valid = (month >= 1) & (month <= 12) & (date.astype("datetime64[M]") == first)
        valid &= (year >= _FIRST_YEAR) & (year <= _LAST_YEAR)
        return date.astype(np.int64) * _DAY_NS + of_day, valid

    def _continued(self, of_day: Nanoseconds) -> Nanoseconds:
        """Add whole days to times of day so that they continue after midnight."""
        if not of_day.size:
            return of_day
        last = of_day[0] if self._last is None else self._last
        days = self._days + np.cumsum(np.diff(of_day, prepend=last) < -(_DAY_NS // 2))
        self._last, self._days = int(of_day[-1]), int(days[-1])
        return of_day + days * _DAY_NS


def seconds_since(instants: Nanoseconds, origin: int) -> npt.NDArray[np.float64]:
    """Convert instants (ns) to seconds since an origin; NaN for a missing instant."""
    elapsed_s = (instants - origin) / 1e9
    elapsed_s[instants == NO_INSTANT] = np.nan
    return elapsed_s


def as_date(instant: int) -> str | None:
    """ISO 8601 text of an instant (ns since 1970), or None for a time of day."""
    if 0 <= instant < 400 * _DAY_NS:
        return None
    return str(np.datetime64(instant, "ns"))
