"""Errors of the readings of a motion, and its corners, by expectation-maximisation (EM).

The noise that drives the motion follows a t distribution: a normal one whose intensity q c_k in
step k has an inverse gamma factor c_k. EM maximises the likelihood over the scale q and the
variances of the readings; it is stopped before its end (`ROBUST_PASSES`).

References
----------
Shumway & Stoffer (1982) (EM for state-space models); Lange, Little & Taylor (1989) (EM for the t
distribution); Bishop, Pattern Recognition and Machine Learning (2006), section 10.1 (lower bound).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from jbf._core import SmoothedMotion
from jbf.records.motion.readings import AT_REST, ReadingErrors, Readings

Array = npt.NDArray[np.float64]

FREEDOM = 2.0
"""Degrees of freedom of the noise's t distribution: with few, corners are sharp."""
GAUSSIAN_PASSES, ROBUST_PASSES = 6, 24
"""EM passes with normal noise, for a start, and with a t distribution. More of the latter reduce
the intensity between corners further, and the standard errors of the motion become too small."""
SETTLED = 0.01
"""EM ends where intensity and variances change by less than this share in a pass."""


def estimated(
    readings: Readings,
    errors: ReadingErrors,
    corners: Array | None = None,
    passes: int = ROBUST_PASSES,
) -> tuple[ReadingErrors, Array]:
    """Estimate errors and intensity factors by EM from starting values."""
    if corners is None:
        corners = np.ones(len(readings.time_s) - 1)
    speed = np.zeros(len(readings.time_s))
    for k in range(GAUSSIAN_PASSES + passes):
        motion = readings.smoothed(errors, corners, speed)
        speed = motion.mean[:, 1]
        if k >= GAUSSIAN_PASSES:
            corners = corners_of(errors, motion)
        previous, errors = errors, _maximised(readings, errors, corners, motion)
        change = np.log(
            [errors.intensity, errors.position_variance, errors.velocity_variance]
        ) - np.log([previous.intensity, previous.position_variance, previous.velocity_variance])
        if k > GAUSSIAN_PASSES + 2 and np.max(np.abs(change)) < SETTLED:
            break
    return errors, corners


def corners_of(errors: ReadingErrors, motion: SmoothedMotion) -> Array:
    """Factor of the intensity in each step: the reciprocal of the posterior mean of 1 / c_k."""
    square = motion.disturbance / errors.intensity
    square = np.where(np.isfinite(square), square, float(errors.order))
    factor: Array = (FREEDOM + square) / (FREEDOM + errors.order)
    return factor


def _maximised(
    readings: Readings, errors: ReadingErrors, corners: Array, motion: SmoothedMotion
) -> ReadingErrors:
    """The M step: variances that maximise the expected likelihood."""
    intensity = float(np.nanmean(motion.disturbance / corners)) / errors.order
    mean, covariance = motion.mean, motion.covariance
    position, stamp = errors.position_variance, errors.stamp_variance
    seen = np.isfinite(readings.position)
    if seen.any():
        misfit = (readings.position - mean[:, 0]) ** 2 + covariance[:, 0, 0]
        by_stamp = errors.stamp_variance * mean[:, 1] ** 2
        own = errors.position_variance * readings.position_shape**2
        total = own + by_stamp
        # The expected squares of the two errors that make up each misfit.
        excess = (misfit - total) / total**2
        weight = seen / readings.position_shape**2
        stamp = errors.stamp_variance * float(1.0 + np.average(by_stamp * excess, weights=weight))
        position = errors.position_variance * float(1.0 + np.average(own * excess, weights=weight))
    velocity = errors.velocity_variance
    seen = np.isfinite(readings.velocity) & (readings.velocity_shape > AT_REST)
    if seen.any():
        late = -errors.velocity_delay_s
        row = np.array([0.0, 1.0, late, late**2 / 2.0])[: errors.order]
        misfit = (readings.velocity - mean @ row) ** 2 + (covariance @ row) @ row
        velocity = float(np.mean(misfit[seen] / readings.velocity_shape[seen] ** 2))
    return replace(
        errors,
        position_variance=max(position, readings.position_floor),
        velocity_variance=max(velocity, readings.velocity_floor),
        stamp_variance=stamp,
        intensity=max(intensity, 1e-300),
    )


def lower_bound(readings: Readings, errors: ReadingErrors, corners: Array) -> float:
    """Variational lower bound of the log likelihood, marginal over the factors of all steps.

    Notes
    -----
    With ``w = 1 / c`` the bound is ``log p(y | E w) + sum(N / 2 (E log w - log E w) - KL)``, where
    KL is the Kullback-Leibler divergence of the posterior of w, a gamma distribution, from its
    prior. It is exact as a bound at a fixed point of EM, and close to one before.
    """
    from scipy.special import digamma, gammaln  # half a second to import

    prior, order = 0.5 * FREEDOM, float(errors.order)
    motion = readings.smoothed(errors, corners, readings.first_speed())
    square = motion.disturbance / errors.intensity
    shape, rate = prior + 0.5 * order, prior + 0.5 * square[np.isfinite(square)]
    gain = 0.5 * order * (digamma(shape) - np.log(shape)) - (shape - prior) * digamma(shape)
    gain += gammaln(shape) - gammaln(prior)
    each = gain - prior * np.log(rate / prior) - shape * (prior - rate) / rate
    return float(motion.log_likelihood + np.sum(each))
