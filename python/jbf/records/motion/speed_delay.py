"""Time delay of the speed: a filtered speed, or a backward difference.

A speed with a short delay is the true speed minus the delay times the acceleration. Both are taken
from the path, over the same windows over which the recorded speed is averaged.
"""

from __future__ import annotations

import numpy as np

from jbf.arrays import Array
from jbf.records.findings.finding import Finding
from jbf.records.motion.window_comparisons import Compared, window_comparisons

MIN_DELAY_ERRORS = 6.0
"""Minimum delay of the speed, in standard errors."""
MAX_CORRELATION = 0.9
"""Correlation of speed and acceleration above which a delay only scales the speed.

This is the case for a speed that decays exponentially.
"""
MAX_DELAY = 1.5
"""Largest delay that the smoother corrects, samples; longer filters also distort the speed."""
JACKKNIFE_BLOCKS = 12
"""Number of blocks of the record for the jackknife standard error."""


def filtered_speed(name: str, time: Array, path: Array, speed: Array) -> Finding | None:
    """Finding that the speed lags the path by more than the smoother corrects, or None."""
    sharpest = min(
        (_speed_delay(c) for c in window_comparisons(time, path, speed)),
        key=lambda candidate: candidate[1],
        default=(0.0, np.inf),
    )
    delay_s, error_s = sharpest
    step_s = float(np.median(np.diff(time)))
    if delay_s < max(MIN_DELAY_ERRORS * error_s, MAX_DELAY * step_s):
        return None
    words = (
        f"the speed lags the position by {1e3 * delay_s:.3g} ms: filtered, or a backward difference"
    )
    done = "not used; the motion is derived from the position"
    return Finding("filtered_speed", "velocity_m_s", name, delay_s, "s", done, words)


def _speed_delay(c: Compared) -> tuple[float, float]:
    """Estimate the delay of the speed and its standard error, s.

    The speed is regressed on the speed and acceleration of the path; the error is by the jackknife
    over parts of the record.
    """
    part = np.arange(len(c.by_path)) * JACKKNIFE_BLOCKS // len(c.by_path)
    x = np.stack([c.by_path, c.acceleration], axis=1)
    alike = abs(float(x[:, 0] @ x[:, 1])) / max(float(np.prod(np.linalg.norm(x, axis=0))), 1e-300)
    if alike > MAX_CORRELATION:
        return 0.0, np.inf
    normal = np.stack([x[part == k].T @ x[part == k] for k in range(JACKKNIFE_BLOCKS)])
    right = np.stack([x[part == k].T @ c.by_speed[part == k] for k in range(JACKKNIFE_BLOCKS)])

    def late(matrix: Array, vector: Array) -> float:
        return -float(np.linalg.lstsq(matrix, vector, rcond=1e-12)[0][1])

    without = [
        late(normal.sum(0) - n, right.sum(0) - r) for n, r in zip(normal, right, strict=True)
    ]
    spread = float(np.std(without)) * np.sqrt(JACKKNIFE_BLOCKS - 1)
    return late(normal.sum(0), right.sum(0)), max(spread, 1e-12)
