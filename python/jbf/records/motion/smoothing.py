"""Fixed-interval smoothing of position and velocity with estimated reading errors.

The jerk or the snap of the motion is Student-t noise: large in the few steps with a corner, small
elsewhere. With a random jerk the acceleration jumps at a corner; with a random snap it is smooth.
The model of higher likelihood is used. Expectation-maximisation (`Readings.estimated`) estimates
the errors of the readings; this module searches the starting values.

References
----------
Bar-Shalom, Li & Kirubarajan (2001), section 6.2 (Wiener-process acceleration).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from jbf.records.motion.readings import AT_REST, ReadingErrors, Readings
from jbf.records.motion.roughness import noise_of

Array = npt.NDArray[np.float64]

JERK, SNAP = 3, 4
"""Order of the derivative of the position that is noise."""
SHORTEST = 4
"""Number of samples below which nothing is estimated: the motion is a parabola through them."""
CHOSEN, LONGEST = 3_000, 8_000
"""Length of the segments with the most motion, samples.

In a longer record, the start, the order and the clock are chosen from the first length, and the
parameters are estimated from the second.
"""
PASSES = (6, 24)
"""Passes of expectation-maximisation with normal noise, for a start, and with a t distribution.

More of the latter reduce the intensity between corners further, and the standard errors of the
motion become too small.
"""
TRIED = (3, 12)
"""Passes after which the order is chosen.

