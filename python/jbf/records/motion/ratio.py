"""How many times as fast a path changes as the speed says, where that is the same all the time."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from jbf.records.motion.compared import WIDE, Compared, compared

Array = npt.NDArray[np.float64]

FAST = 0.3
"""Share of the top speed above which a ratio tells something."""
OFF = 0.2
"""Path and speed whose ratio is further off one contradict one another,"""
SPREADS = 4.0
"""where that is so many times its spread (half the range of its middle half),"""
STEADY = 0.15
"""and its spread is less than this share: a factor is the same all the time."""
SAME = 0.02
"""A way for a radian that is so near to one metre is one: the speed is in radians, too."""


def factor_between(time: Array, path: Array, speed: Array) -> float | None:
    """How many times as fast the path changes as the speed says; None where they agree, or where
    they are no multiples of one another."""
    for c in compared(time, path, speed, WIDE):
        ratio, spread = _middle(c)
        if spread < STEADY * abs(ratio) and abs(ratio - 1.0) > max(OFF, SPREADS * spread):
            return ratio
    return None


def way_per_unit(time: Array, path: Array, speed: Array) -> float | None:
    """Metres of way, by the speed, for a unit of the path, where nobody says how many; None where
    they are no multiples of one another, or run against one another."""
    for c in compared(time, path, speed, WIDE):
        ratio, spread = _middle(c)
        if spread < STEADY * ratio:
            exact = slope_near(time, path, speed, ratio)
            return 1.0 if abs(exact - 1.0) < SAME else 1.0 / exact
    return None


def slope_near(time: Array, path: Array, speed: Array, near: float) -> float:
    """The ratio by least squares, over the windows that show one near a first one."""
    for c in compared(time, path, speed, WIDE):
        ratio, _ = _middle(c)
        if abs(ratio / near - 1.0) < OFF:
            close = np.abs(c.by_path - near * c.by_speed) < OFF * np.abs(c.by_path) + c.count
            return float(c.by_path[close] @ c.by_speed[close] / np.sum(c.by_speed[close] ** 2))
    return near


def _middle(c: Compared) -> tuple[float, float]:
    """The ratio over windows of fast motion, and its spread."""
    fast = np.abs(c.by_speed) > FAST * np.quantile(np.abs(c.by_speed), 0.95)
    if fast.sum() < 20:
        return 1.0, np.inf
    low, middle, high = np.quantile(c.by_path[fast] / c.by_speed[fast], [0.25, 0.5, 0.75])
    # A steady speed spreads by nothing, however coarse the counts are.
    coarse = c.count / float(np.median(np.abs(c.by_speed[fast])))
    return float(middle), float(0.5 * (high - low)) + coarse
