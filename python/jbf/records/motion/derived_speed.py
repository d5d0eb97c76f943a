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
FILTER_REACH = 6
"""Number of differences before a sample, and of those after it, that a filter contains."""
FILTER_POLES = 2
"""Number of poles of a filter, as of a second-order low-pass."""
FILTER_SAMPLES = 20_000
"""Largest number of samples to which the coefficients of a filter are fitted."""
FILTER_TOLERANCE = 0.1
"""Tolerance of the equality with a filter's output, relative to the standard deviation of the
quantisation errors of the path after the numerator of the filter."""
MIN_NUMERATOR = 0.02
"""Minimum sum of the coefficients of the differences. It is small if the past of a smooth speed
predicts the next value."""
MIN_SAMPLES_IN_MOTION = 50
"""Minimum number of samples in motion."""
MAX_NOISE_RATIO = 3.0
"""Noise of a difference, relative to the tolerance, below which it is kept as a measured speed."""


def derived_speed(name: str, time: Array, path: Array, speed: Array) -> Finding | None:
    """Finding that the speed is a difference of the path or a filter of it; None if measured."""
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
            if in_motion.sum() < MIN_SAMPLES_IN_MOTION:
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
    path, since any smooth speed is the output of a filter of a smooth path. Samples at which the
    path changes by the same number of counts in each step contain none.
    """
    step, step_s = quantum_of(path), float(np.median(np.diff(time)))
    if step == 0.0:
        return False
    counts = np.rint(np.diff(path) / step)
    places = np.arange(FILTER_REACH + FILTER_POLES, len(speed) - FILTER_REACH)
    places = places[moving[places]][:FILTER_SAMPLES]
    around = range(-FILTER_REACH, FILTER_REACH)
    differences = np.stack([counts[places + k] for k in around], axis=1) * (step / step_s)
    varied = np.ptp(differences, axis=1) > 0.0
    places, differences = places[varied], differences[varied]
    if len(places) < MIN_SAMPLES_IN_MOTION:
        return False
    past = np.stack([speed[places - k] for k in range(1, FILTER_POLES + 1)], axis=1)
    design, output = np.hstack([past, differences]), speed[places]
    coefficients = np.linalg.lstsq(design, output, rcond=1e-12)[0]
    numerator = coefficients[FILTER_POLES:]
    inherited = float(np.linalg.norm(np.diff(np.pad(numerator, 1)))) * step / 12.0**0.5 / step_s
    equal = np.abs(output - design @ coefficients) <= FILTER_TOLERANCE * inherited
    return bool(np.sum(numerator) > MIN_NUMERATOR and equal.mean() > MIN_EQUAL_SHARE)


def _finding(name: str, words: str, size: float, delay_s: float = 0.0) -> Finding:
    if delay_s > 0.0:
        words += f", {1e3 * delay_s:.3g} ms late"
    done = "not used; the motion is derived from the position"
    return Finding("coarse_speed", "velocity_m_s", name, size, "samples", done, words)


def centred_speed(time: Array, path: Array) -> Array:
    """Speed from the path without delay, m/s; used to detect rests."""
    speed: Array = np.gradient(path, time)
    return speed
