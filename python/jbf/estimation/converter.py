"""What a converter's steps make of a mean reading.

Of a force f with Gaussian noise of s the mean of readings in steps q is off by
`(q / pi) exp(-2 (pi s / q)^2) sin(2 pi f / q)`, its first and largest harmonic (Widrow 1956): a
curve of the force that no sample averages out, and that comes again with the motion.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
from scipy import optimize

Array = npt.NDArray[np.float64]
MOST_NOISE = 3.0
"""Noise of so many steps hides them: more is not asked for."""


HARMONICS = 3
"""Harmonics of the bias that are counted: those beyond need noise below a tenth of a step."""


def origin_n(step_n: float, readings_n: Array) -> float:
    """How far the readings lie from whole multiples of their step, N."""
    turn = 2.0 * np.pi / step_n
    return float(np.angle(np.nanmean(np.exp(1j * turn * readings_n))) / turn)


def bias_n(step_n: float, noise_n: float, force_n: Array) -> Array:
    """By how much the mean reading is off, shape (n,), N.

    A converter that rounds down is one that rounds to the nearest, with a zero that is off by half
    a step: of the mean reading that a model with that zero expects, both are off alike.

    Parameters
    ----------
    step_n
        The converter's step, N.
    noise_n
        Standard deviation of the noise before it, N.
    force_n
        The force above a reading of the converter, shape (n,), N.
    """
    turn, ratio = 2.0 * np.pi * force_n / step_n, np.pi * noise_n / step_n
    waves = (
        (-1.0) ** k / k * np.exp(-2.0 * (k * ratio) ** 2) * np.sin(k * turn)
        for k in range(1, HARMONICS + 1)
    )
    return np.asarray(step_n / np.pi * sum(waves), dtype=np.float64)


def curve_rms_n(step_n: float, noise_n: float) -> float:
    """RMS of that curve, N.

    Parameters
    ----------
    step_n
        The converter's step, N.
    noise_n
        Standard deviation of the noise on the force before it is converted, N.
    """
    ratio = math.pi * noise_n / step_n
    return step_n / math.pi * math.exp(-2.0 * ratio**2) / math.sqrt(2.0)


def noise_before(step_n: float, moves_n: Array) -> float:
    """Standard deviation of the noise before the converter, N.

    By how often a reading is the one before it: two values a Gaussian distance d apart, anywhere
    within the steps, give one reading with the probability `E max(0, 1 - |d| / q)`. Third
    differences would take the steps themselves for noise.

    Parameters
    ----------
    step_n
        The converter's step q, N.
    moves_n
        From each reading to the next, of a force that moves slowly, shape (n,), N.
    """
    if not len(moves_n):
        return 0.0
    same = float(np.mean(np.abs(moves_n) < 0.5 * step_n))

    def more_often(noise: float) -> float:
        return _same(noise) - same

    if more_often(1e-3) <= 0.0:
        return 0.0
    if more_often(MOST_NOISE) >= 0.0:
        return MOST_NOISE * step_n
    return step_n * float(optimize.brentq(more_often, 1e-3, MOST_NOISE))


def _same(noise: float) -> float:
    """Probability that two readings are one, with noise in steps."""
    apart = math.sqrt(2.0) * noise
    spread = apart * math.sqrt(2.0 / math.pi) * -math.expm1(-0.5 / apart**2)
    return math.erf(1.0 / (apart * math.sqrt(2.0))) - spread
