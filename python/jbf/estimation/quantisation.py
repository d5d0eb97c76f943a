"""Quantisation bias of the mean reading of a converter.

The mean of readings with step q of a force f with Gaussian noise of standard deviation s is
biased. The first and largest harmonic of the bias is
`(q / pi) exp(-2 (pi s / q)^2) sin(2 pi f / q)` (Widrow 1956). The bias is a function of the force:
it is not reduced by averaging, and repeats with the motion.
"""

from __future__ import annotations

import math

import numpy as np
from scipy import optimize

from jbf.arrays import Array

MOST_NOISE = 3.0
"""Largest noise that is considered, in steps; at larger noise the quantisation is negligible."""
HARMONICS = 3
"""Number of harmonics of the bias; higher ones matter only for noise below a tenth of a step."""


def zero_offset(step_n: float, readings_n: Array) -> float:
    """Offset of the readings from whole multiples of their step, N."""
    turn = 2.0 * np.pi / step_n
    return float(np.angle(np.nanmean(np.exp(1j * turn * readings_n))) / turn)


def quantisation_bias(step_n: float, noise_rms: float, force_n: Array) -> Array:
    """Quantisation bias of the mean reading, shape (n,), N.

    `force_n` is the difference between the force and a reading of the converter, shape (n,), and
    `noise_rms` the standard deviation of the noise before the converter, N. A converter that rounds
    down is equivalent to one that rounds to the nearest step and has a zero offset of half a step.
    Relative to this offset, the bias is the same for both.
    """
    turn, ratio = 2.0 * np.pi * force_n / step_n, np.pi * noise_rms / step_n
    waves = (
        (-1.0) ** k / k * np.exp(-2.0 * (k * ratio) ** 2) * np.sin(k * turn)
        for k in range(1, HARMONICS + 1)
    )
    return np.asarray(step_n / np.pi * sum(waves), dtype=np.float64)


def bias_rms(step_n: float, noise_rms: float) -> float:
    """RMS of the quantisation bias over the force, N.

    `step_n` is the quantisation step and `noise_rms` the standard deviation of the noise before the
    converter, N.
    """
    ratio = math.pi * noise_rms / step_n
    return step_n / math.pi * math.exp(-2.0 * ratio**2) / math.sqrt(2.0)


def noise_before_converter(step_n: float, moves_n: Array) -> float:
    """Estimate the standard deviation of the noise before the converter, N, from equal readings.

    `moves_n` has the differences between successive readings of a slowly varying force, shape (n,).
    The estimate uses the fraction of readings that equal the preceding one. Two values a Gaussian
    distance d apart, at a random position within the steps q, give the same reading with
    probability `E max(0, 1 - |d| / q)`. Third differences would count the quantisation steps as
    noise.
    """
    if not len(moves_n):
        return 0.0
    same = float(np.mean(np.abs(moves_n) < 0.5 * step_n))

    def excess(noise: float) -> float:
        """Predicted minus observed fraction of equal successive readings."""
        return _same(noise) - same

    if excess(1e-3) <= 0.0:
        return 0.0
    if excess(MOST_NOISE) >= 0.0:
        return MOST_NOISE * step_n
    return step_n * float(optimize.brentq(excess, 1e-3, MOST_NOISE))


def _same(noise: float) -> float:
    """Probability that two successive readings are equal; the noise is given in steps."""
    sd = math.sqrt(2.0) * noise  # standard deviation of the difference of two readings
    mean = sd * math.sqrt(2.0 / math.pi) * -math.expm1(-0.5 / sd**2)
    return math.erf(1.0 / (sd * math.sqrt(2.0))) - mean
