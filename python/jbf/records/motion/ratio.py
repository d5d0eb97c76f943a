"""Constant ratio between the rate of change of a path and the recorded speed."""

from __future__ import annotations

import numpy as np

from jbf.arrays import Array
from jbf.records.motion.window_comparisons import ALL_HALF_WIDTHS, Compared, window_comparisons

FAST = 0.3
"""Share of the top speed above which the ratio is evaluated."""
MIN_DEVIATION = 0.2
"""Minimum deviation of the ratio from one for path and speed to contradict one another."""
MIN_SPREADS = 4.0
"""Minimum deviation relative to the spread (half the interquartile range)."""
MAX_SPREAD = 0.15
"""Largest relative spread of a constant factor."""
UNIT_TOLERANCE = 0.02
"""Tolerance for a ratio of one metre per radian, at which the speed is in radians per second."""


def factor_between(time: Array, path: Array, speed: Array) -> float | None:
    """Ratio of the rate of change of the path to the recorded speed; None if consistent with one.

    Returns None also if the ratio is not constant.
    """
    for c in window_comparisons(time, path, speed, ALL_HALF_WIDTHS):
        ratio, spread = _middle(c)
        if spread < MAX_SPREAD * abs(ratio) and abs(ratio - 1.0) > max(
            MIN_DEVIATION, MIN_SPREADS * spread
        ):
            return ratio
    return None


def metres_per_unit(time: Array, path: Array, speed: Array) -> float | None:
    """Metres of displacement per unit of the recorded path, by its ratio to the speed.

    Returns None if the ratio is not constant or is negative.
    """
    for c in window_comparisons(time, path, speed, ALL_HALF_WIDTHS):
        ratio, spread = _middle(c)
        if spread < MAX_SPREAD * ratio:
            exact = slope_near(time, path, speed, ratio)
            return 1.0 if abs(exact - 1.0) < UNIT_TOLERANCE else 1.0 / exact
    return None


def slope_near(time: Array, path: Array, speed: Array, estimate: float) -> float:
    """Least-squares ratio of path rate to speed, over windows near a first estimate of it."""
    for c in window_comparisons(time, path, speed, ALL_HALF_WIDTHS):
        ratio, _ = _middle(c)
        if abs(ratio / estimate - 1.0) < MIN_DEVIATION:
            consistent = (
                np.abs(c.by_path - estimate * c.by_speed)
                < MIN_DEVIATION * np.abs(c.by_path) + c.count
            )
            return float(
                c.by_path[consistent] @ c.by_speed[consistent] / np.sum(c.by_speed[consistent] ** 2)
            )
    return estimate


def _middle(c: Compared) -> tuple[float, float]:
    """Median ratio of path rate to speed over windows of fast motion, and its spread."""
    fast = np.abs(c.by_speed) > FAST * np.quantile(np.abs(c.by_speed), 0.95)
    if fast.sum() < 20:
        return 1.0, np.inf
    low, middle, high = np.quantile(c.by_path[fast] / c.by_speed[fast], [0.25, 0.5, 0.75])
    # At a constant speed the spread is zero, even with coarse quantisation.
    coarse = c.count / float(np.median(np.abs(c.by_speed[fast])))
    return float(middle), float(0.5 * (high - low)) + coarse
