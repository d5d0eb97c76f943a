"""Do the recorded speed and the recorded path tell the same motion?"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

CONTRADICTION = 10.0
"""Standard errors by which path and speed must differ to contradict one another,"""
CONTRADICTION_REACH = 3
"""and samples to each side whose acceleration that spoils."""
RARE = 0.01
"""Largest share of the samples that may be contradictions."""


def contradiction_of(
    time: Array, path: Array, speed: Array, sd_path: float, sd_speed: float
) -> Array:
    """How far speed and path contradict one another round each sample, m/s: a filter that settles,
    a glitch. Zero where they agree.

    Zero everywhere, if that is the way of the whole record: then its errors are larger than they
    look.
    """
    dt = np.diff(time)
    gap = np.abs(np.diff(path) - 0.5 * (speed[1:] + speed[:-1]) * dt)
    usual = float(np.median(gap) / 0.6745)
    expected = np.sqrt(2.0 * sd_path**2 + 0.5 * (sd_speed * dt) ** 2)
    apart = gap > CONTRADICTION * np.maximum(usual, expected)
    if not 0 < apart.sum() <= RARE * len(apart):
        return np.zeros(len(time))
    wide = np.pad(np.where(apart, gap / dt, 0.0), CONTRADICTION_REACH)
    windows = np.lib.stride_tricks.sliding_window_view(wide, 2 * CONTRADICTION_REACH)
    found: Array = windows.max(axis=1)
    return found
