"""A speed that is late: filtered, or a difference that looks back.

A speed that lags by a short time is the true speed less that time's worth of acceleration. Both are
taken from the path, over windows over which the recorded speed is averaged, too.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from jbf.records.findings.finding import Finding
from jbf.records.motion.compared import Compared, compared

Array = npt.NDArray[np.float64]

SURE = 6.0
"""Standard errors by which a speed must be late,"""
ALIKE = 0.9
"""Correlation of speed and acceleration above which (a speed that dies out) late is but smaller."""
WITHIN = 1.5
"""Samples up to which the smoother corrects a late speed. A longer filter has a shape, too."""
STRETCHES = 12
"""Parts of the record that are left out in turn, for the error."""


def filtered_speed(name: str, time: Array, path: Array, speed: Array) -> Finding | None:
    """A finding where the speed is later than the path by more than the smoother corrects."""
    sharpest = min(
        (_lateness(c) for c in compared(time, path, speed)),
        key=lambda found: found[1],
        default=(0.0, np.inf),
    )
    late_s, error_s = sharpest
    step_s = float(np.median(np.diff(time)))
    if late_s < max(SURE * error_s, WITHIN * step_s):
        return None
    words = f"the speed is {1e3 * late_s:.3g} ms later than the path: filtered, or looking back"
    done = "left aside; the path alone tells the motion"
    return Finding("filtered_speed", "velocity_m_s", name, late_s, "s", done, words)


def _lateness(c: Compared) -> tuple[float, float]:
    """How late the speed is and its standard error, s: regression on speed and acceleration by the
    path, stretches of the record left out in turn."""
    part = np.arange(len(c.by_path)) * STRETCHES // len(c.by_path)
    x = np.stack([c.by_path, c.acceleration], axis=1)
    alike = abs(float(x[:, 0] @ x[:, 1])) / max(float(np.prod(np.linalg.norm(x, axis=0))), 1e-300)
    if alike > ALIKE:
        return 0.0, np.inf
    normal = np.stack([x[part == k].T @ x[part == k] for k in range(STRETCHES)])
    right = np.stack([x[part == k].T @ c.by_speed[part == k] for k in range(STRETCHES)])

    def late(matrix: Array, vector: Array) -> float:
        return -float(np.linalg.lstsq(matrix, vector, rcond=1e-12)[0][1])

    without = [
        late(normal.sum(0) - n, right.sum(0) - r) for n, r in zip(normal, right, strict=True)
    ]
    spread = float(np.std(without)) * np.sqrt(STRETCHES - 1)
    return late(normal.sum(0), right.sum(0)), max(spread, 1e-12)
