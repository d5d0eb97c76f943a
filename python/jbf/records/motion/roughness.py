"""The noise on a recorded signal, from its third differences."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

UNEVEN = 3.0
"""Noise so many times its usual size is uneven: locally it counts as it is."""
DIGITS = 1e-7
"""Changes by less than this share of a signal's range are rounding: of a file's digits."""
LEVELS = 10
"""Different values that a signal in steps has at least."""
ALTERNATING, VARIOUS = 0.1, 6
"""Least share of sign changes, or least number of sizes, of the second differences of rounding."""
PARTS = 6
"""Parts of the smallest change that are tried as a step."""
WHOLE, MOSTLY = 0.05, 0.9
"""Most changes of a signal that was recorded in steps are so near to a whole number of them."""
UNEVEN_SAMPLES = 101
"""Samples over which local noise is taken."""


def noise_of(signal: Array, time_s: Array | None = None) -> float:
    """Standard deviation of white noise on a smooth signal, from its third differences.

    Robust: half of the samples may do anything.

    Parameters
    ----------
    time_s
        Instants of the samples, s, increasing; None if they are even. Divided differences, over
        the root of the sum of their weights' squares, allow for uneven ones.
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
    """Standard deviation of white noise on a smooth signal, from its differences of an order."""
    if len(signal) < 8:
        return 0.0
    change = np.abs(np.diff(signal, order))
    return float(np.median(change) / 0.6745 / np.sqrt(math.comb(2 * order, order)))


def local_noise(signal: Array) -> Array | float:
    """`noise_of`, sample by sample where the noise is uneven, else one number."""
    usual = noise_of(signal)
    if len(signal) < 4 * UNEVEN_SAMPLES:
        return usual
    from scipy import ndimage  # most of a second to import: not for a prediction of a short run

    third = np.pad(np.abs(np.diff(signal, 3)), (1, 2), mode="reflect")
    local = ndimage.median_filter(third, UNEVEN_SAMPLES, mode="reflect") / 0.6745 / np.sqrt(20.0)
    uneven = local > UNEVEN * usual
    return np.where(uneven, local, usual) if uneven.any() else usual


def step_of(angle: Array) -> float:
    """The encoder's step: the smallest change of angle on record."""
    steps = np.abs(np.diff(angle))
    steps = steps[steps > 1e-12]
    return float(np.min(steps)) if len(steps) else 0.0


def quantum_of(signal: Array) -> float:
    """The step in which a signal was recorded: its changes are multiples of it; zero without one.

    The smallest change alone may be many steps, where the signal is never slow. A signal with few
    different values is one of set levels, not a coarse one.
    """
    if len(np.unique(signal)) < LEVELS:
        return 0.0
    bends = np.diff(signal, 2)
    bends = bends[np.abs(bends) > DIGITS * float(np.ptp(signal))]
    if len(bends) < LEVELS:
        return 0.0
    alternating = np.mean(bends[1:] * bends[:-1] < 0.0) > ALTERNATING
    bends = np.abs(bends)
    # In a short record the smallest change of the change may itself be a few steps.
    for part in range(1, PARTS + 1):
        step = float(np.min(bends)) / part
        steps = np.diff(signal) / step
        if np.mean(np.abs(steps - np.rint(steps)) < WHOLE) > MOSTLY:
            # Ramps and parabolas without noise have a few bends of one sign each.
            various = len(np.unique(np.rint(bends / step))) >= VARIOUS
            return step if alternating or various else 0.0
    return 0.0


def encoder_step(path: Array) -> float:
    """The step of the encoder that recorded a path in motion, in the path's unit; zero where its
    samples are finer than any encoder's."""
    step = step_of(path)
    return 0.0 if noise_of(path) > UNEVEN * step / np.sqrt(12.0) else step
