"""Generalised least squares that accounts for errors of the estimated motion.

The covariance of the residuals is derived from the posterior covariance of the motion
(`errors_in_motion`). The noise, the scale of these errors and a common delay of the force are
estimated jointly with the model.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property

import numpy as np
import numpy.typing as npt
from scipy import optimize

from jbf.estimation.delays import delay_slope
from jbf.estimation.errors_in_motion import ErrorsInMotion
from jbf.estimation.least_squares import unexplained_square
from jbf.estimation.motion_error_scale import estimate_motion_errors, penalised_deviance
from jbf.estimation.noise import WHITE
from jbf.estimation.parallel_fits import fits_at_once, in_parallel
from jbf.estimation.posterior_motions import (
    corrected_delay_s,
    corrected_for_delay,
    posteriors,
    shifted,
    with_corners_located_by_forces,
    with_posteriors,
    with_scaled_intensity,
)
from jbf.estimation.problem import Problem
from jbf.estimation.search import search
from jbf.estimation.solution import Solution
from jbf.models.delayed_reading import TAU

Array = npt.NDArray[np.float64]
ROUNDS = 8
"""Largest number of iterations of sensitivities and fits. It limits the effort only."""
SETTLED = 0.01
"""Change of the prediction, relative to the noise, at which the iteration stops.

It is a numerical tolerance.
"""
EVALUATIONS = 20
"""Evaluations of each fit. It limits the effort only."""
DELAY_STEP = 0.02
"""Tolerance of a delay of the force, in sampling intervals. It is a numerical tolerance."""
DELAY_SPAN = 0.1
"""Half-width of the central difference of the sum of squares with respect to the delay.

It is in sampling intervals, and is a numerical resolution.
"""
INTENSITY_STEP = 3.0
"""Factor on the noise intensity between two motions whose likelihoods are compared.

