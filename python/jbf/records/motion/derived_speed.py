"""A recorded speed that was derived from the recorded path: a difference over some samples.

Such a speed is redundant, is coarsely quantised, and is delayed if it is a backward difference. The
speed is classified as derived if it equals the difference, within 5 % of the step of the
difference, in 90 % of the samples in motion.
"""

from __future__ import annotations

import numpy as np

from jbf.arrays import Array
from jbf.records.findings.finding import Finding
from jbf.records.motion.roughness import noise_of, quantum_of, step_of

SPANS = range(1, 13)
"""Numbers of samples over which differences are tried."""
TOP_SPEED_QUANTILE = 0.95
"""Quantile that represents the largest speed; a sample above 2 % of it is in motion."""
MIN_EQUAL_SHARE = 0.9
"""Minimum share of the samples in motion at which the speed equals the difference."""
EQUALITY_TOLERANCE = 0.05
"""Tolerance of the equality, as a share of the step of the difference."""
MAX_NOISE_RATIO = 3.0
"""Noise of a difference, relative to the tolerance, below which it is kept as a measured speed."""


def derived_speed(name: str, time: Array, path: Array, speed: Array) -> Finding | None:
    """Finding that the speed was derived from the path by differences; None if it was measured."""
    if len(time) < 4 * SPANS[-1]:
        return None
    step = quantum_of(path) or step_of(path)
    # Averaged over some samples, because a slow difference is zero between two counts. A quantile
    # replaces the maximum, because messages that arrive together make the difference unbounded.
    local = np.convolve(np.abs(speed), np.ones(SPANS[-1]) / SPANS[-1], "same")
    moving = local > 0.02 * float(np.quantile(np.abs(speed), TOP_SPEED_QUANTILE))
    median_step = float(np.median(np.diff(time)))
    for span in SPANS:
        difference = (path[span:] - path[:-span]) / (time[span:] - time[:-span])
        tolerance = EQUALITY_TOLERANCE * step / (span * median_step)
        middle = moving[span // 2 : span // 2 + len(difference)]
        if noise_of(difference[middle]) < MAX_NOISE_RATIO * tolerance:
            continue
        # Backward and centred differences.
        for after in sorted({0, span // 2}):
            where = slice(span - after, len(time) - after)
            in_motion = moving[where]
            if in_motion.sum() < 50:
                continue
            agrees = np.abs(speed[where] - difference)[in_motion] <= tolerance
            if agrees.mean() > MIN_EQUAL_SHARE:
                return _finding(name, span, (0.5 * span - after) * median_step)
    return None


def _finding(name: str, span: int, delay_s: float) -> Finding:
    words = f"the speed is a difference of the position over {span} samples"
    if delay_s > 0.0:
        words += f", {1e3 * delay_s:.3g} ms late"
    done = "not used; the motion is derived from the position"
    return Finding("coarse_speed", "velocity_m_s", name, float(span), "samples", done, words)


def centred_speed(time: Array, path: Array) -> Array:
    """Speed from the path without delay, m/s; used to detect rests."""
    speed: Array = np.gradient(path, time)
    return speed
