"""Errors of the readings of a motion by maximum likelihood.

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

from jbf.arrays import Array
from jbf.records.motion.readings import AT_REST, ReadingErrors, Readings
from jbf.records.motion.roughness import noise_of

JERK, SNAP = 3, 4
"""Order of the derivative of the position that is noise."""
CHOSEN, LONGEST = 3_000, 8_000
"""Length of the segments with the most motion, samples.

In a longer record, the start, the order and the clock are chosen from the first length, and the
parameters are estimated from the second.
"""
PASSES = (6, 24)
"""Iterations of expectation-maximisation: with normal noise, then with Student-t noise.

More iterations with Student-t noise reduce the intensity between corners further, and the standard
errors of the motion become too small.
"""
TRIED = (3, 12)
"""Iterations of both kinds after which the order (`JERK` or `SNAP`) is chosen.

With fewer passes, the order for a position loop with stick-slip is uncertain.
"""
SNAP_GAIN = 0.02
"""Minimum gain in the lower bound, per sample, for a random snap, which smooths corners."""
LONG_PASSES = 12
"""Iterations in which corners are estimated at known errors of the readings."""
GRID, SMOOTHEST = 2.0 * np.log(10.0), 16
"""Step of the logarithm of the intensity in a first search, and the largest number of steps."""
FLAT = 0.5
"""Log-likelihood gain in two steps of the first search below which it ends."""
NARROW = 2.0
"""Search range around a known noise intensity, decades."""
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
CHANNEL_GAIN = 0.15
"""Gain in the lower bound of the positions, per sample, from which the velocity contradicts them.

The gain is that of an intensity that is estimated from the positions alone.
"""
STAMP_GAIN = 10.0
"""Minimum log-likelihood gain of an error of the instants."""
LONGEST_DELAY = 1.5
"""Largest delay of the velocity that is searched, samples."""


def is_even(readings: Readings, even_s: Array) -> bool:
    """Whether an even clock has a higher likelihood than the recorded time stamps.

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


def estimate_errors(
    readings: Readings, starts: Sequence[ReadingErrors] = ()
) -> tuple[ReadingErrors, Array]:
    """Estimate the errors of the readings, and the factors of the noise intensity.

    Parameters
    ----------
    starts
        Additional starting values. The solution with the largest lower bound is used, if it gains
        at least `START_GAIN`.
    """
    start = _of_likeliest_order(readings.part(_longest_path_window(readings, CHOSEN)))
    few = readings.part(_longest_path_window(readings, LONGEST))
    by_positions = _of_positions(readings, start.order)
    errors, corners = _consistent(few, start, by_positions)
    if starts:
        most = few.lower_bound(errors, corners) + START_GAIN
        for end in (_consistent(few, tried, by_positions) for tried in starts):
            if (bound := few.lower_bound(*end)) > most:
                (errors, corners), most = end, bound
    if len(readings.time_s) > len(few.time_s):
        corners = readings.corners(errors, LONG_PASSES)
    return errors, corners


@dataclass(frozen=True, eq=False)
class _OfPositions:
    """Reading errors estimated from the positions alone, for a part of a record.

    Attributes
    ----------
    readings
        The positions.
    errors
        Their estimated errors.
    bound
        Lower bound of their log-likelihood.
    """

    readings: Readings
    errors: ReadingErrors
    bound: float


def _of_positions(readings: Readings, order: int) -> _OfPositions | None:
    """Estimate reading errors from the positions alone; None if only one channel was recorded.

    Parameters
    ----------
    order
        Order of the derivative that is noise.
    """
    if not _both_read(readings):
        return None
    few = readings.part(_longest_path_window(readings, CHOSEN)).positions()
    start, _ = _likeliest_stamps(few)
    start, _ = _likeliest_intensity(few, replace(start, order=order))
    errors, _ = few.estimated(start, np.ones(len(few.time_s) - 1), PASSES)
    return _OfPositions(few, errors, _bound_of(few, errors))


def _bound_of(readings: Readings, errors: ReadingErrors) -> float:
    """Lower bound of the log-likelihood at given errors, with corners estimated for them."""
    return readings.lower_bound(errors, readings.corners(errors, LONG_PASSES))


def _consistent(
    readings: Readings, start: ReadingErrors, by_positions: _OfPositions | None
) -> tuple[ReadingErrors, Array]:
    """Reading errors and corners whose noise intensity is consistent with the positions.

    The velocity of a drive may have errors that are not white noise, such as filtered counts. They
    would be taken for a rough motion. The intensity is then that of the positions alone.
    """
    errors, corners = _delayed(readings, start)
    if by_positions is None or by_positions.errors.order != errors.order:
        return errors, corners
    gain = by_positions.bound - _bound_of(by_positions.readings, errors)
    if gain < CHANNEL_GAIN * len(by_positions.readings.time_s):
        return errors, corners
    tried = replace(start, intensity=by_positions.errors.intensity)
    return _delayed(readings, tried, known_intensity=True)


def _both_read(readings: Readings) -> bool:
    """Whether both position and velocity were measured."""
    velocity = np.isfinite(readings.velocity) & (readings.velocity_shape > AT_REST)
    return bool(np.isfinite(readings.position).any() and velocity.any())


def _likeliest_start(readings: Readings) -> tuple[ReadingErrors, float]:
    """Starting values of the reading errors, and their log-likelihood.

    The variances follow from the roughness of the readings, a median over all samples. If the
    machine is mostly at rest, the variance of the readings in motion is larger. Larger variances of
    the velocity are therefore tried as well, and the most likely starting values are returned.
    """
    start = starting_errors(readings)
    tried = [
        _likeliest_intensity(
            readings, replace(start, velocity_variance=factor**2 * start.velocity_variance)
        )
        for factor in (START_FACTORS if np.isfinite(readings.velocity).any() else (1.0,))
    ]
    return max(tried, key=lambda found: found[1])


def starting_errors(readings: Readings) -> ReadingErrors:
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
        """Negative log-likelihood at the logarithm of the intensity."""
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
    """Most likely reading errors, with or without time-stamp jitter, and their log-likelihood."""
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
    """Slice of at most `longest` samples with the longest path."""
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


def _delayed(
    readings: Readings, start: ReadingErrors, *, known_intensity: bool = False
) -> tuple[ReadingErrors, Array]:
    """Reading errors and corners with the maximum-likelihood delay of the velocity."""
    ones = np.ones(len(readings.time_s) - 1)
    errors, corners = readings.estimated(start, ones, PASSES, known_intensity=known_intensity)
    if not _both_read(readings):
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
        errors, corners = readings.estimated(
            delayed, corners, PASSES, known_intensity=known_intensity
        )
    return errors, corners


def _likeliest_delay(
    readings: Readings, errors: ReadingErrors, corners: Array, longest_s: float
) -> tuple[float, float]:
    """Maximum-likelihood delay of the velocity, s, and its log-likelihood gain."""
    from scipy.optimize import minimize_scalar

    speed = readings.smoothed(errors, corners, readings.first_speed()).mean[:, 1]

    def cost(delay_s: float) -> float:
        """Negative log-likelihood at a delay, s."""
        tried = replace(errors, velocity_delay_s=delay_s)
        # A variance that was estimated without a delay includes the error from it.
        least = replace(
            tried, velocity_variance=max(HIDDEN * errors.velocity_variance, readings.velocity_floor)
        )
        return -max(readings.log_likelihood(e, corners, speed) for e in (tried, least))

    found = minimize_scalar(cost, bounds=(-longest_s, longest_s), method="bounded")
    return float(found.x), cost(errors.velocity_delay_s) - float(found.fun)
