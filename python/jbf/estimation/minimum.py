"""Minimisation of the sum of squares of a model from an approximate solution to convergence.

`settle` converges with coloured noise. `search_peaks` searches for a higher maximum of the
likelihood if an effect causes several maxima. `minimum` combines them with the approach from the
starting points.

`best_weighting` chooses between plain and robust least squares by held-out error. If the residual
is Gaussian noise, plain and robust estimates agree. If they differ, either the model is wrong or
the record contains outliers. The held-out error decides between these two cases, because the
weights affect the estimates and not only their uncertainty.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from jbf.arrays import Array
from jbf.estimation.approach import TRIAL_EVALUATIONS, approach
from jbf.estimation.held_out import held_out_by_run
from jbf.estimation.likelihood import noise_at
from jbf.estimation.noise import WHITE, Noise
from jbf.estimation.problem import Problem
from jbf.estimation.samples import Samples
from jbf.estimation.search import NEAR_MINIMUM, SearchEnd, other_peaks, search, search_solution
from jbf.estimation.solution import Solution
from jbf.models.catalogue import find_effect, find_law

MAX_EVALUATIONS = 60
"""Maximum number of evaluations of a search that converges."""
FOLLOWED_IN_A_FIT = 6
"""Number of starting points searched for a few evaluations when a single model is fitted.

For a law without a film, these are searched to convergence, which is then inexpensive. The squares
of a wrong law have many local minima."""
NESTED_EVALUATIONS = 30
"""Evaluations of a fit of the law without its effects."""
HUBER_TUNING = 1.345
"""Huber's constant: limit of the influence of a residual, in robust standard deviations. The
efficiency is 95 % of least squares for Gaussian noise (Huber 1964)."""
STUDENT_FREEDOM = 3.0
"""Degrees of freedom of Student's t distribution for robust weights."""
ROBUST_ROUNDS = 4
"""Number of iterations of weights and fits."""
MIN_CHANGE = 0.05
"""Difference of two models' predictions above which their estimates differ. The difference is a
fraction of the residual's RMS."""
BETTER_RMS = 0.97
"""Ratio of held-out RMS values below which one of them counts as smaller."""
EQUAL_RMS, BETTER_MEDIAN = 1.02, 0.8
"""Accepted ratio of held-out RMS values, if the ratio of the medians is at most the second
value."""


def settle(
    problem: Problem, near: Solution, samples: Samples | None = None, least_gain: float = 0.0
) -> Solution:
    """Continue from a solution to convergence, with coloured noise.

    The noise is white if the estimates with coloured noise increase the RMS too much: the residual
    then contains a missing effect rather than noise.

    Parameters
    ----------
    samples
        Samples to fit. By default those of the campaign, with those next to jumps weighted again
        after the first search.
    least_gain
        Gain at which the last search ends (`search`). The first one, with white noise, ends at
        `NEAR_MINIMUM`, and is continued if the noise is white and `least_gain` smaller.
    """
    samples = problem.campaign.samples if samples is None else samples
    end = SearchEnd(near.values, near.converged, near.message, near.lines)
    noise = near.noise

    def continued(noise: Noise, least_gain: float) -> SearchEnd:
        """Search from the present end."""
        return search(
            problem,
            samples,
            end.values,
            noise,
            MAX_EVALUATIONS,
            least_gain=least_gain,
            lines=end.lines,
        )

    if not near.converged:
        end = continued(WHITE, NEAR_MINIMUM)
        noise = noise_at(problem, samples, end.values, end.lines)
    if near.samples is not samples:
        # Search first with full weights, then with reduced weights of samples next to jumps.
        weighted = problem.samples_at(end.values, None if end.lines is None else end.lines[0])
        unconverged = problem.solution(end.values, weighted, noise, False, end.message, end.lines)
        return settle(problem, unconverged, weighted, least_gain)
    if not noise.white:
        coloured = continued(noise, least_gain)
        most = samples.settings.noise.max_rms_ratio**2 * samples.square(_residuals(problem, end))
        if samples.square(_residuals(problem, coloured)) <= most:
            end = coloured
            noise = noise_at(problem, samples, end.values, end.lines)
        else:
            noise = WHITE
    if noise.white and not near.converged and least_gain < NEAR_MINIMUM:
        end = continued(WHITE, least_gain)
    return problem.solution(
        problem.wrapped(end.values), samples, noise, end.converged, end.message, end.lines
    )


def _residuals(problem: Problem, end: SearchEnd) -> Sequence[Array]:
    """Residuals at the end of a search, N, one array per run."""
    return problem.residuals(end.values) if end.lines is None else end.lines[0]


def polish(problem: Problem, near: Solution) -> Solution:
    """Continue a fit to the smallest tolerance of a search, with the same samples and noise."""
    exact = search_solution(
        problem, near.samples, near.values, near.noise, MAX_EVALUATIONS, lines=near.lines
    )
    return replace(exact, systematic=near.systematic)


