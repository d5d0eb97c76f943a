"""The times of a stream, one block after the other: what repeats is left out, where time starts
again a stretch ends, and where it runs back the file is wrong."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from jbf.errors import InputError
from jbf.importing.spool import Dropped

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

_BEGINNING = 0.05
"""A time that falls back into so small a part of what has passed starts again."""
_MANY = 0.1
"""A clock that stands still in such a share of the rows is too coarse to be one."""


class TimeLine:
    """Counts rows of the file and rows that are kept."""

    def __init__(self, row_of: Callable[[int], int | None]) -> None:
        self.seen = 0
        self._row_of = row_of
        self._kept = 0
        self._first: float | None = None
        self._last = -np.inf
        self._starts = [0]
        self._repeats = 0
        self._first_repeat: int | None = None
        self._timeless = 0

    def keep(self, times: Array) -> Mask:
        """Which rows of the next block stay.

        Raises
        ------
        InputError
            Time runs back and does not start again.
        """
        keep = np.isfinite(times)
        self._timeless += int((~keep).sum())
        rows = np.flatnonzero(keep)
        if rows.size:
            before = np.concatenate(([self._last], times[rows[:-1]]))
            odd = np.flatnonzero(times[rows] <= before)
            if odd.size:
                self._one_by_one(times, rows, keep)
            else:
                if self._first is None:
                    self._first = float(times[rows[0]])
                self._last = float(times[rows[-1]])
        self.seen += len(times)
        self._kept += int(keep.sum())
        return keep

    def _one_by_one(self, times: Array, rows: npt.NDArray[np.intp], keep: Mask) -> None:
        kept = self._kept
        for row, now in zip(rows.tolist(), times[rows].tolist(), strict=True):
            if self._first is None:
                self._first = now
            elif now == self._last:
                keep[row] = False
                self._repeats += 1
                if self._first_repeat is None:
                    self._first_repeat = self._row_of(self.seen + row)
                continue
            elif now < self._last:
                if now > self._first + _BEGINNING * (self._last - self._first):
                    raise InputError(
                        row=self._row_of(self.seen + row),
                        problem=f"sample {self.seen + row + 1}: time runs back from "
                        f"{self._last:.12g} s to {now:.12g} s",
                        mend="sort the rows, or import what comes after as a file of its own",
                    )
                self._starts.append(kept)
                self._first = now
            self._last = now
            kept += 1

    def segments(self, rows: int) -> list[tuple[int, int]]:
        """First row and end of each stretch, of the rows that were kept.

        Raises
        ------
        InputError
            The clock stands still too often.
        """
        if self._repeats > _MANY * max(self.seen, 1):
            raise InputError(
                column="time_s",
                problem=f"stands still in {self._repeats} of {self.seen} rows: too coarse a clock",
                mend="name a finer one, or leave time_s out and say rate_hz under [file]",
            )
        return list(zip(self._starts, [*self._starts[1:], rows], strict=True))

    def dropped(self) -> list[Dropped]:
        """What was left out."""
        found = []
        if self._repeats:
            found.append(Dropped(self._repeats, "time repeats", self._first_repeat))
        if self._timeless:
            found.append(Dropped(self._timeless, "there is no time"))
        return found
