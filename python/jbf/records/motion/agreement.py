"""Consistency of the recorded speed with the recorded path."""

from __future__ import annotations

import numpy as np

from jbf.arrays import Array

CONTRADICTION = 10.0
"""Minimum difference of path and speed for a contradiction, in standard errors."""
CONTRADICTION_REACH = 3
"""Number of samples on each side whose acceleration is affected."""
MAX_CONTRADICTION_SHARE = 0.01
"""Largest share of the samples that may be contradictions."""


def contradiction_of(
    time: Array, path: Array, speed: Array, sd_path: float, sd_speed: float
) -> Array:
    """Significant difference between recorded speed and path at each sample, m/s; zero elsewhere.

    Possible causes are a filter transient and an outlier. If the share of differing samples exceeds
    `MAX_CONTRADICTION_SHARE`, the result is zero everywhere, since the standard errors are then
    underestimated.
    """
    dt = np.diff(time)
    gap = np.abs(np.diff(path) - 0.5 * (speed[1:] + speed[:-1]) * dt)
    typical = float(np.median(gap) / 0.6745)
    expected = np.sqrt(2.0 * sd_path**2 + 0.5 * (sd_speed * dt) ** 2)
    contradicts = gap > CONTRADICTION * np.maximum(typical, expected)
    if not 0 < contradicts.sum() <= MAX_CONTRADICTION_SHARE * len(contradicts):
        return np.zeros(len(time))
    wide = np.pad(np.where(contradicts, gap / dt, 0.0), CONTRADICTION_REACH)
    windows = np.lib.stride_tricks.sliding_window_view(wide, 2 * CONTRADICTION_REACH)
    largest: Array = windows.max(axis=1)
    return largest
