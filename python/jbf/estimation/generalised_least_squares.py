"""Generalised least squares that accounts for errors of the estimated motion.

The covariance of the residuals is derived from the posterior covariance of the motion
(`errors_in_motion`). The noise, the scale of these errors and a common delay of the force are
estimated jointly with the model.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from jbf.errors import Unfinished
from jbf.estimation.approach import approach
from jbf.estimation.delayed_fits import (
    EVALUATIONS,
    ROUNDS,
    DelayedFit,
    fit_with_delay,
    fit_with_errors,
    fits_on_clocks,
    likeliest,
    near_solution,
)
from jbf.estimation.likelihood import likelihood_gain, log_likelihood
from jbf.estimation.minimum import (
    MAX_EVALUATIONS,
    best_weighting,
    minimum,
    not_above_nested,
    polish,
    settle,
)
from jbf.estimation.noise import WHITE
from jbf.estimation.parallel_fits import fits_at_once, in_parallel
from jbf.estimation.posterior_motions import (
    corrected_delay_s,
    estimate_motion_errors,
    posteriors,
    shifted,
    with_corners_located_by_forces,
    with_posteriors,
    with_scaled_intensity,
)
from jbf.estimation.problem import Problem
from jbf.estimation.search import NEAR_MINIMUM, search_solution
from jbf.estimation.solution import Solution
from jbf.estimation.transients import without_further_transients
from jbf.estimation.uncertain_samples import has_state_erased_by_sliding
from jbf.models.catalogue import find_law
from jbf.models.delayed_reading import TAU

INTENSITY_STEP = 3.0
"""Factor on the noise intensity between two motions whose likelihoods are compared."""
LEAST_INTENSITY = 1e-4
"""Smallest factor on the intensity, and the reciprocal of the largest."""


def stages_of_fit(
    problem: Problem, given: Mapping[str, float]
) -> Iterator[tuple[Problem, Solution]]:
    """Fit a model in stages, and yield the problem and its solution after each stage.

    The stages are ordinary least squares, the errors of the motion with a common delay of the
    force, the exclusion of samples with an unknown initial state, and robust weights. `given` has
    starting values.
    """
    solution = not_above_nested(problem, minimum(problem, [given]))
    yield problem, solution
    problem, solution = likeliest_with_motion_errors(problem, solution, given)
    yield problem, solution
    problem, solution = _without_initial_states(problem, solution, given)
    yield problem, solution
    yield problem, best_weighting(problem, solution)


def _without_initial_states(
    problem: Problem, solution: Solution, given: Mapping[str, float]
) -> tuple[Problem, Solution]:
    """Fit again without the samples that depend on an unknown initial state of a contact."""
    if not (find_law(problem.law).has_bristle or has_state_erased_by_sliding(problem.effects)):
        return problem, solution
    settled = without_further_transients(problem, solution)
    if settled is None:
        return problem, solution
    problem = problem.with_campaign(settled)
    known = {**problem.values_by_name(solution.values), **given}
    again = not_above_nested(problem, minimum(problem, [known]))
    return likeliest_with_motion_errors(problem, again, given)


def likeliest_with_motion_errors(
    problem: Problem, solution: Solution, given: Mapping[str, float] | None = None
) -> tuple[Problem, Solution]:
    """Fit with errors of the motion, starting from an ordinary fit and from all starting values.

    Where these errors are large, ordinary least squares may end near another maximum of the
    likelihood. If a search from all starting values and those `given`, with the estimated errors,
    ends at a likelier fit, the errors are estimated again near it, and the likelier of the two
    results is returned. If the time ends during this search, the first result is returned. See
    `with_motion_errors`.
    """
    problem, solution = with_motion_errors(problem, solution)
    motion = solution.samples.motion
    if motion is None:
        return problem, solution
    samples = replace(problem.campaign.samples, motion=replace(motion, by_delay=None))
    campaign = replace(problem.campaign, samples=samples)
    whitened = Problem(
        campaign, problem.law, problem.clock, problem.effects, problem.fixed, problem.bounds
    )
    try:
        other = not_above_nested(whitened, minimum(whitened, [given or {}]))
        if other.cost >= samples.cost(solution.residuals, other.noise):
            return problem, solution
        near = problem.solution(other.values, problem.samples_at(other.values), WHITE)
        again = with_motion_errors(problem, near)
    except Unfinished:
        return problem, solution
    likelier = log_likelihood(again[1]) > log_likelihood(solution)
    return again if likelier else (problem, solution)


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
    ends = fits_on_clocks(problem, solution, clocks)
    best = _with_corners_located_by_forces(problem, likeliest(ends))
    motion = best.solution.samples.motion
    if motion is None:
        return problem, solution
    # Where the errors of the motion are small, a larger RMS than that of ordinary least squares
    # with the same motion shows that they absorb lack of fit.
    settings = problem.campaign.settings
    share = motion.mean_share(best.solution.samples.weight)
    if share <= settings.motion.max_small_share:
        near = near_solution(best.problem, best.solution)
        samples = replace(near.samples, motion=None)
        ordinary = search_solution(best.problem, samples, near.values, WHITE, EVALUATIONS)
        if best.solution.rms > settings.noise.max_rms_ratio * ordinary.rms:
            return plain, plain_fit
    # Systematic errors are the changes of the parameters with less smoothing and, if their
    # likelihoods are similar, with the other clock and without located corners.
    solution = polish(best.problem, best.solution)
    others = [with_less_smoothing(best.problem, solution)[1]]
    unclear = settings.motion.max_clock_deviance
    others += [
        polish(other.problem, other.solution)
        for other in dict.fromkeys(ends)
        if other is not best and abs(other.deviance - best.deviance) < unclear
    ]
    values = best.problem.encode(solution.values)
    changes = [best.problem.encode(other.values) - values for other in others]
    change = np.sqrt(np.sum(np.square(changes), axis=0))
    return best.problem, replace(solution, systematic=change)


def with_less_smoothing(problem: Problem, solution: Solution) -> tuple[Problem, Solution]:
    """Return the problem with a motion that is smoothed less, and its solution.

    The intensity of the process noise is multiplied by `roughness_factor`; weights, corners, jumps
    and the projection of a delay are kept. The change of a result measures its smoothing bias.
    """
    factor = problem.campaign.settings.motion.roughness_factor
    problem = with_scaled_intensity(problem, factor, same_corners=True)
    near = problem.solution(solution.values, solution.samples, solution.noise)
    before = solution.samples.motion
    by_delay = None if before is None else before.by_delay
    motion = replace(estimate_motion_errors(problem, near), by_delay=by_delay)
    samples = replace(solution.samples, motion=motion)
    return problem, search_solution(
        problem, samples, solution.values, solution.noise, EVALUATIONS, lines=near.lines
    )


def gain_with_less_smoothing(
    problem: Problem, solution: Solution, simpler_problem: Problem, simpler: Solution
) -> float:
    """Gain of a fit over a simpler one, both refitted with a motion that is smoothed less.

    Gain in twice the log likelihood; both fits use the covariance estimated from the richer one.
    The covariance does not contain the errors due to the smoothing. These are largest where the
    motion changes abruptly, and resemble friction at low speed.
    """
    rough, richer = with_less_smoothing(problem, solution)
    simpler_rough = simpler_problem.with_campaign(rough.campaign)
    refitted = search_solution(
        simpler_rough, richer.samples, simpler.values, richer.noise, EVALUATIONS
    )
    return likelihood_gain(richer, refitted)


def fit_without_motion_corrections(
    problem: Problem, solution: Solution
) -> tuple[Problem, Solution]:
    """Fit by ordinary least squares, without corrected delays and corners located by the forces.

    It is the starting point for the errors of the motion of a model with other effects, which may
    explain what was corrected. Readings that the correction dropped remain dropped.
    """
    campaign = problem.campaign
    delay_s = corrected_delay_s(campaign)
    if delay_s != 0.0:
        problem = shifted(problem, -delay_s)
    else:  # `shifted` also drops the errors of the motion
        without = replace(campaign, samples=replace(campaign.samples, motion=None))
        problem = problem.with_campaign(without)
    motions = [m and m.with_corners_located_by(None) for m in posteriors(problem)]
    problem = with_posteriors(problem, motions)
    seeds: list[list[dict[str, float]]] = [[problem.values_by_name(solution.values)], [{}]]
    return problem, settle(
        problem, approach(problem, seeds, MAX_EVALUATIONS), least_gain=NEAR_MINIMUM
    )


def _with_corners_located_by_forces(first: Problem, end: DelayedFit) -> DelayedFit:
    """Locate corners (abrupt changes of acceleration) of the motion by the forces, and refit.

    The force of a drive is continuous at a reversal, and the acceleration jumps by the change of
    the friction divided by the mass. The force of a hand, or of a load cell that measures the
    friction, may jump instead. The motions with and without these jumps are both fitted. The
    likeliest of these fits and `end` is returned (`likeliest`). Corners and jumps depend on the
    parameters. They are located again with those of each new fit, at most `ROUNDS` times, while
    twice the log likelihood increases by more than
    `min_smoothness_gain`. `first` is the problem before the correction of a delay.
    """
    motion = end.solution.samples.motion
    settings = first.campaign.settings.motion
    if motion is None or motion.variance_share(end.solution.samples.weight) < settings.min_share:
        return end

    def refit(fit: DelayedFit, *, with_jumps: bool) -> DelayedFit:
        """Fit with the corners located by the forces of `fit`, with or without jumps."""
        located = with_corners_located_by_forces(
            fit.problem, fit.solution, fit.motion, with_jumps=with_jumps
        )
        again = with_posteriors(first, posteriors(located))
        near = near_solution(again, fit.solution)
        return fit_with_delay(again, near, fit.delay_s, delayed=fit.delayed)

    at_once = fits_at_once(first.campaign, first.law, first.effects)
    without, jumping = in_parallel(
        lambda jumps: refit(end, with_jumps=jumps), (False, True), at_once
    )
    previous, best = end, likeliest([end, without, jumping])
    with_jumps, rounds = best is jumping, 1
    while best.deviance < previous.deviance - settings.min_smoothness_gain and rounds < ROUNDS:
        previous, rounds = best, rounds + 1
        best = likeliest([previous, refit(previous, with_jumps=with_jumps)])
    return best


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
        """Deviance, with the prior of the errors' scale, and solution of the fit to a problem."""
        near = tried.solution(solution.values, samples, WHITE)
        fitted = fit_with_errors(tried, near, estimate_motion_errors(tried, near))
        errors = estimate_motion_errors(tried, fitted)
        deviance = errors.whitening(samples.weight).deviance(fitted.residuals)
        prior = (float(np.log(errors.scale)) / settings.motion.scale_prior) ** 2
        return deviance + prior, replace(fitted, samples=samples)

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
