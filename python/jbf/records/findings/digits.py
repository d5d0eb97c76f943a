"""Resolution of the values of a channel: the last decimal digit or the quantisation step."""

from __future__ import annotations

import numpy as np

from jbf.arrays import Array

FEWEST_GAPS = 8
"""Smallest number of gaps between levels for the estimate of a quantisation step."""
MOST_STEPS = 20.0
"""Widest gap that is compared with multiples of the step, in steps.

In a wider gap the error of the estimated step, multiplied by the number of steps, would dominate.
"""


def last_digit(values: Array) -> float:
    """Value of the last decimal digit of the samples, or their binary rounding error."""
    top = float(np.max(np.abs(values)))
    if top == 0.0:
        return 0.0
    first = int(np.floor(np.log10(top)))
    for place in range(first, first - 9, -1):
        scaled = values / 10.0**place
        if np.max(np.abs(scaled - np.round(scaled))) < 1e-6:
            return float(10.0**place)
    return 1e-9 * top


def resolution(values: Array) -> float:
    """Smallest possible difference between samples: the quantisation step, or one last digit.

    Notes
    -----
    Differences between quantisation levels are multiples of the step, up to the rounding to the
    last digit. Without quantisation, the smallest difference in a long record is one digit.
    """
    digit = last_digit(values)
    gaps = np.diff(np.unique(values))
    gaps = gaps[gaps > 0.5 * digit]
    if len(gaps) < FEWEST_GAPS:
        return digit
    smallest = float(np.min(gaps))
    step = float(np.mean(gaps[gaps < 1.5 * smallest]))
    small_gaps = gaps[gaps < MOST_STEPS * step]
    error = np.abs(small_gaps - step * np.round(small_gaps / step))
    on_levels = len(small_gaps) >= FEWEST_GAPS and bool(
        np.all(error <= digit * (1.0 + small_gaps / step))
    )
    return max(step, digit) if on_levels else digit