It is a numerical resolution.
"""
LEAST_INTENSITY = 1e-4
"""Smallest factor on the intensity, and the reciprocal of the largest. It bounds a search only."""


def with_motion_errors(problem: Problem, solution: Solution) -> tuple[Problem, Solution]:
    """Fit by generalised least squares, with the covariance of the motion's errors and a delay.

    Returns the problem, corrected for the delay, and its solution. Both are unchanged if the errors
    of the motion are negligible and the force has no delay. If position and velocity have different
    clocks, the force may have either clock, and both are tried.
    """
    motions = [p.motion.errors for p in problem.campaign.prepared]
    if any(e is None for e in motions):
        return problem, solution
    plain, plain_fit = problem, solution
    problem, solution = _likeliest_smoothness(problem, solution)
    errors = [e for p in problem.campaign.prepared if (e := p.motion.errors) is not None]
    between_s = float(np.median([e.velocity_delay_s for e in errors]))
    clocks = [0.0] if between_s == 0.0 or TAU in problem.names else [0.0, between_s]
    at_once = fits_at_once(problem.campaign, problem.law, problem.effects)
    ends = list(in_parallel(lambda c: _with_likeliest_delay(problem, solution, c), clocks, at_once))
    best = min(ends, key=lambda end: end.deviance) if len(ends) > 1 else ends[0]
    best = _with_corners_located_by_forces(problem, best)
    motion = best.solution.samples.motion
    if motion is None:
        return problem, solution
    # Keep the fit without errors of the motion if that with small ones has a much larger RMS.
    settings = problem.campaign.settings
    share = motion.mean_share(best.solution.samples.weight)
    large = share > settings.conditions.max_motion_share
    if not large and best.solution.rms > settings.noise.max_rms_ratio * plain_fit.rms:
        return plain, plain_fit
    # Changes with less smoothing, with the other clock and without the corners located by forces
    # are systematic errors, the latter two if the likelihood is similar.
    others = [with_less_smoothing(best.problem, best.solution)[1]]
    unclear = settings.motion.max_clock_deviance
    others += [
        other.solution
        for other in ends
        if other is not best and other.deviance - best.deviance < unclear
    ]
    values = best.problem.encode(best.solution.values)
    changes = [best.problem.encode(other.values) - values for other in others]
    change = np.sqrt(np.sum(np.square(changes), axis=0))
    return best.problem, replace(best.solution, systematic=change)


def with_less_smoothing(problem: Problem, solution: Solution) -> tuple[Problem, Solution]:
    """Return the problem with a with_scaled_intensity motion, and its solution.

    The intensity of the process noise is multiplied by `roughness_factor`; weights, corners and the
    projection of a delay are kept. The change of a result measures its smoothing bias.
    """
    factor = problem.campaign.settings.motion.roughness_factor
    problem = with_scaled_intensity(problem, factor, same_corners=True)
    near = problem.solution(solution.values, solution.samples, solution.noise)
    before = solution.samples.motion
    by_delay = None if before is None else before.by_delay
    motion = replace(estimate_motion_errors(problem, near), by_delay=by_delay)
    samples = replace(solution.samples, motion=motion)
    end = search(problem, samples, solution.values, solution.noise, EVALUATIONS)
    values = problem.wrapped(end.values)
    return problem, problem.solution(values, samples, solution.noise, end.converged, end.message)


def without_motion_corrections(problem: Problem, solution: Solution) -> tuple[Problem, Solution]:
    """Return the problem without corrected delays and without corners located by the forces.

    It is the starting point for the errors of the motion of a model with other effects. Readings
    that the correction dropped remain dropped.
    """
    campaign = problem.campaign
    delay_s = corrected_delay_s(campaign)
    if delay_s != 0.0:
        problem = shifted(problem, -delay_s)
    motions = [m and m.with_corners_located_by(None) for m in posteriors(problem)]
    problem = with_posteriors(problem, motions)
    return problem, _near(problem, solution)


def _with_corners_located_by_forces(first: Problem, end: _DelayedFit) -> _DelayedFit:
    """Locate corners (abrupt changes of acceleration) of the motion by the forces, and refit.

    Parameters
    ----------
    first
        Problem before the correction of a delay.
    """
    motion = end.solution.samples.motion
    least = first.campaign.settings.motion.min_share
    if motion is None or motion.variance_share(end.solution.samples.weight) < least:
        return end
    located = with_corners_located_by_forces(end.problem, end.solution, motion)
    again = with_posteriors(first, posteriors(located))
    near = _near(again, end.solution)
    return _iterated(again, near, end.delay_s, delayed=end.delayed)


def _near(problem: Problem, solution: Solution) -> Solution:
    """Residuals and Jacobian of a problem at the parameter values of another solution."""
    return problem.solution(solution.values, problem.samples_at(solution.values), WHITE)


@dataclass(frozen=True, eq=False)
class _DelayedFit:
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
        return self.motion.whitening(weights).deviance(self.solution.residuals)


def _with_likeliest_delay(first: Problem, solution: Solution, clock_s: float) -> _DelayedFit:
    """Fit with the force on one clock, and with a significant delay common to all runs.

    The force of an abrupt motion is not linear in a delay. The search for a delay therefore begins
    at the likeliest of several delays, half a sample apart. The delay is used if it is significant,
    and likelier at the samples of both fits; otherwise the fit on the clock is returned.

    Parameters
    ----------
    clock_s
        Delay of the clock of the force, s.
    """
    on_clock = _iterated(first, solution, clock_s)
    campaign, settings = first.campaign, first.campaign.settings.motion
    share = on_clock.motion.variance_share(on_clock.solution.samples.weight)
    exact = clock_s == 0.0 and share < settings.min_delay_share
    if exact or TAU in first.names or not campaign.force_has_clock:
        return on_clock
    # All delays are compared at the same readings.
    step_s = min(p.step_s for p in campaign.prepared)
    max_delay_s = settings.max_delay_samples * step_s
    readings = first.with_campaign(corrected_for_delay(campaign, 0.0, max_delay_s + step_s))
    fits = [on_clock]
    for tried_s in np.arange(-max_delay_s + 0.25 * step_s, max_delay_s, 0.5 * step_s):
        fits.append(_iterated(readings, fits[-1].solution, float(tried_s), rounds=1))
    likeliest = min(fits[1:], key=lambda fit: fit.deviance)
    delay_s, sd_s = _fixed_point_delay(likeliest, step_s, max_delay_s)
    if abs(delay_s - clock_s) < settings.min_delay_sigma * sd_s:
        return on_clock
    without, delayed = (_iterated(readings, likeliest.solution, s) for s in (clock_s, delay_s))
    used = (fit.solution.samples.weight for fit in (without, delayed))
    weights = [np.minimum(a, b) for a, b in zip(*used, strict=True)]
    if delayed.deviance_at(weights) > without.deviance_at(weights):
        return on_clock
    return _iterated(first, delayed.solution, delay_s, delayed=True)


def _fixed_point_delay(
    start: _DelayedFit, step_s: float, max_delay_s: float
) -> tuple[float, float]:
    """Solve for the delay that is its own generalised least-squares estimate.

    The estimate has the covariance of a fit with this delay. It is the root of the derivative of
    the whitened sum of squares at fixed covariance. The maximum of the likelihood is less accurate:
    the covariance, and with it the likelihood, is discontinuous where a sample crosses a corner of
    the motion.

    Parameters
    ----------
    start
        Fit with the delay at which the search begins.
    step_s
        Sampling interval, s; the delay is at most half of it from that of the start.
    max_delay_s
        Largest absolute delay, s.

    Returns
    -------
    tuple[float, float]
        Delay and its standard error, s. The standard error is infinite if the derivative has no
        root near the start.
    """
    span_s = DELAY_SPAN * step_s

    @cache
    def squares(delay_s: float) -> Array:
        """Sums of squares, relative to the noise variance, for three delays, `span_s` apart."""
        reference = _iterated(start.first, start.solution, delay_s, rounds=1)
        return _squares(reference, delay_s + span_s * np.array([-1.0, 0.0, 1.0]))

    def slope(delay_s: float) -> float:
        """Central difference of the sum of squares."""
        before, _, after = squares(delay_s)
        return float(after - before)

    other_s = start.delay_s + (0.5 if slope(start.delay_s) < 0.0 else -0.5) * step_s
    other_s = min(max(other_s, -max_delay_s), max_delay_s)
    if slope(start.delay_s) * slope(other_s) >= 0.0:
        return start.delay_s, np.inf
    delay_s = float(optimize.brentq(slope, start.delay_s, other_s, xtol=DELAY_STEP * step_s))
    before, at, after = squares(delay_s)
    # The sum of squares rises by one at one standard error.
    curvature = 0.5 * (before + after) - at
    return delay_s, span_s / curvature**0.5 if curvature > 0.0 else np.inf


def _squares(reference: _DelayedFit, delays_s: Array) -> Array:
    """Whitened sums of squares, divided by the noise variance, for several delays of the force.

    Covariance and weights are those of the reference fit. The other parameters are fitted in linear
    approximation. The samples are those that all delays use.
    """
    problem, samples, motion = reference.first, reference.solution.samples, reference.motion
    fits = [_near(shifted(problem, float(delay_s)), reference.solution) for delay_s in delays_s]
    used = samples.within(
        [np.all(c, axis=0) for c in zip(*(f.samples.counted for f in fits), strict=True)]
    )
    whitening = motion.whitening([w * c for w, c in zip(used.weight, used.counted, strict=True)])
    rows = (whitening.stacked(fit.residuals, fit.jacobian) for fit in fits)
    return np.array([unexplained_square(j, r) for r, j in rows]) / motion.noise**2


def _iterated(
    first: Problem,
    solution: Solution,
    delay_s: float,
    *,
    delayed: bool = False,
    rounds: int = ROUNDS,
) -> _DelayedFit:
    """Iterate the fit with a delay `delay_s` of the force.

    Parameters
    ----------
    delayed
        Whether the delay was estimated, and is uncertain.
    rounds
        Largest number of iterations.
    """
    settings = first.campaign.settings.motion
    problem = shifted(first, delay_s) if delay_s != 0.0 else first
    solution = _near(problem, solution)
    for _ in range(rounds):
        motion = estimate_motion_errors(problem, solution)
        if delay_s == 0.0 and motion.variance_share(solution.samples.weight) < settings.min_share:
            break
        before, solution = solution, _fitted(problem, solution, motion, delayed=delayed)
        changes = [a - b for a, b in zip(before.residuals, solution.residuals, strict=True)]
        if solution.samples.rms(changes) < SETTLED * motion.noise:
            break
    return _DelayedFit(first, problem, solution, delay_s, delayed)


def _likeliest_smoothness(problem: Problem, solution: Solution) -> tuple[Problem, Solution]:
    """Choose the noise intensity of the motion's process that maximises the likelihood, and refit.

    The force contains more information on the acceleration than the positions do.
    """
    if not problem.campaign.force_has_clock:
        return problem, solution
    settings = problem.campaign.settings
    motion = estimate_motion_errors(problem, solution)
    if motion.variance_share(solution.samples.weight) < settings.motion.min_share:
        return problem, solution
    samples = solution.samples

    def fitted_with(tried: Problem) -> tuple[float, Solution]:
        """Deviance and solution of the fit to a problem."""
        near = tried.solution(solution.values, samples, WHITE)
        fitted = _fitted(tried, near, estimate_motion_errors(tried, near))
        errors = estimate_motion_errors(tried, fitted)
        fitted_deviance = penalised_deviance(tried, errors, fitted.residuals, samples.weight)
        return fitted_deviance, replace(fitted, samples=samples)

    first, factor = problem, 1.0
    least, _ = fitted_with(problem)
    for change in (1.0 / INTENSITY_STEP, INTENSITY_STEP):
        while LEAST_INTENSITY < factor * change < 1.0 / LEAST_INTENSITY:
            tried = with_scaled_intensity(first, factor * change)
            deviance, refitted = fitted_with(tried)
            if deviance >= least - settings.motion.min_smoothness_gain:
                break
            least, problem, solution, factor = deviance, tried, refitted, factor * change
        if factor != 1.0:
            break
    return problem, solution


def _fitted(
    problem: Problem, near: Solution, motion: ErrorsInMotion, *, delayed: bool = False
) -> Solution:
    """Generalised least-squares fit near a solution, with Huber weights."""
    prepared, values = problem.campaign.prepared, near.values
    if delayed:
        slopes = tuple(delay_slope(problem, values, p) for p in prepared)
        motion = replace(motion, by_delay=slopes)
    plain, weights = problem.samples_at(values), []
    huber = problem.campaign.settings.motion.huber_sigma
    for i, (residual, weight) in enumerate(zip(near.residuals, plain.weight, strict=True)):
        sd = motion.noise * np.sqrt(1.0 + motion.variance_ratio(i))
        ratio = np.maximum(np.abs(residual) / sd, 1e-300)
        weights.append(weight * np.sqrt(np.minimum(1.0, huber / ratio)))
    samples = replace(plain, weight=tuple(weights), motion=motion)
    end = search(problem, samples, values, WHITE, EVALUATIONS)
    values = problem.wrapped(end.values)
    return problem.solution(values, samples, WHITE, end.converged, end.message)
