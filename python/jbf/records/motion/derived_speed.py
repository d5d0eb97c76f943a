"""A recorded speed that was derived from the recorded path: a difference, or a filtered difference.

Such a speed is redundant, is coarsely quantised, and is delayed if it is a backward difference or
filtered by a causal filter. The speed is classified as derived if it equals the output of a linear
filter of the path in 90 % of the samples in motion, within a tolerance that is small relative to
the errors that it inherits from the path.
"""

from __future__ import annotations

import numpy as np

from jbf.arrays import Array, Mask
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
FILTER_DELAY = 6
"""Longest delay and longest advance of a difference in the impulse response, samples."""
FILTER_POLES = 2
"""Number of poles of the filter, as of a second-order low-pass."""
FILTER_SAMPLES = 20_000
"""Largest number of samples to which the coefficients of a filter are fitted."""
FILTER_TOLERANCE = 0.1
"""Tolerance of the equality with a filter's output, relative to the standard deviation of the
quantisation errors of the path in that output. An independent speed deviates by more."""
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
                words = f"the speed is a difference of the position over {span} samples"
                return _finding(name, words, float(span), (0.5 * span - after) * median_step)
    if _is_filtered(time, path, speed, moving):
        return _finding(name, "the speed is a filtered difference of the position", 1.0)
    return None


def _is_filtered(time: Array, path: Array, speed: Array, moving: Mask) -> bool:
    """Whether a linear filter of the differences of the path has the speed as its output.

    The coefficients of the filter are fitted. The speed must contain the errors of a quantised
    path, since any smooth speed is the output of a filter of a smooth path.
    """
    error = quantum_of(path) / 12.0**0.5
    if error == 0.0:
        return False
    difference = np.diff(path) / np.diff(time)
    places = np.arange(FILTER_DELAY + FILTER_POLES, len(speed) - FILTER_DELAY)
    places = places[moving[places]][:FILTER_SAMPLES]
    if len(places) < 50:
        return False
    delays = range(1 - FILTER_DELAY, FILTER_DELAY + 1)
    columns = [speed[places - k] for k in range(1, FILTER_POLES + 1)]
    columns += [difference[places - k] for k in delays]
    design, output = np.stack(columns, axis=1), speed[places]
    coefficients = np.linalg.lstsq(design, output, rcond=1e-12)[0]
    response = np.pad(coefficients[FILTER_POLES:], 1)
    inherited = error * float(np.linalg.norm(np.diff(response)) / np.median(np.diff(time)))
    equal = np.abs(output - design @ coefficients) <= FILTER_TOLERANCE * inherited
    return bool(equal.mean() > MIN_EQUAL_SHARE)


def _finding(name: str, words: str, size: float, delay_s: float = 0.0) -> Finding:
    if delay_s > 0.0:
        words += f", {1e3 * delay_s:.3g} ms late"
    done = "not used; the motion is derived from the position"
    return Finding("coarse_speed", "velocity_m_s", name, size, "samples", done, words)


def centred_speed(time: Array, path: Array) -> Array:
    """Speed from the path without delay, m/s; used to detect rests."""
    speed: Array = np.gradient(path, time)
    return speed
