"""Minimisation of the sum of squares of a model from an approximate solution to convergence.

`settle` converges with coloured noise. `search_peaks` searches for a higher maximum of the
likelihood if an effect causes several maxima. `minimum` combines them with the approach from the
starting points.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from jbf.estimation.approach import TRIAL_EVALUATIONS, approach
from jbf.estimation.levenberg_marquardt import SearchResult
from jbf.estimation.likelihood import noise_at
from jbf.estimation.noise import WHITE
from jbf.estimation.problem import Problem
from jbf.estimation.samples import Samples
from jbf.estimation.search import NEAR_MINIMUM, other_peaks, search, search_solution
from jbf.estimation.solution import Solution
from jbf.models.catalogue import find_effect, find_law

Array = npt.NDArray[np.float64]
MAX_EVALUATIONS = 60
"""Maximum number of evaluations of a search that converges."""
FOLLOWED_IN_A_FIT = 6
"""Number of starting points searched for a few evaluations when a single model is fitted.

For a law without a film, these are searched to convergence, which is then inexpensive. The squares
of a wrong law have many local minima."""
NESTED_EVALUATIONS = 30
"""Evaluations of a fit of the law without its effects."""


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
    end, noise = SearchResult(near.values, near.converged, near.message), near.noise
    if not near.converged:
        end = search(problem, samples, end.values, WHITE, MAX_EVALUATIONS, least_gain=NEAR_MINIMUM)
        noise = noise_at(problem, samples, end.values)
    if near.samples is not samples:
        # Search first with full weights, then with reduced weights of samples next to jumps.
        weighted = problem.samples_at(end.values)
        unconverged = problem.solution(end.values, weighted, noise, False, end.message)
        return settle(problem, unconverged, weighted, least_gain)
    if not noise.white:
        coloured = search(
            problem, samples, end.values, noise, MAX_EVALUATIONS, least_gain=least_gain
        )
        most = samples.settings.noise.max_rms_ratio**2 * problem.square(end.values, samples)
        if problem.square(coloured.values, samples) <= most:
            end = coloured
            noise = noise_at(problem, samples, end.values)
        else:
            noise = WHITE
    if noise.white and not near.converged and least_gain < NEAR_MINIMUM:
        end = search(problem, samples, end.values, WHITE, MAX_EVALUATIONS, least_gain=least_gain)
    return problem.solution(problem.wrapped(end.values), samples, noise, end.converged, end.message)


def polish(problem: Problem, near: Solution) -> Solution:
    """Continue a fit to the smallest tolerance of a search, with the same samples and noise."""
    exact = search_solution(problem, near.samples, near.values, near.noise, MAX_EVALUATIONS)
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
    near = approach(problem, seeds, MAX_EVALUATIONS, followed=FOLLOWED_IN_A_FIT, steps=steps)
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
    nested = law.values_by_name(settle(law, approach(law, [{}], NESTED_EVALUATIONS)).values)
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
