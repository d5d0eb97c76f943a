"""Generalised least-squares fits with a given or an estimated delay of the force.

A force may be recorded with a delay common to all runs, or on the clock of either channel
of the motion. The errors of the motion are estimated with each delay.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from operator import attrgetter

import numpy as np

from jbf.arrays import Array
from jbf.estimation.delays import delay_slope
from jbf.estimation.errors_in_motion import ErrorsInMotion
from jbf.estimation.least_squares import triangular, unexplained_square
from jbf.estimation.minimum import huber
from jbf.estimation.noise import WHITE
from jbf.estimation.parallel_fits import fits_at_once, in_parallel
from jbf.estimation.posterior_motions import corrected_for_delay, estimate_motion_errors, shifted
from jbf.estimation.problem import Problem
from jbf.estimation.search import NEAR_MINIMUM, search_solution
from jbf.estimation.solution import Solution
from jbf.models.delayed_reading import TAU

ROUNDS = 8
"""Largest number of iterations of sensitivities and fits."""
SETTLED = 0.01
"""Change of the prediction, relative to the noise, at which the iteration stops."""
EVALUATIONS = 20
"""Evaluations of each fit."""
DELAY_TOLERANCE = 0.02
"""Tolerance of a delay of the force, in sampling intervals."""
SETTLED_DELAY = 0.2
"""Tolerance of a delay of the force, in its standard errors; the larger tolerance is used."""
MAX_DELAY_ITERATIONS = 12
"""Largest number of Gauss-Newton iterations of the search for a delay."""
MAX_DELAY_CHANGE = 2.0
"""Largest difference of a delay from the start of its search, in sampling intervals."""
DELAY_SPAN = 0.1
"""Half-width of the central difference with respect to the delay, in sampling intervals."""


@dataclass(frozen=True, eq=False)
class DelayedFit:
    """Fit with a given delay of the force.

    Attributes
    ----------
    first, problem
        The original problem, and the one with the force's delay corrected.
    solution
        The fit.
    delay_s
        Delay of the force, s.
    delayed
        Whether the delay was estimated.
    """

    first: Problem
    problem: Problem
    solution: Solution
    delay_s: float
    delayed: bool

    @cached_property
    def motion(self) -> ErrorsInMotion:
        """Errors of the motion with which the solution was fitted, or estimated without them."""
        motion = self.solution.samples.motion
        return motion or estimate_motion_errors(self.problem, self.solution)

    @cached_property
    def deviance(self) -> float:
        """Minus twice the log likelihood, up to a constant, for all samples before the shift.

        A shift drops readings: the deviance per sample is multiplied by the number before it.
        """
        samples = self.first.samples_at(self.solution.values)
        counts = [sum(map(np.count_nonzero, s.weight)) for s in (samples, self.solution.samples)]
        return self.deviance_at(self.solution.samples.weight) * counts[0] / max(counts[1], 1)

    def deviance_at(self, weights: Sequence[Array]) -> float:
        """Minus twice the log likelihood of the samples with these weights, one array per run."""
        samples = replace(self.solution.samples, weight=tuple(weights), motion=self.motion)
        return samples.deviance(self.solution.residuals)


def fits_on_clocks(
    first: Problem, solution: Solution, clocks_s: Sequence[float]
) -> list[DelayedFit]:
    """Fit with the force on each clock, or with a significant delay common to all runs instead.

    `clocks_s` has the delay of each possible clock of the force. The common delay must be
    significant. Its deviance must be smaller by the square of `min_delay_sigma` than that of the
    delay that is as far from the clock in the other direction, without a much larger RMS. The clock
    itself is not compared: the motion is smoother between its readings than at them, so that a
    delay of half a sampling interval may be likelier than none.
    """
    at_once = fits_at_once(first.campaign, first.law, first.effects)
    fits = list(in_parallel(lambda c: fit_with_delay(first, solution, c), clocks_s, at_once))
    settings = first.campaign.settings.motion
    if TAU in first.names or not first.campaign.force_has_clock:
        return fits
    # Without the delay, the residual may be many times the noise, and the inertia wrong.
    start = _likeliest_delay(first.thinned, fits[0].solution, at_once)
    share = start.motion.variance_share(start.solution.samples.weight)
    tested = [
        k for k, fit in enumerate(fits) if fit.delay_s != 0.0 or share >= settings.min_delay_share
    ]
    if not tested:
        return fits
    if first.thinned is not first:
        (start,) = _fits_at_same_readings(first, fits[0].solution, [start.delay_s], at_once)
    delay_s, sd_s = _fixed_point_delay(start)
    tested = [k for k in tested if abs(delay_s - clocks_s[k]) >= settings.min_delay_sigma * sd_s]
    if not tested:
        return fits
    end = fit_with_delay(first, start.solution, delay_s, delayed=True)
    for k in tested:
        compared_s = [delay_s, 2.0 * clocks_s[k] - delay_s]
        delayed, opposite = _fits_at_same_readings(first, end.solution, compared_s, at_once)
        used = (fit.solution.samples.weight for fit in (opposite, delayed))
        weights = [np.minimum(a, b) for a, b in zip(*used, strict=True)]
        gain = opposite.deviance_at(weights) - delayed.deviance_at(weights)
        explains = delayed.solution.rms <= settings.max_rms_ratio * opposite.solution.rms
        if explains and gain >= settings.min_delay_sigma**2:
            fits[k] = end
    return fits


def likeliest(fits: Iterable[DelayedFit]) -> DelayedFit:
    """Return the likeliest of the fits with an RMS of at most `max_rms_ratio` times the smallest.

    With a wrong delay or motion, the scale of the motion's errors may increase so far that they
    explain the residual better than a smaller noise does.
    """
    fits = list(fits)
    smallest = min(fit.solution.rms for fit in fits)
    most = fits[0].first.campaign.settings.motion.max_rms_ratio * smallest
    return min((fit for fit in fits if fit.solution.rms <= most), key=attrgetter("deviance"))


def _delays_at_minima_s(problem: Problem, solution: Solution) -> list[float]:
    """Delays at the smallest local minima of the sum of squares, s; at most `max_delay_minima`.

    The delays are half a sampling interval apart, and the sum has the same readings for all of
    them. The ends of the range are not counted, since the sum may decrease beyond them. The other
    parameters are fitted in linear approximation: prediction and Jacobian are interpolated at the
    delayed instants. If the sampling is uniform, these are a quarter of an interval from a sample,
    so that the interpolation smooths all of them equally.
    """
    settings, step_s = problem.campaign.settings, _shortest_step_s(problem)
    near, runs = near_solution(problem, solution), problem.campaign.prepared
    longest_s = min(
        settings.motion.delay_range_samples * step_s,
        settings.delays.max_run_share * min(p.run.duration_s for p in runs),
    )
    parts = []
    for p, residual, jacobian, weight in zip(
        runs, near.residuals, near.jacobian, near.samples.weight, strict=True
    ):
        time_s = p.run.time_s
        used = (time_s >= time_s[0] + longest_s) & (time_s <= time_s[-1] - longest_s)
        used &= weight > 0.0
        columns = np.column_stack([p.friction - residual, jacobian])
        parts.append((time_s, columns, time_s[used], p.friction[used], weight[used]))

    def square(delay_s: float) -> float:
        """Sum of squares at a delay of the force, s."""
        residuals, slopes = [], []
        for time_s, columns, used_s, force, weight in parts:
            rows = _interpolated(used_s - delay_s, time_s, columns)
            reduced = triangular(weight * (rows[:, 0] - force), weight[:, None] * rows[:, 1:])
            residuals.append(reduced[0])
            slopes.append(reduced[1])
        return unexplained_square(np.concatenate(slopes), np.concatenate(residuals))

    count = int(longest_s / (0.5 * step_s))
    delays_s = step_s * (0.5 * np.arange(-count, count) + 0.25)
    squares = np.array([square(float(delay_s)) for delay_s in delays_s])
    around = np.pad(squares, 1, constant_values=-np.inf)
    minima = np.flatnonzero((squares <= around[:-2]) & (squares < around[2:]))
    smallest = minima[np.argsort(squares[minima])][: settings.motion.max_delay_minima]
    return [float(delays_s[k]) for k in smallest]


def _interpolated(instants_s: Array, time_s: Array, columns: Array) -> Array:
    """Interpolate the columns of a table linearly from the times `time_s` to other instants."""
    place = np.interp(instants_s, time_s, np.arange(len(time_s), dtype=float))
    before = np.minimum(place.astype(np.intp), len(time_s) - 2)
    share = (place - before)[:, None]
    interpolated: Array = (1.0 - share) * columns[before] + share * columns[before + 1]
    return interpolated


def _likeliest_delay(first: Problem, solution: Solution, at_once: int) -> DelayedFit:
    """Return the likeliest of several delays of the force.

    The force of an abrupt motion is not linear in a delay, so that several are tried: those with a
    local minimum of the sum of squares, two next to zero, and two next to the likeliest of these.
    Selected runs suffice for that (`Problem.thinned`).
    """
    step_s = _shortest_step_s(first)
    near_zero_s = [-0.25 * step_s, 0.25 * step_s]
    tried_s = sorted({*near_zero_s, *_delays_at_minima_s(first, solution)})
    best = likeliest(_fits_at_same_readings(first, solution, tried_s, at_once))
    tried_s = [best.delay_s + k * step_s for k in (-0.5, 0.0, 0.5)]
    return likeliest(_fits_at_same_readings(first, best.solution, tried_s, at_once))


def _fits_at_same_readings(
    first: Problem, solution: Solution, delays_s: Sequence[float], at_once: int
) -> list[DelayedFit]:
    """Fits with each of several delays, without the readings that any of them drops.

    A few more readings are dropped at each end, for a search from the result.
    """
    beyond_s = (MAX_DELAY_CHANGE + 1.0) * _shortest_step_s(first)
    margin_s = float(np.max(np.abs(delays_s))) + beyond_s
    readings = first.with_campaign(corrected_for_delay(first.campaign, 0.0, margin_s))
    fits = in_parallel(
        lambda delay_s: fit_with_delay(readings, solution, delay_s, rounds=1),
        delays_s,
        at_once,
    )
    return list(fits)


def _shortest_step_s(problem: Problem) -> float:
    """Shortest sampling interval of all runs, s."""
    return min(p.step_s for p in problem.campaign.prepared)


def _fixed_point_delay(start: DelayedFit) -> tuple[float, float]:
    """Delay that is its own generalised least-squares estimate, and its standard error, s.

    The covariance of the residual depends on the delay. The whitened sum of squares, with the
    covariance of this delay held fixed, is stationary at the result. The maximum of the likelihood
    is less accurate: the covariance, and with it the likelihood, is discontinuous where a sample
    crosses a corner of the motion.

    The Gauss-Newton method starts at the delay of the fit `start`, and estimates the covariance
    again after each change. A change is at most half a sampling interval, and is halved if it
    reverses the direction of the last one. If the delay does not converge, or if the residuals do
    not depend on it, the standard error is infinite.
    """
    step_s = _shortest_step_s(start.first)
    delay_s, reference, last_s = start.delay_s, start, 0.0
    for _ in range(MAX_DELAY_ITERATIONS):
        change_s, sd_s = _gauss_newton_change(reference, delay_s, DELAY_SPAN * step_s)
        settled = abs(change_s) < max(DELAY_TOLERANCE * step_s, SETTLED_DELAY * sd_s)
        change_s = float(np.clip(change_s, -0.5 * step_s, 0.5 * step_s))
        if change_s * last_s < 0.0:
            change_s *= 0.5
        delay_s, last_s = delay_s + change_s, change_s
        if abs(delay_s - start.delay_s) > MAX_DELAY_CHANGE * step_s:
            break
        if settled:
            return delay_s, sd_s
        reference = fit_with_delay(start.first, start.solution, delay_s, rounds=1)
    return start.delay_s, np.inf


def _gauss_newton_change(
    reference: DelayedFit, delay_s: float, span_s: float
) -> tuple[float, float]:
    """Gauss-Newton change of a delay of the force, and the standard error of the delay, s.

    Covariance and weights are those of the reference fit. The residuals are differentiated by a
    central difference of half-width `span_s`, at the samples that both delays use. The other
    parameters are fitted in linear approximation.
    """
    problem, samples, motion = reference.first, reference.solution.samples, reference.motion
    fits = [
        near_solution(shifted(problem, delay_s + change_s), reference.solution)
        for change_s in (-span_s, span_s)
    ]
    used = samples.within(
        [np.all(c, axis=0) for c in zip(*(f.samples.counted for f in fits), strict=True)]
    )
    used = replace(used.counted_only(), motion=motion)
    (before, j_before), (after, j_after) = (
        used.stacked(fit.residuals, fit.jacobian, WHITE) for fit in fits
    )
    # Half of the gradient of the sum of squares, and its curvature, in units of `span_s`.
    slope = 0.25 * (unexplained_square(j_after, after) - unexplained_square(j_before, before))
    curvature = unexplained_square(0.5 * (j_before + j_after), 0.5 * (after - before))
    if curvature <= 0.0:
        return 0.0, np.inf
    return -slope / curvature * span_s, span_s * motion.noise / curvature**0.5


def fit_with_delay(
    first: Problem,
    solution: Solution,
    delay_s: float,
    *,
    delayed: bool = False,
    rounds: int = ROUNDS,
) -> DelayedFit:
    """Iterate the fit with a delay `delay_s` of the force, at most `rounds` times.

    `delayed` states whether the delay was estimated, and is uncertain.
    """
    settings = first.campaign.settings.motion
    problem = shifted(first, delay_s) if delay_s != 0.0 else first
    solution = near_solution(problem, solution)
    for _ in range(rounds):
        motion = estimate_motion_errors(problem, solution)
        if delay_s == 0.0 and motion.variance_share(solution.samples.weight) < settings.min_share:
            break
        before, solution = solution, fit_with_errors(problem, solution, motion, delayed=delayed)
        changes = [a - b for a, b in zip(before.residuals, solution.residuals, strict=True)]
        if solution.samples.rms(changes) < SETTLED * motion.noise:
            break
    return DelayedFit(first, problem, solution, delay_s, delayed)


def near_solution(problem: Problem, solution: Solution) -> Solution:
    """Residuals and Jacobian of a problem at the parameter values of another solution."""
    values, lines = solution.values, None
    if problem.fits_in_memory:
        lines = problem.linearise(values)
    samples = problem.samples_at(values, None if lines is None else lines[0])
    return problem.solution(values, samples, WHITE, lines=lines)


def fit_with_errors(
    problem: Problem, near: Solution, motion: ErrorsInMotion, *, delayed: bool = False
) -> Solution:
    """Generalised least-squares fit near a solution, with Huber weights."""
    prepared, values = problem.campaign.prepared, near.values
    if delayed:
        slopes = tuple(delay_slope(problem, values, p) for p in prepared)
        motion = replace(motion, by_delay=slopes)
    plain, weights = problem.samples_at(values, near.residuals), []
    tuning = problem.campaign.settings.motion.huber_sigma
    for i, (residual, weight) in enumerate(zip(near.residuals, plain.weight, strict=True)):
        sd = motion.noise * np.sqrt(1.0 + motion.variance_ratio(i))
        weights.append(weight * huber(np.abs(residual) / sd, tuning))
    samples = replace(plain, weight=tuple(weights), motion=motion)
    return search_solution(problem, samples, values, WHITE, EVALUATIONS, NEAR_MINIMUM, near.lines)
