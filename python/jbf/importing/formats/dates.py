"""Dates and times of day, as loggers write them, in whole nanoseconds.

ISO 8601, `31.12.2026 23:59:59,125`, `12/31/2026 11:59:59.125 PM`, `23:59:59.125`. A time of day
that starts again goes on to the next day.
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
"""Of an empty cell; numpy's NaT."""

_DAY_NS = 86_400 * 10**9
_INSTANT = re.compile(
    r"(?:(?:(?P<y>\d{4})[-/.](?P<m>\d{1,2})[-/.](?P<d>\d{1,2})"
    r"|(?P<a>\d{1,2})(?P<mark>[-/.])(?P<b>\d{1,2})[-/.](?P<y2>\d{4}|\d{2}))\.?(?:\s*T?\s*|$))?"
    r"(?:(?P<h>\d{1,2}):(?P<min>\d\d)(?::(?P<s>\d\d)(?:[.,:](?P<f>\d+))?)?\s*(?P<half>[AaPp]\.?[Mm]\.?)?"
    r"\s*(?P<zone>Z|UTC|[+-]\d\d:?\d\d)?)?"
)


def day_or_month_first(cells: Sequence[str]) -> str | None:
    """Whether dates with slashes have the day first, as far as these tell; None where it matters
    and they do not tell."""
    first = [m for c in cells if (m := _INSTANT.fullmatch(c.strip())) is not None and m["a"]]
    if not first:
        return DAY_FIRST
    if any(int(m["a"]) > 12 for m in first):
        return DAY_FIRST
    if any(int(m["b"]) > 12 for m in first):
        return MONTH_FIRST
    if all(m["mark"] == "." for m in first):
        return DAY_FIRST
    # Of one day all instants are apart by their time of day.
    return DAY_FIRST if len({(m["a"], m["b"], m["y2"]) for m in first}) == 1 else None


class Instants:
    """Reads cells one after the other; remembers the day where only times of day are written."""

    def __init__(self, order: str = DAY_FIRST) -> None:
        self.order = order
        self._last: int | None = None
        self._days = 0

    def parse(self, cells: Sequence[str], is_empty: Sequence[bool]) -> Nanoseconds:
        """Nanoseconds since 1970 or since midnight; `NO_INSTANT` of an empty cell.

        Raises
        ------
        InputError
            A cell is no instant; its row counts from 0, and no file is named.
        """
        found = np.full(len(cells), NO_INSTANT, dtype=np.int64)
        for at, (cell, empty) in enumerate(zip(cells, is_empty, strict=True)):
            if empty:
                continue
            value = self._one(cell)
            if value is None:
                raise InputError(
                    row=at,
                    problem=f"{quoted(cell.strip())} is no date and no time of day",
                    mend="correct the cell or drop the row",
                )
            found[at] = value
        return found

    def _one(self, cell: str) -> int | None:
        match = _INSTANT.fullmatch(cell.strip())
        if match is None or (match["h"] is None and match["y"] is None and match["a"] is None):
            return None
        hour = int(match["h"] or 0)
        if match["half"]:
            hour = hour % 12 + (12 if match["half"][0] in "Pp" else 0)
        fraction = int(((match["f"] or "") + "000000000")[:9])
        of_day = ((hour * 60 + int(match["min"] or 0)) * 60 + int(match["s"] or 0)) * 10**9
        of_day += fraction
        zone = match["zone"]
        if zone and zone[0] in "+-":
            minutes = int(zone[1:3]) * 60 + int(zone[-2:])
            of_day -= (minutes if zone[0] == "+" else -minutes) * 60 * 10**9
        if match["y"] is None and match["a"] is None:
            if self._last is not None and of_day < self._last - _DAY_NS // 2:
                self._days += 1
            self._last = of_day
            return of_day + self._days * _DAY_NS
        day = self._date(match)
        return None if day is None else day * _DAY_NS + of_day

    def _date(self, match: re.Match[str]) -> int | None:
        if match["y"]:
            year, month, day = int(match["y"]), int(match["m"]), int(match["d"])
        else:
            year = int(match["y2"]) + (2000 if len(match["y2"]) == 2 else 0)
            month, day = int(match["b"]), int(match["a"])
            if self.order == MONTH_FIRST:
                month, day = day, month
        try:
            return int(np.datetime64(f"{year:04d}-{month:02d}-{day:02d}", "D").astype(np.int64))
        except ValueError:
            return None


def seconds_since(instants: Nanoseconds, origin: int) -> npt.NDArray[np.float64]:
    """Seconds from an instant on, nan where there is none."""
    found = (instants - origin) / 1e9
    found[instants == NO_INSTANT] = np.nan
    return found


def as_date(instant: int) -> str | None:
    """ISO 8601 of an instant; None of a time of day."""
    if 0 <= instant < 400 * _DAY_NS:
        return None
    return str(np.datetime64(instant, "ns"))
