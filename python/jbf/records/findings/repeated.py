"""Repeated readings: a slow channel whose last value is written again until the next comes.

The instants at which a new value appears tell the slow channel's clock: ticks evenly spaced, each
in the step before a new value. What was read are the values at the ticks; the rest are copies.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy import optimize

from jbf.records.findings.interpolated import Native

Array = npt.NDArray[np.float64]

LEAST_REPEATED = 0.2
"""Share of the samples that repeat the one before."""
LEAST_TICKS = 40
"""New values that tell a clock."""
OFF = 0.02
"""Share of a step by which a tick may lie outside the step before its new value."""
CLOSE = 0.02
"""Share of the ticks that may."""


def find_repeated(time: Array, values: Array) -> Native | None:
    """The readings of a slow channel behind its copies; None where the samples are its own."""
    new = np.flatnonzero(np.diff(values) != 0.0) + 1
    if len(new) < LEAST_TICKS or 1.0 - len(new) / len(values) < LEAST_REPEATED:
        return None
    step = float(np.median(np.diff(time)))
    # A tick lies between the last old value and the first new one.
    low, high = time[new - 1], time[new]
    if float(np.max(high - low)) > 1.5 * step:
        return None
    gaps = np.diff(high)
    period = float(np.mean(gaps[gaps < 2.5 * float(np.median(gaps))]))
    for _ in range(3):
        # A reading that equals the one before makes no new value: ticks are counted by time.
        tick = np.round((high - high[0]) / period)
        if len(np.unique(tick)) != len(tick):
            return None
        period = float(np.polyfit(tick, high, 1)[0])
    found = _clock(tick, low, high)
    if found is None:
        return None
    first, period = found
    read = first + period * tick
    out = np.maximum(low - read, read - high)
    if float(np.mean(out > OFF * step)) > CLOSE or period < 1.2 * step:
        return None
    inside = (read >= time[0]) & (read <= time[-1])
    return Native(read[inside], values[new][inside], period)


def _clock(tick: Array, low: Array, high: Array) -> tuple[float, float] | None:
    """First tick and period that lie farthest inside every step (a linear program)."""
    ones = np.ones_like(tick)
    above = np.stack([ones, tick, ones], axis=1)
    below = np.stack([-ones, -tick, ones], axis=1)
    found = optimize.linprog(
        [0.0, 0.0, -1.0],
        A_ub=np.concatenate([above, below]),
        b_ub=np.concatenate([high - low[0], low[0] - low]),
        bounds=[(None, None)] * 3,
    )
    if found.status != 0 or found.x is None:
        return None
    return float(found.x[0]) + float(low[0]), float(found.x[1])
