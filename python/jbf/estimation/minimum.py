"""Minimum of the least squares of a model.

`settle` converges with coloured noise; `search_peaks` looks for a higher maximum of the likelihood
where an effect causes many.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt

from jbf.estimation.approach import TRIAL_EVALUATIONS, approach
from jbf.estimation.noise import WHITE
from jbf.estimation.noise_at import noise_at
from jbf.estimation.peaks import other_peaks
from jbf.estimation.problem import Problem
from jbf.estimation.samples import Samples
from jbf.estimation.search import SearchResult, search
from jbf.estimation.solution import Solution
from jbf.models.catalogue import find_effect, find_law

Array = npt.NDArray[np.float64]

MAX_EVALUATIONS = 60
"""Maximum number of evaluations of a search that converges. It limits the effort only."""
FOLLOWED_IN_A_FIT = 6
"""Number of starting points that receive a few evaluations when a single model is fitted.

Without a film they are searched to convergence, which is then inexpensive. The squares of a wrong
law have many local minima. It limits the effort only.
"""


def settle(problem: Problem, near: Solution, samples: Samples | None = None) -> Solution:
    """Converge from a solution, with coloured noise.

    Parameters
    ----------
    samples
        Samples to fit. By default those of the campaign, with those next to jumps weighted again
        after the first search.
    """
    every = problem.campaign.samples if samples is None else samples
    end, noise = SearchResult(near.values, near.converged, near.message), near.noise
    if not near.converged:
        end = search(problem, every, end.values, WHITE, MAX_EVALUATIONS)
        noise = noise_at(problem, every, end.values)
    if near.samples is not every:
        # The search first uses jumps at full weight, and then converges with their reduced weight.
        left = problem.samples_at(end.values)
        there = problem.solution(end.values, left, noise, False, end.message)
        return settle(problem, there, left)
    if noise.colour > 0.0:
        again = search(problem, every, end.values, noise, MAX_EVALUATIONS)
        most = every.settings.noise.max_rms_ratio**2 * problem.square(end.values, every)
        if problem.square(again.values, every) <= most:
            end = again
            noise = noise_at(problem, every, end.values)
    return problem.solution(problem.wrapped(end.values), every, noise, end.converged, end.message)


def search_peaks(problem: Problem, near: Solution) -> Solution:
    """Search the highest maximum of the likelihood near a solution, where an effect causes many."""
    for effect in problem.effects:
        peak = find_effect(effect).peaks
        name = f"{effect}.{peak}"
        if peak is None or name in problem.fixed:
            continue
        which = problem.names.index(name)
        samples, noise = near.samples, near.noise

        def square(values: Array, samples: Samples = samples) -> float:
            return problem.square(values, samples)

        lower, upper = problem.lower[which], problem.upper[which]
        starts = other_peaks(square, near.values, which, lower, upper)
        ends = [search(problem, samples, s, noise, TRIAL_EVALUATIONS).values for s in starts]
        best = min(ends, key=square, default=near.values)
        if square(best) < square(near.values):
            near = settle(problem, problem.solution(best, samples, noise, False))
    return near


NESTED_EVALUATIONS = 30
"""Evaluations of a fit of the law without its effects. It limits the effort only."""


def minimum(problem: Problem, seeds: Sequence[Mapping[str, float]]) -> Solution:
    """Minimise: approach, settle, and search for a higher maximum of the likelihood."""
    if find_law(problem.law).has_film:
        near = approach(problem, seeds, MAX_EVALUATIONS, followed=FOLLOWED_IN_A_FIT)
    else:
        near = approach(
            problem,
            seeds,
            MAX_EVALUATIONS,
            followed=FOLLOWED_IN_A_FIT,
            steps=MAX_EVALUATIONS,
            method="trf",
        )
    return search_peaks(problem, settle(problem, near))


def not_above_nested(problem: Problem, solution: Solution) -> Solution:
    """Return the solution, or a better one found from the optimum of the law without its effects.

    A model with effects contains the law: with the effects at their null it predicts the same. A
    search that ends above the optimum of the law has therefore stopped in a local minimum.
    """
    if not problem.effects:
        return solution
    fixed = {name: value for name, value in problem.fixed.items() if "." not in name}
    law = Problem(problem.campaign, problem.law, problem.clock, (), fixed, problem.bounds)
    if not law.open:
        return solution
    nested = settle(law, approach(law, [{}], NESTED_EVALUATIONS)).values
    start = solution.values.copy()
    for i, (name, page) in enumerate(problem.parameters.items()):
        if name in problem.fixed:
            continue
        if name in law.names:
            start[i] = nested[law.names.index(name)]
        elif page.null is not None:
            start[i] = np.clip(page.null, page.lower, page.upper)
        else:
            start[i] = page.starts[0]
    samples = solution.samples
    if problem.square(start, samples) >= problem.square(solution.values, samples):
        return solution
    end = search(problem, samples, start, solution.noise, MAX_EVALUATIONS)
    found = problem.solution(problem.wrapped(end.values), samples, solution.noise, False)
    better = problem.square(found.values, samples) < problem.square(solution.values, samples)
    return settle(problem, found) if better else solution
