"""Mean speeds by path and by recorded speed over the same short windows.

The change of the path over a window, divided by its duration, is the mean of the true speed. The
recorded speed is averaged over the same window, so that both are smoothed equally for any motion.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from jbf.arrays import Array
from jbf.records.motion.roughness import step_of

HALF_WIDTHS = (2, 4, 8)
"""Half widths of the windows, in samples, for a fine and for a coarse path."""
ALL_HALF_WIDTHS = (*HALF_WIDTHS, 16, 32, 64)
"""Half widths for ratios, which are independent of the width.

In a slow motion with fast sampling, one count takes tens of samples.
"""
MAX_DURATION_RATIO = 1.2
"""Largest ratio of the duration of a window to the median; a longer window contains a gap."""
MIN_GAP_RATIO = 2.5
"""Minimum ratio to the usual step for a step to be a gap."""
MIN_GAP_SHARE = 0.05
"""Minimum share of the window for a step to be a gap.

The displacement of a fast motion in such a step is unknown.
"""
USUAL_STEP_QUANTILE = 0.9
"""Quantile of the time steps that defines the typical step, also for uneven sampling."""
MIN_WINDOWS = 60
"""Minimum number of windows for a comparison."""


@dataclass(frozen=True)
class Compared:
    """Mean speeds by path and by recorded speed, over windows of one width.

    Attributes
    ----------
    by_path, by_speed
        Mean speeds over the windows by the path and by the speed, m/s.
    acceleration
        Acceleration by the path, m/s^2.
    count
        Speed that corresponds to one encoder count per window, m/s.
    """

    by_path: Array
    by_speed: Array
    acceleration: Array
    count: float


def window_comparisons(
    time: Array, path: Array, speed: Array, half_widths: tuple[int, ...] = HALF_WIDTHS
) -> Iterator[Compared]:
    """Yield path and speed over windows of several widths, in ascending order of width."""
    integral = np.concatenate(([0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * np.diff(time))))
    steps = np.diff(time)
    typical_step = float(np.quantile(steps, USUAL_STEP_QUANTILE)) if len(steps) else 0.0
    for half in half_widths:
        if len(time) < 4 * half + MIN_WINDOWS:
            return
        lasts = time[2 * half :] - time[: -2 * half]
        by_path = (path[2 * half :] - path[: -2 * half]) / lasts
        by_speed = (integral[2 * half :] - integral[: -2 * half]) / lasts
        spacing = time[3 * half : -half] - time[half : -3 * half]
        acceleration = (by_path[2 * half :] - by_path[: -2 * half]) / spacing
        lengths = time[4 * half :] - time[: -4 * half]
        gaps = np.cumsum(
            np.r_[0, steps > typical_step * max(MIN_GAP_RATIO, MIN_GAP_SHARE * 4 * half)]
        )
        use = (lengths < MAX_DURATION_RATIO * np.median(lengths)) & (
            gaps[4 * half :] == gaps[: -4 * half]
        )
        inner = slice(half, -half)
        if use.sum() >= MIN_WINDOWS:
            count = step_of(path) / float(np.median(lasts))
            yield Compared(by_path[inner][use], by_speed[inner][use], acceleration[use], count)
