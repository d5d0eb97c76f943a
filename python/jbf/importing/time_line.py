"""Check of the times of a stream: repeated times are dropped, restarts begin a segment.

The check is block by block. A decrease of time that is not a restart is an error.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from jbf.arrays import Array, Mask
from jbf.errors import InputError
from jbf.importing.spool import Dropped

_RESTART_SHARE = 0.05
"""Share of the elapsed time of a segment; a decrease to less than this share is a restart."""
_MAX_REPEATED_SHARE = 0.1
"""Share of rows with repeated times above which a clock is too coarse."""


class TimeLine:
    """State of the check: number of rows read and kept, and where segments begin."""

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
        """Mask of the rows of the next block that are kept.

        Raises
        ------
        InputError
            If time decreases without a restart.
        """
        keep = np.isfinite(times)
        self._timeless += int((~keep).sum())
        rows = np.flatnonzero(keep)
        if rows.size:
            before = np.concatenate(([self._last], times[rows[:-1]]))
            not_increasing = np.flatnonzero(times[rows] <= before)
            if not_increasing.size:
                self._one_by_one(times, rows, keep)
            else:
                if self._first is None:
                    self._first = float(times[rows[0]])
                self._last = float(times[rows[-1]])
        self.seen += len(times)
        self._kept += int(keep.sum())
        return keep

    def _one_by_one(self, times: Array, rows: npt.NDArray[np.intp], keep: Mask) -> None:
        count = self._kept
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
                if now > self._first + _RESTART_SHARE * (self._last - self._first):
                    raise InputError(
                        row=self._row_of(self.seen + row),
                        problem=f"sample {self.seen + row + 1}: time decreases from "
                        f"{self._last:.12g} s to {now:.12g} s",
                        remedy="sort the rows, or import the later part as a separate file",
                    )
                self._starts.append(count)
                self._first = now
            self._last = now
            count += 1

    def segments(self, rows: int) -> list[tuple[int, int]]:
        """First row and end (exclusive) of each segment, counted in kept rows.

        Raises
        ------
        InputError
            If too many times are repeated.
        """
        if self._repeats > _MAX_REPEATED_SHARE * max(self.seen, 1):
            raise InputError(
                column="time_s",
                problem=(
                    f"is constant in {self._repeats} of {self.seen} rows: the clock is too coarse"
                ),
                remedy="name a finer one, or omit time_s and set rate_hz under [file]",
            )
        return list(zip(self._starts, [*self._starts[1:], rows], strict=True))

    def dropped(self) -> list[Dropped]:
        """Number of omitted rows for each reason."""
        omitted = []
        if self._repeats:
            omitted.append(Dropped(self._repeats, "time repeats", self._first_repeat))
        if self._timeless:
            omitted.append(Dropped(self._timeless, "time is missing"))
        return omitted
