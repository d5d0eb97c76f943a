"""Test for forces that act for several samples: the momentum residual of short windows.

An abrupt motion has large errors of its acceleration, which can explain any force at single
samples. The mean acceleration over a window is known much better: it is the change of the speed
divided by the duration, with the errors of two speeds only. An impact adds an impulse that neither
the recorded force nor the model contains.

For a window of n intervals and duration T, with the mean force F and the mean prediction P without
the inertial force, the momentum residual is ``F - P - m (v_n - v_0) / T`` for an inertia m. It is
computed from the residuals r and the estimated accelerations a as
``mean(r) + m (mean(a) - (v_n - v_0) / T)``. The means are those of the trapezoidal rule. The
variance of the momentum residual is that of the mean noise, of the errors of both speeds, and of
the trapezoidal rule if the recorded force jumps between two samples. A disturbance of one or two
samples is such a jump, and is not found.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from jbf.arrays import Array, Mask
from jbf.diagnosis.ledger import Remainder
from jbf.diagnosis.policy import Policy
from jbf.diagnosis.residual_structure.bursts import describe_events
from jbf.estimation.errors_in_motion import ErrorsInMotion
from jbf.estimation.prepared import Prepared
from jbf.estimation.samples import Samples


def find_disturbances(
    prepared: Sequence[Prepared], samples: Samples, residuals: Sequence[Array], policy: Policy
) -> list[Remainder]:
    """Find disturbances by the momentum residual of short windows.

    The list is empty if there are none. Runs are tested if the model has an inertia and the motion
    has errors. The threshold is multiplied by the robust standard deviation of the standardised
    residuals if it exceeds 1. The share is that of the windows in the sum of squares of the
    included samples.

    Parameters
    ----------
    residuals
        Record minus prediction, in the force unit of the rig, one array per run.
    """
    motion, settings = samples.motion, policy.momentum
    if motion is None:
        return []
    standardised = []
    for run, (p, r, counted) in enumerate(zip(prepared, residuals, samples.counted, strict=True)):
        level = np.ones(len(r)) if samples.level is None else samples.level[run]
        standardised.append(_standardised(p, r, counted, level, motion, run, settings.intervals))
    sizes = np.abs(np.concatenate(standardised))
    sizes = sizes[np.isfinite(sizes)]
    if not len(sizes):
        return []
    threshold = settings.min_sigma * max(1.0, float(np.median(sizes)) / 0.6745)
    in_disturbance = [
        _in_windows(np.abs(z) > threshold, len(r), settings.intervals) & counted
        for z, r, counted in zip(standardised, residuals, samples.counted, strict=True)
    ]
    if not any(np.any(w) for w in in_disturbance):
        return []
    square = sum(float(np.sum(r[w] ** 2)) for r, w in zip(residuals, in_disturbance, strict=True))
    share = square / (samples.count * samples.rms(residuals) ** 2)
    if share < settings.min_share:
        return []
    return [describe_events("momentum", "disturbance", prepared, residuals, in_disturbance, share)]


def _standardised(
    p: Prepared,
    residual: Array,
    counted: Mask,
    level: Array,
    motion: ErrorsInMotion,
    run: int,
    intervals: int,
) -> Array:
    """Momentum residual of each window of a run divided by its standard error.

    The shape is (n - intervals,). It is NaN for a window with an excluded sample or a reversal.
    """
    errors, sensitivity = motion.errors[run], motion.sensitivity[run]
    if errors is None or len(residual) <= intervals or not np.any(sensitivity[:, 2] > 0.0):
        return np.zeros(0)
    speed, acceleration, force = p.motion.velocity, p.motion.acceleration, p.friction
    tested = counted[1:] & counted[:-1] & (level[1:] * level[:-1] > 0.0)
    tested &= speed[1:] * speed[:-1] > 0.0
    step_s = np.diff(p.run.time_s)
    inertia = _interval_means(sensitivity[:, 2])
    imbalance = inertia * (_interval_means(acceleration) - np.diff(speed) / step_s)
    imbalance = np.where(tested, _interval_means(residual) + imbalance, 0.0)
    duration_s = _window_sums(step_s, intervals)
    means = _window_sums(imbalance * step_s, intervals) / duration_s

    noise = np.where(level > 0.0, motion.noise / np.where(level > 0.0, level, 1.0), 0.0) ** 2
    jump_squared = np.maximum(np.diff(force) ** 2 - 2.0 * _interval_means(noise), 0.0)
    jump_squared = np.where(tested, jump_squared, 0.0)
    in_trapezoids = _window_sums(_interval_means(noise) + jump_squared / 12.0, intervals)
    # The scale is an average. It is too small where the motion is abrupt.
    scale = max(motion.scale, 1.0)
    variances = scale**2 * np.einsum("nii->ni", errors.covariance[:, :3, :3])
    by_speed = sensitivity[:, 2] ** 2 * variances[:, 1]
    by_state = np.sum(sensitivity[:, :2] ** 2 * variances[:, :2], axis=1)
    start, end = slice(None, -intervals), slice(intervals, None)
    variance = (
        in_trapezoids / intervals**2
        + (by_speed[start] + by_speed[end]) / duration_s**2
        + np.maximum(by_state[start], by_state[end])
    )
    whole = _window_sums(tested.astype(float), intervals) > intervals - 0.5
    return np.where(whole, means / np.sqrt(np.maximum(variance, 1e-300)), np.nan)


def _interval_means(values: Array) -> Array:
    """Mean of the two values at the ends of each interval, shape (n - 1,)."""
    return 0.5 * (values[1:] + values[:-1])


def _window_sums(values: Array, count: int) -> Array:
    """Sum of the `count` values of each window, shape (n - count + 1,)."""
    total = np.concatenate([[0.0], np.cumsum(values)])
    return np.asarray(total[count:] - total[:-count])


def _in_windows(exceeds: Mask, samples: int, intervals: int) -> Mask:
    """Whether each sample of a run is in one of the windows that exceed the threshold."""
    within = np.zeros(samples, dtype=bool)
    for first in np.flatnonzero(exceeds):
        within[first : first + intervals + 1] = True
    return within
