"""Generalised least squares that accounts for errors of the estimated motion.

The covariance of the residuals follows from the errors of the motion (`errors_in_motion`). The
noise, the scale of these errors and a common delay of the force are estimated with the model.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt
from scipy import optimize

from jbf.estimation.delays import common_delay_step, delay_slope
from jbf.estimation.errors_in_motion import ErrorsInMotion
from jbf.estimation.noise import WHITE
from jbf.estimation.parallel_fits import fits_at_once, in_parallel
from jbf.estimation.posterior_motions import (
    corrected_delay_s,
    delayed,
    moved,
    posteriors,
    rougher,
    with_corners_of_forces,
    with_posteriors,
)
from jbf.estimation.prepared import coasting
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
RATIOS = 9
"""Number of ratios of error scale and noise from which a search starts. It bounds a search only."""
RATIO_STEP = 0.01
"""Tolerance of the logarithm of the ratio of error scale and noise. It is a numerical tolerance."""
MOST_SCALE = 3.0
"""Largest logarithm of the error scale, and minus the smallest. It bounds a search only."""
MOST_NOISE = 0.5
"""Logarithm of the largest noise, relative to the residual. It bounds a search only."""
EXACT_RECORD = 1e-12
"""Smallest residual relative to the largest force. It is a numerical tolerance."""
LEAST_NOISE = -7.0
"""Logarithm of the smallest noise, relative to the residual. It bounds a search only."""
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

    def iterated(clock_s: float, *, delays: bool = True) -> _ClockFit:
        """Fit with the force on one clock."""
        return _iterated(problem, solution, clock_s, delays=delays)

    at_once = fits_at_once(problem.campaign, problem.law, problem.effects)
    ends = list(in_parallel(iterated, clocks, at_once))
    # Steps in the delay may increase the deviance: fit again without them.
    late = [c for c, end in zip(clocks, ends, strict=True) if end.delayed]
    ends += in_parallel(lambda clock_s: iterated(clock_s, delays=False), late, at_once)
    best = min(ends, key=lambda end: end.deviance) if len(ends) > 1 else ends[0]
    best = _with_corners_of_forces(problem, best)
    motion = best.solution.samples.motion
    if motion is None:
        return best.problem, best.solution
    # Keep the fit without errors of the motion if that with small ones has a much larger RMS.
    settings = problem.campaign.settings
    share = motion.mean_share(best.solution.samples.weight)
    large = share > settings.conditions.max_motion_share
    if not large and best.solution.rms > settings.noise.max_rms_ratio * plain_fit.rms:
        return plain, plain_fit
    changes, unclear = [_with_smoothing(best)], settings.motion.max_clock_deviance
    for other in ends:
        # The difference between fits of similar likelihood is part of the standard errors.
        if other is not best and other.deviance - best.deviance < unclear:
            values = best.problem.encode(best.solution.values)
            changes.append(best.problem.encode(other.solution.values) - values)
    change = np.sqrt(np.sum(np.square(changes), axis=0))
    return best.problem, replace(best.solution, systematic=change)


def with_recorded_motion(problem: Problem, solution: Solution) -> tuple[Problem, Solution]:
    """Return the problem without corrected delays and without corners located by the forces.

    The errors of the motion of a model with other effects are estimated from it.
    """
    campaign = problem.campaign
    late_s = corrected_delay_s(campaign)
    if late_s != 0.0:
        problem = delayed(problem, -late_s)
    motions = [m and m.with_corners_of(None) for m in posteriors(problem)]
    problem = with_posteriors(problem, motions)
    return problem, _near(problem, solution)


def _with_corners_of_forces(first: Problem, end: _ClockFit) -> _ClockFit:
    """Locate corners (abrupt changes of speed) of the motion by the forces, and refit.

    Parameters
    ----------
    first
        Problem before the correction of a delay.
    """
    motion = end.solution.samples.motion
    least = first.campaign.settings.motion.min_share
    if motion is None or motion.mean_share(end.solution.samples.weight) < least:
        return end
    located = with_corners_of_forces(end.problem, end.solution, motion)
    again = with_posteriors(first, posteriors(located))
    near = _near(again, end.solution)
    return _iterated(again, near, end.clock_s, late_s=end.late_s, delays=end.delayed)


def _near(problem: Problem, solution: Solution) -> Solution:
    """Residuals and Jacobian of a problem at the parameter values of another solution."""
    return problem.solution(solution.values, problem.samples_at(solution.values), WHITE)


@dataclass(frozen=True, eq=False)
class _ClockFit:
    """End of the iteration of a fit with the force on one clock.

    Attributes
    ----------
    first, problem
        The original problem, and the one with the force's delay corrected.
    solution
        The fit.
    delayed
        Whether a delay of the force was estimated.
    clock_s, late_s
        Delay of the clock of the force, and the total delay of the force, s.
    """

    first: Problem
    problem: Problem
    solution: Solution
    delayed: bool
    clock_s: float
    late_s: float

    @cached_property
    def deviance(self) -> float:
        """Minus twice the log likelihood, scaled to the number of samples before the shift."""
        solution = self.solution
        samples = self.first.samples_at(solution.values)
        motion = estimate_motion_errors(self.problem, solution)
        deviance = motion.whitening(solution.samples.weight).deviance(solution.residuals)
        counts = [sum(map(np.count_nonzero, s.weight)) for s in (samples, solution.samples)]
        return deviance * counts[0] / max(counts[1], 1)


def _iterated(
    first: Problem,
    solution: Solution,
    clock_s: float,
    *,
    late_s: float | None = None,
    delays: bool = True,
) -> _ClockFit:
    """Iterate the fit with a delay `clock_s` of the force.

    Parameters
    ----------
    late_s
        Total delay at which the iteration starts, s; by default that of the clock.
    delays
        Whether a significant delay common to all runs is estimated as well.
    """
    problem, settings = first, first.campaign.settings.motion
    late_s = clock_s if late_s is None else late_s
    delays = delays and first.campaign.force_has_clock
    if late_s != 0.0:
        problem = delayed(first, late_s)
        solution = _near(problem, solution)
    for _ in range(ROUNDS):
        motion = estimate_motion_errors(problem, solution)
        share = motion.mean_share(solution.samples.weight)
        if late_s == 0.0 and share < settings.min_delay_share:
            break
        step_s = _delay_step_s(first, problem, solution, motion, late_s, clock_s) if delays else 0.0
        if late_s == step_s == 0.0 and share < settings.min_share:
            break
        if step_s != 0.0:
            late_s += step_s
            problem = delayed(first, late_s)
            solution = _near(problem, solution)
            motion = estimate_motion_errors(problem, solution)
        before, solution = solution, _fitted(problem, solution, motion, delayed=late_s != clock_s)
        changes = [a - b for a, b in zip(before.residuals, solution.residuals, strict=True)]
        if solution.samples.rms(changes) < SETTLED * motion.noise:
            break
    return _ClockFit(first, problem, solution, late_s != clock_s, clock_s, late_s)


def _with_smoothing(end: _ClockFit) -> Array:
    """Change of each search variable if the motion is smoothed less, shape (k,)."""
    problem, solution = end.problem, end.solution
    factor = problem.campaign.settings.motion.roughness_factor
    other = rougher(problem, factor, same_corners=True)
    near = other.solution(solution.values, solution.samples, WHITE)
    near = _fitted(other, near, estimate_motion_errors(other, near), delayed=end.delayed)
    return problem.encode(near.values) - problem.encode(solution.values)


def _likeliest_smoothness(problem: Problem, solution: Solution) -> tuple[Problem, Solution]:
    """Choose the noise intensity of the motion's process that maximises the likelihood, and refit.

    The force contains more information on the acceleration than the positions do.
    """
    if not problem.campaign.force_has_clock:
        return problem, solution
    settings = problem.campaign.settings
    motion = estimate_motion_errors(problem, solution)
    if motion.mean_share(solution.samples.weight) < settings.motion.min_share:
        return problem, solution
    samples = solution.samples

    def fitted_with(tried: Problem) -> tuple[float, Solution]:
        """Deviance and solution of the fit to a problem."""
        near = tried.solution(solution.values, samples, WHITE)
        fitted = _fitted(tried, near, estimate_motion_errors(tried, near))
        errors = estimate_motion_errors(tried, fitted)
        fitted_deviance = _penalised(tried, errors, fitted.residuals, samples.weight)
        return fitted_deviance, replace(fitted, samples=samples)

    first, factor = problem, 1.0
    least, _ = fitted_with(problem)
    for change in (1.0 / INTENSITY_STEP, INTENSITY_STEP):
        while LEAST_INTENSITY < factor * change < 1.0 / LEAST_INTENSITY:
            tried = rougher(first, factor * change)
            deviance, refitted = fitted_with(tried)
            if deviance >= least - settings.motion.min_smoothness_gain:
                break
            least, problem, solution, factor = deviance, tried, refitted, factor * change
        if factor != 1.0:
            break
    return problem, solution


def estimate_motion_errors(problem: Problem, solution: Solution) -> ErrorsInMotion:
    """Estimate sensitivities at a solution, the noise, and the scale of the motion's errors.

    Noise and scale maximise the likelihood. The scale corrects the standard errors of the smoother,
    which are too large if the motion is smoother than the assumed noise process. The logarithm of
    the scale has a normal prior, so that the scale is 1 if the motion's errors are negligible.
    """
    prepared = problem.campaign.prepared
    predicted = [p.friction - r for p, r in zip(prepared, solution.residuals, strict=True)]
    sensitivity = [np.zeros((len(f), 3)) for f in predicted]
    for axis in range(3):
        changed, steps = zip(*(moved(p, axis) for p in prepared), strict=True)
        other = problem.chain.predict(solution.values, [p.core for p in changed])
        for derivatives, before, after, step in zip(
            sensitivity, predicted, other, steps, strict=True
        ):
            derivatives[:, axis] = np.divide(
                after - before, step, where=step > 0.0, out=derivatives[:, axis]
            )
    mass = coasting(problem.campaign.rig)
    if mass is not None:
        # The force is derived from the deceleration and contains the errors of the acceleration.
        for derivatives in sensitivity:
            derivatives[:, 2] += mass
    weights = solution.samples.weight
    errors = tuple(p.motion.errors for p in prepared)
    motion = ErrorsInMotion(errors, tuple(sensitivity), 1.0)
    largest = max(float(np.max(np.abs(f), initial=0.0)) for f in predicted)
    most = max(solution.samples.rms(solution.residuals), EXACT_RECORD * largest, 1e-150)
    settings = problem.campaign.settings.motion
    smallest = settings.min_noise_share * solution.samples.rms(predicted)
    lowest = float(np.clip(np.log(max(smallest, 1e-150) / most), LEAST_NOISE, 0.0))
    count = sum(int(np.count_nonzero(w)) for w in weights)

    def at(log_ratio: float, log_noise: float) -> ErrorsInMotion:
        """Errors of the motion with the logarithms of scale / noise and of noise / RMS."""
        scale = float(np.exp(log_ratio + log_noise))
        return replace(motion, noise=most * float(np.exp(log_noise)), scale=scale)

    def profiled(log_ratio: float) -> tuple[float, float]:
        """Smallest penalised deviance for a logarithm of scale / noise, and that of noise / RMS.

        The filter depends on the ratio only, and the deviance is convex in the logarithm of the
        noise.
        """
        unit = at(log_ratio, 0.0).whitening(weights)
        squares = unit.deviance(solution.residuals) - unit.log_determinant

        def penalised(log_noise: float) -> float:
            """Penalised deviance at the logarithm of noise / RMS."""
            deviance = squares * float(np.exp(-2.0 * log_noise)) + 2.0 * count * log_noise
            return deviance + unit.log_determinant + _prior(problem, log_ratio + log_noise)

        bounds = max(lowest, -MOST_SCALE - log_ratio), min(MOST_NOISE, MOST_SCALE - log_ratio)
        found = optimize.minimize_scalar(penalised, bounds=bounds, method="bounded")
        return float(found.fun), float(found.x)

    # A second minimum exists at low noise, where the motion's errors explain the whole residual.
    log_ratios = np.linspace(-MOST_SCALE - MOST_NOISE, MOST_SCALE - lowest, RATIOS + 2)
    least = 1 + int(np.argmin([profiled(log_ratio)[0] for log_ratio in log_ratios[1:-1]]))
    found = optimize.minimize_scalar(
        lambda log_ratio: profiled(log_ratio)[0],
        bounds=(log_ratios[least - 1], log_ratios[least + 1]),
        method="bounded",
        options={"xatol": RATIO_STEP},
    )
    return at(float(found.x), profiled(float(found.x))[1])


def _prior(problem: Problem, log_scale: float) -> float:
    """Minus twice the log prior density of the logarithm of the scale of the motion's errors."""
    return (log_scale / problem.campaign.settings.motion.scale_prior) ** 2


def _penalised(
    problem: Problem,
    motion: ErrorsInMotion,
    residuals: Sequence[Array],
    weights: Sequence[Array],
) -> float:
    """Minus twice the log likelihood, plus the prior of the scale of the motion's errors."""
    deviance = motion.whitening(weights).deviance(residuals)
    return deviance + _prior(problem, float(np.log(motion.scale)))


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


def _delay_step_s(
    first: Problem,
    problem: Problem,
    solution: Solution,
    motion: ErrorsInMotion,
    late_s: float,
    clock_s: float,
) -> float:
    """Additional delay of the forces, s; zero if it is not significant or implausibly large."""
    if TAU in problem.names:
        return 0.0
    white = replace(solution, samples=replace(solution.samples, motion=motion), noise=WHITE)
    step_s, sd_s = common_delay_step(problem, white)
    settings = problem.campaign.settings.motion
    if late_s == clock_s and abs(step_s) < settings.min_delay_sigma * sd_s:
        return 0.0
    most_s = settings.max_delay_samples * min(p.step_s for p in first.campaign.prepared)
    if not np.isfinite(sd_s) or abs(late_s + step_s) > most_s:
        return 0.0
    return step_s if abs(step_s) > SETTLED * sd_s else 0.0