With fewer passes, the order for a position loop with stick-slip is uncertain.
"""
SNAP_GAIN = 0.02
"""Minimum gain in the lower bound, per sample, for a random snap, which smooths corners."""
LONG_PASSES = 12
"""Passes in which the corners are estimated with known errors of the readings."""
GRID, SMOOTHEST = 2.0 * np.log(10.0), 16
"""Step of the logarithm of the intensity in a first search, and the largest number of steps."""
FLAT = 0.5
"""Log-likelihood gain in two of these steps below which the search ends."""
NARROW = 2.0
"""Range around a known intensity, decades."""
DELAY_GAIN = 10.0
"""Minimum log-likelihood gain of a delay of the velocity."""
START_FACTORS = (1.0, 10.0, 100.0)
"""Starting factors applied to the standard deviation of the velocity by third differences."""
DELAY_ROUNDS, DELAY_SETTLED = 4, 0.01
"""Largest number of searches of the delay, and the change that ends them, samples."""
HIDDEN = 0.01
"""Factor of a second, smaller velocity variance at which a delay is evaluated."""
STAMP_ERRORS = (0.01, 0.05, 0.2)
"""Standard errors of the instants that are tried, in samples."""
START_GAIN = 10.0
"""Minimum gain in the lower bound for an additional starting value."""
STAMP_GAIN = 10.0
"""Minimum log-likelihood gain of an error of the instants."""
TURN_GAIN = 3.0
"""Minimum log-likelihood gain of corners at all reversals."""
LONGEST_DELAY = 1.5
"""Largest delay of the velocity that is searched, samples."""


@dataclass(frozen=True, eq=False)
class Smoothed:
    """Posterior of a motion at n instants.

    Attributes
    ----------
    readings, errors
        Readings, and their estimated errors.
    corners
        Factor of the noise intensity in each step, shape (n - 1,).
    speed
        Speed at each sample, for the effect of the errors of the time stamps, shape (n,).
    mean, covariance
        Position and its first N - 1 derivatives, shape (n, N), and their covariance, shape (n, N,
        N), where the N-th derivative is noise.
    gain
        Gains of the posterior as a Markov chain backward in time, shape (n - 1, N, N).
    """

    readings: Readings
    errors: ReadingErrors
    corners: Array
    speed: Array
    mean: Array
    covariance: Array
    gain: Array

    @classmethod
    def of(
        cls, readings: Readings, errors: ReadingErrors, corners: Array, speed: Array
    ) -> Smoothed:
        """Compute the posterior for given errors."""
        found = readings.smoothed(errors, corners, speed)
        return cls(readings, errors, corners, speed, found.mean, found.covariance, found.gain)

    def rougher(self, factor: float, *, same_corners: bool = False) -> Smoothed:
        """Posterior of the same readings with the noise intensity multiplied by a factor.

        Parameters
        ----------
        same_corners
            True to keep the factors of the corners instead of estimating them again.
        """
        if self.errors.intensity <= 0.0:
            return self
        errors = replace(self.errors, intensity=factor * self.errors.intensity)
        if same_corners:
            return Smoothed.of(self.readings, errors, self.corners, self.speed)
        return _smoothed(self.readings, errors, self.readings.corners(errors, LONG_PASSES))

    def at(self, instants_s: Array) -> tuple[Array, Array, Array]:
        """Mean, covariance and gain at other instants, s, not decreasing and within the motion."""
        time = self.readings.time_s
        whole, where = np.unique(np.concatenate([time, instants_s]), return_inverse=True)
        sample, asked = where[: len(time)], where[len(time) :]

        def spread(values: Array, missing: float) -> Array:
            found = np.full(len(whole), missing)
            found[sample] = values
            return found

        readings = replace(
            self.readings,
            time_s=whole,
            position=spread(self.readings.position, np.nan),
            velocity=spread(self.readings.velocity, np.nan),
            position_shape=spread(self.readings.position_shape, 1.0),
            velocity_shape=spread(self.readings.velocity_shape, 1.0),
        )
        step = np.clip(np.searchsorted(time, whole[:-1], "right") - 1, 0, len(time) - 2)
        found = readings.smoothed(self.errors, self.corners[step], spread(self.speed, 0.0))
        return found.mean[asked], found.covariance[asked], _composed(found.gain, asked)


def _composed(gain: Array, chosen: npt.NDArray[np.intp]) -> Array:
    """Gains from each chosen instant to the next chosen one."""
    first, last = chosen[:-1], chosen[1:]
    one = np.eye(gain.shape[1])
    found: Array = np.broadcast_to(one, (len(first), *one.shape)).copy()
    for further in range(int(np.max(last - first, initial=0))):
        reached = first + further < last
        found[reached] = found[reached] @ gain[(first + further)[reached]]
    return found


def is_even(readings: Readings, even_s: Array) -> bool:
    """Return whether an even clock has a higher likelihood than the recorded time stamps.

    Parameters
    ----------
    even_s
        Instants of the even clock, s.
    """
    part = _longest_path_window(readings, CHOSEN)
    few = readings.part(part)
    _, by_stamps = _likeliest_stamps(few)
    _, by_clock = _likeliest_stamps(replace(few, time_s=even_s[part]))
    return by_clock > by_stamps


def smooth(readings: Readings, starts: Sequence[ReadingErrors] = ()) -> Smoothed:
    """Estimate the errors of the readings by maximum likelihood, and smooth the motion.

    Parameters
    ----------
    starts
        Additional starting values. The solution with the largest lower bound is used, if it gains
        at least `START_GAIN`.
    """
    n = len(readings.time_s)
    if n < SHORTEST:
        errors = replace(_start(readings), intensity=0.0)
        return Smoothed.of(readings, errors, np.ones(max(n - 1, 0)), np.zeros(n))
    start = _of_likeliest_order(readings.part(_longest_path_window(readings, CHOSEN)))
    few = readings.part(_longest_path_window(readings, LONGEST))
    errors, corners = _delayed(few, start)
    if starts:
        most = few.lower_bound(errors, corners) + START_GAIN
        for end in (_delayed(few, tried) for tried in starts):
            if (bound := few.lower_bound(*end)) > most:
                (errors, corners), most = end, bound
    if n > len(few.time_s):
        corners = readings.corners(errors, LONG_PASSES)
    return _smoothed(readings, errors, corners)


def _smoothed(readings: Readings, errors: ReadingErrors, corners: Array) -> Smoothed:
    """Posterior with localised corners, and with corners at all reversals if more likely."""
    mean = readings.smoothed(errors, corners, np.zeros(len(readings.time_s))).mean
    found = _located_to_a_step(corners)
    if errors.order == JERK:
        turns = _of_reversals(readings, errors, mean)
        tried = _located_to_a_step(np.maximum(corners, turns))
        without, with_turns = (
            readings.log_likelihood(errors, c, mean[:, 1]) for c in (found, tried)
        )
        if with_turns > without + TURN_GAIN:
            found = tried
    return Smoothed.of(readings, errors, found, mean[:, 1])


def _of_reversals(readings: Readings, errors: ReadingErrors, mean: Array) -> Array:
    """Factors of the noise intensity that permit a jump of the acceleration at each reversal.

    In a step with a reversal the friction reverses too, so that the acceleration may change by its
    RMS. The factors are zero in the other steps.
    """
    step_s = np.maximum(np.diff(readings.time_s), 1e-300)
    at_rest = readings.velocity_shape <= AT_REST
    reverses = (mean[1:, 1] * mean[:-1, 1] <= 0.0) & ~(at_rest[1:] & at_rest[:-1])
    square = float(np.mean(mean[:, 2] ** 2))
    return np.where(reverses, square / (max(errors.intensity, 1e-300) * step_s), 0.0)


def _likeliest_start(readings: Readings) -> tuple[ReadingErrors, float]:
    """Starting values of the reading errors, and their log-likelihood.

    The variances follow from the roughness of the readings, a median over all samples. If the
    machine is mostly at rest, the variance of the readings in motion is larger. Larger variances of
    the velocity are therefore tried as well, and the most likely starting values are returned.
    """
    start = _start(readings)
    tried = [
        _likeliest_intensity(
            readings, replace(start, velocity_variance=factor**2 * start.velocity_variance)
        )
        for factor in (START_FACTORS if np.isfinite(readings.velocity).any() else (1.0,))
    ]
    return max(tried, key=lambda found: found[1])


def _start(readings: Readings) -> ReadingErrors:
    """Starting values of the reading errors, from the roughness of the readings in motion.

    The variance of the time stamps is zero, and the intensity of the noise is one.
    """
    noise = []
    for signal, shape, floor in (
        (readings.position, readings.position_shape, readings.position_floor),
        (readings.velocity, readings.velocity_shape, readings.velocity_floor),
    ):
        seen = np.isfinite(signal) & (shape > AT_REST)
        noise.append(max(noise_of(signal[seen], readings.time_s[seen]) ** 2, floor))
    return ReadingErrors(noise[0], noise[1], 0.0, 1.0)


def _of_likeliest_order(readings: Readings) -> ReadingErrors:
    """Initial reading errors, with the noise process (`JERK` or `SNAP`) of higher likelihood."""
    start, _ = _likeliest_stamps(readings)
    # The zero velocities assigned at rest are not readings.
    read = np.where(readings.velocity_shape > AT_REST, readings.velocity, np.nan)
    readings = replace(readings, velocity=read)
    jerk, snap = (
        _likeliest_intensity(readings, replace(start, order=order))[0] for order in (JERK, SNAP)
    )
    ones = np.ones(len(readings.time_s) - 1)
    of_jerk, of_snap = (
        readings.lower_bound(*readings.estimated(each, ones, TRIED)) for each in (jerk, snap)
    )
    return snap if of_snap - of_jerk > SNAP_GAIN * len(ones) else jerk


def _likeliest_intensity(
    readings: Readings, errors: ReadingErrors, decades: float | None = None
) -> tuple[ReadingErrors, float]:
    """Maximise the likelihood over the intensity of normal noise that is constant in time.

    Returns the errors with this intensity, and the log-likelihood.

    Parameters
    ----------
    decades
        Search range around the current intensity, decades; unlimited if None.
    """
    ones, speed = np.ones(len(readings.time_s) - 1), readings.first_speed()

    def cost(log_intensity: float) -> float:
        tried = replace(errors, intensity=float(np.exp(log_intensity)))
        return -readings.log_likelihood(tried, ones, speed)

    if decades is not None:
        middle = float(np.log(errors.intensity))
        low, high = middle - decades * np.log(10.0), middle + decades * np.log(10.0)
    else:
        step, top = float(np.median(np.diff(readings.time_s))), float(np.max(np.abs(speed)))
        most = top**2 / step ** (2 * errors.order - 3)
        if most <= 0.0 or not np.isfinite(most):
            return errors, -cost(float(np.log(errors.intensity)))
        # From a motion that follows every reading to smoother ones, until the likelihood stops
        # rising.
        grid = np.log(most) - GRID * np.arange(SMOOTHEST)
        costs = [cost(grid[0])]
        while len(costs) < SMOOTHEST and (len(costs) < 3 or costs[-1] < costs[-3] - FLAT):
            costs.append(cost(grid[len(costs)]))
        best = int(np.argmax(np.array(costs) < min(costs) + FLAT))
        low, high = grid[best] - GRID, grid[max(best - 1, 0)]
    from scipy.optimize import minimize_scalar  # importing takes half a second

    found = minimize_scalar(cost, bounds=(low, high), method="bounded", options={"xatol": 0.5})
    return replace(errors, intensity=float(np.exp(found.x))), -float(found.fun)


def _likeliest_stamps(readings: Readings) -> tuple[ReadingErrors, float]:
    """Maximum-likelihood errors with or without time-stamp jitter; penalised log-likelihood."""
    step = float(np.median(np.diff(readings.time_s)))
    found = _likeliest_start(readings)
    start, _ = found
    for share in STAMP_ERRORS if np.isfinite(readings.position).any() else ():
        tried = replace(start, stamp_variance=(share * step) ** 2)
        tried, likelihood = _likeliest_intensity(readings, tried, NARROW)
        if likelihood - STAMP_GAIN > found[1]:
            found = tried, likelihood - STAMP_GAIN
    return found


def _longest_path_window(readings: Readings, longest: int) -> slice:
    """Window of at most `longest` samples with the longest path."""
    n = len(readings.time_s)
    if n <= longest:
        return slice(0, n)
    gone = np.abs(np.diff(np.nan_to_num(readings.position), prepend=0.0))
    gone[0] = 0.0
    if not gone.any():
        gone = np.abs(np.nan_to_num(readings.velocity))
    total = np.concatenate(([0.0], np.cumsum(gone)))
    first = int(np.argmax(total[longest:] - total[:-longest]))
    return slice(first, first + longest)


def _delayed(readings: Readings, start: ReadingErrors) -> tuple[ReadingErrors, Array]:
    """Errors and corners with the maximum-likelihood delay of the velocity."""
    errors, corners = readings.estimated(start, np.ones(len(readings.time_s) - 1), PASSES)
    if not (np.isfinite(readings.position).any() and np.isfinite(readings.velocity).any()):
        return errors, corners
    usual = float(np.median(np.diff(readings.time_s)))
    for _ in range(DELAY_ROUNDS):
        before = errors.velocity_delay_s
        delay_s, gain = _likeliest_delay(readings, errors, corners, LONGEST_DELAY * usual)
        if before == 0.0 and gain < DELAY_GAIN:
            break
        if abs(delay_s - before) < DELAY_SETTLED * usual:
            break
        delayed = replace(errors, velocity_delay_s=delay_s)
        errors, corners = readings.estimated(delayed, corners, PASSES)
    return errors, corners


def _likeliest_delay(
    readings: Readings, errors: ReadingErrors, corners: Array, longest_s: float
) -> tuple[float, float]:
    """Maximum-likelihood delay of the velocity, s, and its log-likelihood gain."""
    from scipy.optimize import minimize_scalar

    speed = readings.smoothed(errors, corners, readings.first_speed()).mean[:, 1]

    def cost(delay_s: float) -> float:
        tried = replace(errors, velocity_delay_s=delay_s)
        # A variance that was estimated without a delay includes the error from it.
        least = replace(
            tried, velocity_variance=max(HIDDEN * errors.velocity_variance, readings.velocity_floor)
        )
        return -max(readings.log_likelihood(e, corners, speed) for e in (tried, least))

    found = minimize_scalar(cost, bounds=(-longest_s, longest_s), method="bounded")
    return float(found.x), cost(errors.velocity_delay_s) - float(found.fun)


def _located_to_a_step(corners: Array) -> Array:
    """Factors of the noise intensity with each corner extended to the adjacent steps.

    The expectation for one step neglects that a corner in an adjacent step has nearly the same
    likelihood. Without the extension, the standard error of the acceleration at the sample between
    the two steps is too small.
    """
    padded = np.pad(corners, 1, mode="edge")
    found: Array = np.maximum(np.maximum(padded[:-2], padded[2:]), corners)
    return found
