"""Test for forces that act for several samples: the balance of momentum over short windows.

An abrupt motion has large errors of its acceleration, which can explain any force at single
samples. The mean acceleration over a window is known much better: it is the change of the speed
divided by the duration, with the errors of two speeds only. A disturbance such as an impact changes
the momentum by another amount than the recorded force and the friction do.

For a window of n intervals and duration T, with the mean force F and the mean prediction P without
the force of the inertia m, the test statistic is ``F - P - m (v_n - v_0) / T``. It is computed from
the residuals r and the estimated accelerations a as ``mean(r) + m (mean(a) - (v_n - v_0) / T)``.
The means are those of the trapezoidal rule. The variance of the statistic is that of the mean
noise, of the errors of both speeds, and of the rule where the force changes between samples.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from jbf.arrays import Array, Mask
from jbf.diagnosis.ledger import Remainder
from jbf.diagnosis.policy import Policy
from jbf.diagnosis.residual_structure.bursts import described
from jbf.estimation.errors_in_motion import ErrorsInMotion
from jbf.estimation.prepared import Prepared
from jbf.estimation.samples import Samples


def find_disturbances(
    prepared: Sequence[Prepared], samples: Samples, residuals: Sequence[Array], policy: Policy
) -> list[Remainder]:
    """Test for disturbances by the balance of momentum; an empty list if there are none.

    The motion must have errors, and the model an inertia. `residuals` are record minus prediction,
    N, one array per run.
    """
    motion, settings = samples.motion, policy.momentum
    if motion is None:
        return []
    statistics = [
        _statistics(p, r, counted, motion, run, settings.intervals)
        for run, (p, r, counted) in enumerate(
            zip(prepared, residuals, samples.counted, strict=True)
        )
    ]
    sizes = np.abs(np.concatenate(statistics))
    sizes = sizes[sizes > 0.0]
    if not len(sizes):
        return []
    least = settings.min_sigma * max(1.0, float(np.median(sizes)) / 0.6745)
    where = [
        _within_windows(np.abs(z) > least, len(r), settings.intervals) & counted
        for z, r, counted in zip(statistics, residuals, samples.counted, strict=True)
    ]
    square = sum(float(np.sum(r[w] ** 2)) for r, w in zip(residuals, where, strict=True))
    share = square / max(samples.count * samples.rms(residuals) ** 2, 1e-300)
    if share < settings.min_share:
        return []
    return [described("momentum", "disturbance", prepared, residuals, where, share)]


def _statistics(
    p: Prepared, residual: Array, counted: Mask, motion: ErrorsInMotion, run: int, intervals: int
) -> Array:
    """Standardised balance of momentum of each window of a run; zero where it is not tested.

    A window is tested if all of its samples are included and have the same direction of motion.
    """
    errors, sensitivity = motion.errors[run], motion.sensitivity[run]
    if errors is None or len(residual) <= intervals:
        return np.zeros(0)
    speed, acceleration, force = p.motion.velocity, p.motion.acceleration, p.friction
    step_s = np.diff(p.run.time_s)
    inertia = _middle(sensitivity[:, 2])
    excess = _middle(residual) + inertia * (_middle(acceleration) - np.diff(speed) / step_s)
    duration_s = _summed(step_s, intervals)
    balance = _summed(excess * step_s, intervals) / duration_s

    variances = motion.scale**2 * np.einsum("nii->ni", errors.covariance[:, :3, :3])
    start, end = variances[:-intervals], variances[intervals:]
    change = np.maximum(np.diff(force) ** 2 - 2.0 * motion.noise**2, 0.0)
    variance = (
        motion.noise**2 / intervals
        + (inertia[: len(balance)] / duration_s) ** 2 * (start[:, 1] + end[:, 1])
        + np.sum(sensitivity[:-intervals, :2] ** 2 * start[:, :2], axis=1)
        + _summed(change, intervals) / (12.0 * intervals**2)
    )
    tested = counted[1:] & counted[:-1] & (speed[1:] * speed[:-1] > 0.0)
    whole = _summed(tested.astype(float), intervals) > intervals - 0.5
    return np.where(whole, balance / np.sqrt(variance), 0.0)


def _middle(values: Array) -> Array:
    """Means of successive values."""
    return 0.5 * (values[1:] + values[:-1])


def _summed(values: Array, count: int) -> Array:
    """Sums of `count` successive values, one for each first value."""
    total = np.concatenate([[0.0], np.cumsum(values)])
    return np.asarray(total[count:] - total[:-count])


def _within_windows(found: Mask, samples: int, intervals: int) -> Mask:
    """Whether each sample is in one of the windows that were found."""
    within = np.zeros(samples, dtype=bool)
    for first in np.flatnonzero(found):
        within[first : first + intervals + 1] = True
    return within
