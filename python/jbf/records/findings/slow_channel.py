"""Slow channel with sample and hold: sequences of equal samples that begin at a constant rate.

The first sample of each sequence is a reading that was taken after the previous sample. The beat of
the two clocks over a record determines the instants of the readings to a fraction of a sampling
interval. Due to coarse quantisation or saturation, consecutive readings may be equal. The duration
of a sequence is then a multiple of the period of the channel.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from jbf.arrays import Array
from jbf.records.findings.interpolated import Native

LEAST_ROWS = 40
LEAST_SHARE = 0.02
"""Minimum share of the samples that repeat the previous one."""
GRID_TOLERANCE = 1e-3
"""Largest deviation of samples from an even grid, as a share of a step."""
MAX_TICK_RANGE = 1.02
"""Largest range of the beginnings of sequences relative to a clock of constant rate, in steps.

The range is larger for sequences of random length.
"""
SHORTEST, LONGEST = 2.0, 60.0
"""Range of the clock periods searched if some readings are equal, samples.

At a period of two samples, a random sequence begins within a step of a tick with probability one
half; the probability for forty sequences is negligible.
"""
PHASE_STEP = 0.2
"""Phase difference between adjacent trial periods over the sequences of the first window, steps."""


def find_repeated(time: Array, values: Array) -> Native | None:
    """Recover the readings of a channel with sample and hold; None for any other channel."""
    step = float(np.median(np.diff(time)))
    if np.max(np.abs(np.diff(time) / step - 1.0)) > GRID_TOLERANCE:
        return None
    first = np.flatnonzero(np.diff(values) != 0.0) + 1
    rows = len(first)
    if rows < LEAST_ROWS or len(values) - rows < LEAST_SHARE * len(values) + 1:
        return None
    begins = time[first]
    native = _of_clock(time, values, begins, np.arange(rows), step)
    if native is None:
        # If consecutive readings are equal (quantisation, saturation), some sequences are merged.
        count = _readings_before(begins / step)
        native = None if count is None else _of_clock(time, values, begins, count, step)
    return native


def _of_clock(
    time: Array, values: Array, begins: Array, count: npt.NDArray[np.intp], step: float
) -> Native | None:
    """Recover the readings if each sequence begins within one step after its tick of a clock."""
    period = float(np.polyfit(count, begins, 1)[0])
    # Finer search: sequences at both ends determine the period to a fraction of a step.
    spread, period = min(
        (float(np.ptp(begins - p * count)), float(p))
        for p in period + np.linspace(-2.0, 2.0, 81) * step / count[-1]
    )
    if spread > MAX_TICK_RANGE * step:
        return None
    early = begins - period * count
    # Each reading precedes the beginning of its sequence by at most one step.
    phase = 0.5 * (float(np.max(early)) - step + float(np.min(early)))
    every = np.arange(count[-1] + 1)
    ticks: Array = phase + period * every.astype(np.float64)
    # A reading equal to the previous one does not begin a sequence; use the first sample after it.
    first_rows = np.minimum(np.searchsorted(time, ticks), len(time) - 1)
    first_rows[count] = np.searchsorted(time, begins)
    return Native(ticks, values[first_rows], period)


def _readings_before(begins: Array) -> npt.NDArray[np.intp] | None:
    """Number of readings of a slow clock before the beginning of each sequence; the first is 0.

    None if no clock of constant rate fits the beginnings. The longest period that fits is selected,
    because integer fractions of the true period also fit.

    Parameters
    ----------
    begins
        Beginnings of the sequences, in samples, shape (m,), m at least `LEAST_ROWS`.
    """
    # The sequences that are closest together determine the period with the least ambiguity.
    densest = int(np.argmin(begins[LEAST_ROWS - 1 :] - begins[: len(begins) - LEAST_ROWS + 1]))
    look = begins[densest : densest + LEAST_ROWS] - begins[densest]
    grid = np.exp(np.arange(np.log(SHORTEST), np.log(LONGEST), PHASE_STEP / look[-1]))
    for period in grid[_spread(look, grid) < MAX_TICK_RANGE + PHASE_STEP][::-1].tolist():
        count = _extended_ticks(begins, densest, period)
        if count is not None:
            return count
    return None


def _spread(begins: Array, periods: Array) -> Array:
    """Range, in steps, of the phases of the sequences for each trial period, shape (p,)."""
    phases = np.sort(np.mod(begins[None, :], periods[:, None]), axis=1)
    around = np.concatenate([np.diff(phases, axis=1), phases[:, :1] + periods[:, None]], axis=1)
    around[:, -1] -= phases[:, -1]
    widest: Array = periods - np.max(around, axis=1)
    return widest


def _extended_ticks(begins: Array, start: int, period: float) -> npt.NDArray[np.intp] | None:
    """Clock-tick numbers of all sequences, extended from a few; None if the phase drifts."""
    low, high = start, start + LEAST_ROWS
    while True:
        rows = begins[low:high]
        middle = rows[len(rows) // 2]
        count = np.round((rows - middle) / period)
        period, phase = np.polyfit(count, rows - middle, 1)
        if np.ptp(rows - middle - period * count - phase) > MAX_TICK_RANGE + PHASE_STEP:
            return None
        if (low, high) == (0, len(begins)):
            numbers: npt.NDArray[np.intp] = (count - count[0]).astype(np.intp)
            return numbers
        extension = high - low
        low, high = max(low - extension, 0), min(high + extension, len(begins))