def search_peaks(problem: Problem, near: Solution, least_gain: float = 0.0) -> Solution:
    """Search for the highest maximum of a likelihood with several maxima near a solution.

    `least_gain` is that of `search`.
    """
    for effect in problem.effects:
        peak = find_effect(effect).peaks
        name = f"{effect}.{peak}"
        if peak is None or name in problem.fixed:
            continue
        index = problem.names.index(name)
        samples, noise = near.samples, near.noise

        def square(values: Array, samples: Samples = samples) -> float:
            """Sum of squares of the weighted residuals, N^2, for given parameter values."""
            return problem.square(values, samples)

        lower, upper = problem.lower[index], problem.upper[index]
        starts = other_peaks(square, near.values, index, lower, upper)
        ends = [search(problem, samples, s, noise, TRIAL_EVALUATIONS).values for s in starts]
        best = min(ends, key=square, default=near.values)
        if square(best) < square(near.values):
            unconverged = problem.solution(best, samples, noise, False)
            near = settle(problem, unconverged, least_gain=least_gain)
    return near


def minimum(problem: Problem, seeds: Sequence[Mapping[str, float]]) -> Solution:
    """Minimise the sum of squares from all starting points to convergence, with other maxima."""
    # Without a film, each starting point is searched to convergence.
    steps = TRIAL_EVALUATIONS if find_law(problem.law).has_film else MAX_EVALUATIONS
    near = approach(
        problem,
        [[seed] for seed in seeds],
        MAX_EVALUATIONS,
        followed=FOLLOWED_IN_A_FIT,
        steps=steps,
    )
    return search_peaks(problem, settle(problem, near))


def not_above_nested(problem: Problem, solution: Solution) -> Solution:
    """Return the solution, or a better one found from the optimum of the law without effects.

    The law is nested in a model with effects: with the effects at their null, the predictions are
    equal. A search that ends above the optimum of the law has therefore reached a local minimum.
    """
    if not problem.effects:
        return solution
    fixed = {name: value for name, value in problem.fixed.items() if "." not in name}
    law = Problem(problem.campaign, problem.law, problem.clock, (), fixed, problem.bounds)
    if not law.open:
        return solution
    nested = law.values_by_name(settle(law, approach(law, [[{}]], NESTED_EVALUATIONS)).values)
    start = solution.values.copy()
    for i, (name, page) in enumerate(problem.parameters.items()):
        if name not in problem.fixed:
            null = None if page.null is None else np.clip(page.null, page.lower, page.upper)
            start[i] = nested.get(name, page.starts[0] if null is None else null)
    samples = solution.samples
    if problem.square(start, samples) >= problem.square(solution.values, samples):
        return solution
    end = search_solution(problem, samples, start, solution.noise, MAX_EVALUATIONS)
    candidate = replace(end, converged=False)
    better = problem.square(candidate.values, samples) < problem.square(solution.values, samples)
    return settle(problem, candidate) if better else solution


def best_weighting(problem: Problem, plain: Solution) -> Solution:
    """Choose between least squares (`plain`) and robust weights by the held-out error."""
    best: Solution = plain
    errors: Array | None = None
    for weights in (huber, student):
        robust = _robust(problem, plain, weights)
        changes = [a - b for a, b in zip(plain.residuals, robust.residuals, strict=True)]
        if plain.samples.rms(changes) < MIN_CHANGE * plain.rms:
            continue
        errors = np.concatenate(held_out_by_run(problem, best)) if errors is None else errors
        robust_errors = np.concatenate(held_out_by_run(problem, robust))
        if _better(robust_errors, errors):
            best, errors = robust, robust_errors
    return best


def _better(robust_errors: Array, errors: Array) -> bool:
    """Whether the errors of a robust fit are smaller than others, in their RMS or their median.

    The median is used if outliers dominate the RMS, provided that the RMS does not clearly
    increase.
    """
    rms = float(np.sqrt(np.mean(robust_errors**2) / max(float(np.mean(errors**2)), 1e-300)))
    median = float(np.median(np.abs(robust_errors)) / max(float(np.median(np.abs(errors))), 1e-300))
    return rms < BETTER_RMS or (rms < EQUAL_RMS and median < BETTER_MEDIAN)


def huber(residual: Array, tuning: float = HUBER_TUNING) -> Array:
    """Square roots of the Huber weights of absolute residuals given in standard deviations."""
    return np.asarray(np.sqrt(np.minimum(1.0, tuning / np.maximum(residual, 1e-300))))


def student(residual: Array) -> Array:
    """Square roots of the weights of Student's t for absolute residuals in standard deviations.

    Outliers have almost no weight (Lange et al. 1989).
    """
    return np.asarray(np.sqrt((STUDENT_FREEDOM + 1.0) / (STUDENT_FREEDOM + residual**2)))


def _robust(problem: Problem, start: Solution, weights: Callable[[Array], Array]) -> Solution:
    """M-estimate for a weight function by iteratively reweighted least squares."""
    solution, samples = start, start.samples
    for _ in range(ROBUST_ROUNDS):
        flat = np.abs(samples.flat(solution.residuals))
        scale = float(np.median(flat)) / 0.6745 if len(flat) else 0.0
        if scale <= 0.0:
            return start
        factors = [weights(np.abs(r) / scale) for r in solution.residuals]
        weight = tuple(w * f for w, f in zip(start.samples.weight, factors, strict=True))
        samples = replace(start.samples, weight=weight)
        solution = search_solution(
            problem, samples, solution.values, WHITE, MAX_EVALUATIONS, lines=solution.lines
        )
    return solution
