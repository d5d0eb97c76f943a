"""Path and speed over the same short windows, so that one can be asked about the other.

The change of the path over a window is the mean of the true speed there; the recorded speed is
averaged over the same window. Neither is smoothed more than the other, whatever the motion.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from jbf.records.motion.roughness import step_of

Array = npt.NDArray[np.float64]

HALF_WIDTHS = (2, 4, 8)
"""Half widths of the windows, in samples: the path is coarse, or not."""
WIDE = (*HALF_WIDTHS, 16, 32, 64)
"""The same where a ratio is asked, which no width bends: a slow motion logged fast goes by a count
in tens of samples."""
WHOLE = 1.2
"""A window that is longer than so many times the usual has a gap in it,"""
LONG = 2.5
"""and so has one with a step of so many usual ones"""
SHARE = 0.05
"""that is this share of it: of a fast motion nobody knows how far it went there."""
COMMON = 0.9
"""Share of the steps that no usual one is below, however uneven they are."""
LEAST = 60
"""Windows that tell something together."""


@dataclass(frozen=True)
class Compared:
    """Mean speeds over windows, m/s: by path, by speed; the path's own acceleration, m/s^2; what a
    count of the path makes of a speed, m/s."""

    by_path: Array
    by_speed: Array
    acceleration: Array
    count: float


def compared(
    time: Array, path: Array, speed: Array, half_widths: tuple[int, ...] = HALF_WIDTHS
) -> Iterator[Compared]:
    """Path and speed over windows of several widths, wide ones last."""
    whole = np.concatenate(([0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * np.diff(time))))
    steps = np.diff(time)
    usual = float(np.quantile(steps, COMMON)) if len(steps) else 0.0
    for half in half_widths:
        if len(time) < 4 * half + LEAST:
            return
        lasts = time[2 * half :] - time[: -2 * half]
        by_path = (path[2 * half :] - path[: -2 * half]) / lasts
        by_speed = (whole[2 * half :] - whole[: -2 * half]) / lasts
        apart = time[3 * half : -half] - time[half : -3 * half]
        acceleration = (by_path[2 * half :] - by_path[: -2 * half]) / apart
        lengths = time[4 * half :] - time[: -4 * half]
        gaps = np.cumsum(np.r_[0, steps > usual * max(LONG, SHARE * 4 * half)])
        kept = (lengths < WHOLE * np.median(lengths)) & (gaps[4 * half :] == gaps[: -4 * half])
        inner = slice(half, -half)
        if kept.sum() >= LEAST:
            count = step_of(path) / float(np.median(lasts))
            yield Compared(by_path[inner][kept], by_speed[inner][kept], acceleration[kept], count)
