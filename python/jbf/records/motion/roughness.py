"""The noise on a recorded signal, from its third differences."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

UNEVEN = 3.0
"""Noise so many times its usual size is uneven: locally it counts as it is."""
UNEVEN_SAMPLES = 101
"""Samples over which local noise is taken."""


def noise_of(signal: Array) -> float:
    """Standard deviation of white noise on a smooth signal, from its third differences.

    Robust: half of the samples may do anything.
    """
    if len(signal) < 8:
        return 0.0
    third = np.diff(signal, 3)
    return float(np.median(np.abs(third)) / 0.6745 / np.sqrt(20.0))


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


def encoder_step(path: Array) -> float:
    """The step of the encoder that recorded a path in motion, in the path's unit; zero where its
    samples are finer than any encoder's."""
    step = step_of(path)
    return 0.0 if noise_of(path) > UNEVEN * step / np.sqrt(12.0) else step
