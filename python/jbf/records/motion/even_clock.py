"""Even clock (constant sampling interval), estimated from time stamps with jitter."""

from __future__ import annotations

import numpy as np

from jbf.arrays import Array

LONGEST_RESIDUAL, USUAL_RESIDUAL = 10.0, 1.0
"""Largest deviation from an even clock, and limit of its 90 % quantile, in samples."""


def even_clock(time_s: Array) -> Array | None:
    """Estimate the instants of an even clock from time stamps with jitter, s.

    None if the time stamps are even, or differ too much from an even clock. Missing samples are
    permitted.
    """
    steps = np.diff(time_s)
    if len(steps) < 2:
        return None
    median_step = float(np.median(steps))
    if median_step <= 0.0 or np.ptp(steps) <= 1e-6 * median_step:
        return None
    counted = np.concatenate(([0.0], np.cumsum(np.rint(steps / median_step))))
    clocks = [
        np.polynomial.Polynomial.fit(index, time_s, 1)(index)
        for index in (np.arange(len(time_s), dtype=float), counted)
        if np.all(np.diff(index) > 0.0)
    ]
    nearest = min(clocks, key=lambda clock: float(np.mean(np.abs(time_s - clock))))
    residual = np.abs(time_s - nearest) / median_step
    irregular = np.max(residual) > LONGEST_RESIDUAL or np.quantile(residual, 0.9) > USUAL_RESIDUAL
    return None if irregular else np.asarray(nearest)
