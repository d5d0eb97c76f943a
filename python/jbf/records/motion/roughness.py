"""Noise and resolution of a recorded signal, from its differences."""

from __future__ import annotations

import math

import numpy as np

from jbf.arrays import Array

MIN_NOISE_RATIO = 3.0
"""Minimum ratio of local to usual noise for a local estimate of heteroscedastic noise."""
DIGITS = (1e-7, 1e-6, 1e-5)
"""Shares of the range of a signal that are tried as the limit below which changes are rounding to
the digits of a file."""
LEVELS = 10
"""Minimum number of different values of a quantised signal."""
MIN_ALTERNATING_SHARE, MIN_SIZES = 0.1, 6
"""Minimum share of sign changes, or number of sizes, of second differences due to rounding."""
MAX_DIVISOR = 6
"""Largest divisor of the smallest change that is tried for the step."""
REFINED = 20_000
"""Approximate number of differences from which a step is refined."""
STEP_TOLERANCE, MIN_WHOLE_SHARE = 0.05, 0.9
"""Tolerance of whole steps, and share of the changes within it, for a quantised signal."""
NOISE_WINDOW = 101
"""Window of local noise, samples."""


def noise_of(signal: Array, time_s: Array | None = None) -> float:
    """Standard deviation of white noise on a smooth signal, from its third differences.

    The estimate is robust: up to half of the samples may be arbitrary.

    Parameters
    ----------
    time_s
        Instants of the samples, s, increasing; None if they are even. For uneven ones, divided
        differences are used, normalised by the root sum of squares of their weights.
    """
    if time_s is None:
        return white_noise(signal, 3)
    if len(signal) < 8:
        return 0.0
    t = np.stack([time_s[k : len(time_s) - 3 + k] for k in range(4)])
    gap = t[:, None, :] - t[None, :, :]
    gap[np.arange(4), np.arange(4)] = 1.0
    weight = 1.0 / np.where(gap == 0.0, np.nan, gap).prod(axis=1)
    weight /= np.sqrt(np.sum(weight**2, axis=0))
    values = np.stack([signal[k : len(signal) - 3 + k] for k in range(4)])
    third = np.sum(weight * (values - values[0]), axis=0)
    third = third[np.isfinite(third)]
    return float(np.median(np.abs(third)) / 0.6745) if len(third) else 0.0


def white_noise(signal: Array, order: int) -> float:
    """Standard deviation of white noise on a smooth signal, from differences of one order."""
    if len(signal) < 8:
        return 0.0
    change = np.abs(np.diff(signal, order))
    return float(np.median(change) / 0.6745 / np.sqrt(math.comb(2 * order, order)))


def local_noise(signal: Array) -> Array | float:
    """Noise standard deviation of each sample if heteroscedastic, otherwise a single number."""
    overall = noise_of(signal)
    if len(signal) < 4 * NOISE_WINDOW:
        return overall
    # Importing takes most of a second; not needed for the prediction of a short run.
    from scipy import ndimage

    third = np.pad(np.abs(np.diff(signal, 3)), (1, 2), mode="reflect")
    local = ndimage.median_filter(third, NOISE_WINDOW, mode="reflect") / 0.6745 / np.sqrt(20.0)
    uneven = local > MIN_NOISE_RATIO * overall
    return np.where(uneven, local, overall) if uneven.any() else overall


def step_of(angle: Array) -> float:
    """Step of an encoder: the smallest recorded change of the angle."""
    steps = np.abs(np.diff(angle))
    steps = steps[steps > 1e-12]
    return float(np.min(steps)) if len(steps) else 0.0


def quantum_of(signal: Array) -> float:
    """Quantisation step of a signal, the largest divisor of its changes; zero if not quantised.

    The smallest change may be several steps if the signal always changes fast. A signal with few
    different values has set levels and is not considered quantised.
    """
    if len(np.unique(signal)) < LEVELS:
        return 0.0
    changes, bends = np.diff(signal), np.diff(signal, 2)
    # The rounding to the digits of a file is unknown: the limits are tried from the smallest.
    found = (_quantum_above(share * float(np.ptp(signal)), changes, bends) for share in DIGITS)
    return next((step for step in found if step > 0.0), 0.0)


def _quantum_above(least: float, changes: Array, bends: Array) -> float:
    """Quantisation step of a signal from its first and second differences; zero without one.

    Differences up to `least` count as zero.
    """
    bends = bends[np.abs(bends) > least]
    changes = changes[np.abs(changes) > least]
    if len(bends) < LEVELS or not len(changes):
        return 0.0
    alternating = np.mean(bends[1:] * bends[:-1] < 0.0) > MIN_ALTERNATING_SHARE
    bends = np.abs(bends)
    differences = np.concatenate([bends, changes])
    sizes = np.sort(np.abs(differences[:: max(len(differences) // REFINED, 1)]))
    # In a short record the smallest second difference may itself be a few steps.
    for part in range(1, MAX_DIVISOR + 1):
        step = _refined(float(np.min(bends)) / part, sizes)
        counts = changes / step
        if np.mean(np.abs(counts - np.rint(counts)) < STEP_TOLERANCE) > MIN_WHOLE_SHARE:
            # Ramps and parabolas without noise have a few second differences, all of the same sign.
            various = len(np.unique(np.rint(bends / step))) >= MIN_SIZES
            return step if alternating or various else 0.0
    return 0.0


def _refined(step: float, sizes: Array) -> float:
    """Quantisation step by least squares, from small to large differences; `step` is approximate.

    The smallest difference contains a rounding error of the file, which would be multiplied by the
    number of steps in a large one. `sizes` has the absolute differences in ascending order.
    """
    for power in range(1, int(np.log10(max(sizes[-1] / step, 1.0))) + 2):
        part = sizes[: np.searchsorted(sizes, 10.0**power * step, "right")]
        counts = np.rint(part / step)
        if counts.any():
            step = float(part @ counts / (counts @ counts))
    return step


def encoder_step(path: Array) -> float:
    """Step of the encoder that recorded a path in motion, in the unit of the path.

    The result is zero if the samples are finer than those of any encoder.
    """
    step = step_of(path)
    return 0.0 if noise_of(path) > MIN_NOISE_RATIO * step / np.sqrt(12.0) else step
