"""A slow channel that holds its last reading until the next: rows of equal samples at a rate.

The first sample of each row is a reading that was taken after the previous sample. Over a record,
the beat of the two clocks determines the instant to a fraction of a sample. Coarse quantisation may
give the same reading twice, and saturation many times. Some rows are then as long as two readings,
or more.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from jbf.records.findings.interpolated import Native

Array = npt.NDArray[np.float64]

LEAST_ROWS = 40
LEAST_SHARE = 0.02
"""Least share of the samples that repeat the previous one."""
EVEN = 1e-3
"""Largest deviation of samples from an even grid, as a share of a step."""
WITHIN = 1.02
"""Range, in steps, within which all rows must begin relative to a steady clock.

The beginnings of random rows drift further.
"""
SHORTEST, LONGEST = 2.0, 60.0
"""Range of the clock periods searched if some readings are equal, samples.

A random row begins within a step of a clock of period two with probability one half; forty rows
never do.
"""
FINE = 0.2
"""Phase difference between adjacent trial periods over the rows of the first window, steps."""


def find_repeated(time: Array, values: Array) -> Native | None:
    """Recover the readings of a slow channel that is held between them; None if it is not one."""
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
        # If readings are equal, by quantisation or saturation, rows are missing.
        count = _readings_before(begins / step)
        native = None if count is None else _of_clock(time, values, begins, count, step)
    return native


def _of_clock(
    time: Array, values: Array, begins: Array, count: npt.NDArray[np.intp], step: float
) -> Native | None:
    """Recover the readings if each row begins within a step after its tick number of a clock."""
    period = float(np.polyfit(count, begins, 1)[0])
    # Finer search: rows at both ends determine the period to a fraction of a step.
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
    # Equal readings begin no row; their value is that of the first sample after them.
    shown = np.minimum(np.searchsorted(time, ticks), len(time) - 1)
    shown[count] = np.searchsorted(time, begins)
    return Native(ticks, values[shown], period)


def _readings_before(begins: Array) -> npt.NDArray[np.intp] | None:
    """Number of readings of a slow clock before each row began; the first is 0.

    None if the rows begin at the ticks of no steady clock. The longest period that fits is taken,
    because any fraction of the period of a clock also fits.

    Parameters
    ----------
    begins
        Beginnings of the rows, in samples, shape (m,), m at least `LEAST_ROWS`.
    """
    # The rows that are closest together determine the period with the least ambiguity.
    near = int(np.argmin(begins[LEAST_ROWS - 1 :] - begins[: len(begins) - LEAST_ROWS + 1]))
    look = begins[near : near + LEAST_ROWS] - begins[near]
    grid = np.exp(np.arange(np.log(SHORTEST), np.log(LONGEST), FINE / look[-1]))
    for period in grid[_spread(look, grid) < WITHIN + FINE][::-1].tolist():
        count = _followed(begins, near, period)
        if count is not None:
            return count
    return None


def _spread(begins: Array, periods: Array) -> Array:
    """Range, in steps, of the phases of the rows for each clock period, shape (p,)."""
    phases = np.sort(np.mod(begins[None, :], periods[:, None]), axis=1)
    around = np.concatenate([np.diff(phases, axis=1), phases[:, :1] + periods[:, None]], axis=1)
    around[:, -1] -= phases[:, -1]
    widest: Array = periods - np.max(around, axis=1)
    return widest


def _followed(begins: Array, near: int, period: float) -> npt.NDArray[np.intp] | None:
    """Tick numbers of all rows, extended from a few rows outwards; None if they drift apart."""
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
