"""A slow channel that repeats its last reading until the next: rows of equal samples at a rate.

The first sample of each row is a reading, made since the sample before. Over a record, the beat of
the two clocks tells when to a fraction of a sample. A converter with coarse steps may read the same
twice, and one at the end of its range does for long: then some rows are as long as two readings, or
more.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from jbf.records.findings.interpolated import Native

Array = npt.NDArray[np.float64]

LEAST_ROWS = 40
LEAST_SHARE = 0.02
"""Share of the samples that must repeat the one before."""
EVEN = 1e-3
"""Samples are evenly spaced where they are off an even grid by less than this share of a step."""
WITHIN = 1.02
"""Steps within which all rows must begin, as seen from a steady clock: random rows wander."""
SHORTEST, LONGEST = 2.0, 60.0
"""Periods, in samples, of a clock that is looked for where some of its readings are equal. Rows of
chance begin within a step of a clock of two, one in two; forty of them never."""
FINE = 0.2
"""Steps by which neighbours of that search part over the rows of a first look."""


def find_repeated(time: Array, values: Array) -> Native | None:
    """The readings of a slow channel that stands still between them; None where it is none."""
    step = float(np.median(np.diff(time)))
    if np.max(np.abs(np.diff(time) / step - 1.0)) > EVEN:
        return None
    first = np.flatnonzero(np.diff(values) != 0.0) + 1
    rows = len(first)
    if rows < LEAST_ROWS or len(values) - rows < LEAST_SHARE * len(values) + 1:
        return None
    begins = time[first]
    native = _of_clock(time, values, begins, np.arange(rows), step)
    if native is None:
        # Where readings are equal, in coarse steps or at the end of a range, rows are missing.
        count = _readings_before(begins / step)
        native = None if count is None else _of_clock(time, values, begins, count, step)
    return native


def _of_clock(
    time: Array, values: Array, begins: Array, count: npt.NDArray[np.intp], step: float
) -> Native | None:
    """The readings, where rows begin within a step after ticks of such numbers of a clock."""
    period = float(np.polyfit(count, begins, 1)[0])
    # A finer look: rows at both ends hold the clock to a fraction of a step.
    spread, period = min(
        (float(np.ptp(begins - p * count)), float(p))
        for p in period + np.linspace(-2.0, 2.0, 81) * step / count[-1]
    )
    if spread > WITHIN * step:
        return None
    early = begins - period * count
    # Each reading is at most a step before its row begins.
    phase = 0.5 * (float(np.max(early)) - step + float(np.min(early)))
    every = np.arange(count[-1] + 1)
    ticks: Array = phase + period * every.astype(np.float64)
    # Equal readings begin no row: they are what stands at the first sample after them.
    shown = np.minimum(np.searchsorted(time, ticks), len(time) - 1)
    shown[count] = np.searchsorted(time, begins)
    return Native(ticks, values[shown], period)


def _readings_before(begins: Array) -> npt.NDArray[np.intp] | None:
    """How many readings a slow clock made before each row began, the first 0; None where rows begin
    at no steady clock's. The longest period that will do: rows of a clock are those of any fraction
    of its period.

    Parameters
    ----------
    begins
        Where rows begin, in samples, shape (m,), m at least `LEAST_ROWS`.
    """
    # The rows that come closest to one another tell a period with the least ambiguity.
    near = int(np.argmin(begins[LEAST_ROWS - 1 :] - begins[: len(begins) - LEAST_ROWS + 1]))
    look = begins[near : near + LEAST_ROWS] - begins[near]
    grid = np.exp(np.arange(np.log(SHORTEST), np.log(LONGEST), FINE / look[-1]))
    for period in grid[_spread(look, grid) < WITHIN + FINE][::-1].tolist():
        count = _followed(begins, near, period)
        if count is not None:
            return count
    return None


def _spread(begins: Array, periods: Array) -> Array:
    """Within how many steps rows begin as seen from clocks of such periods, shape (p,)."""
    phases = np.sort(np.mod(begins[None, :], periods[:, None]), axis=1)
    around = np.concatenate([np.diff(phases, axis=1), phases[:, :1] + periods[:, None]], axis=1)
    around[:, -1] -= phases[:, -1]
    widest: Array = periods - np.max(around, axis=1)
    return widest


def _followed(begins: Array, near: int, period: float) -> npt.NDArray[np.intp] | None:
    """Numbers of ticks, from a few rows out to all of them."""
    low, high = near, near + LEAST_ROWS
    while True:
        rows = begins[low:high]
        middle = rows[len(rows) // 2]
        count = np.round((rows - middle) / period)
        period, phase = np.polyfit(count, rows - middle, 1)
        if np.ptp(rows - middle - period * count - phase) > WITHIN + FINE:
            return None
        if (low, high) == (0, len(begins)):
            numbers: npt.NDArray[np.intp] = (count - count[0]).astype(np.intp)
            return numbers
        more = high - low
        low, high = max(low - more, 0), min(high + more, len(begins))
