"""Approach to the minimum of a model from its starting points, assuming white noise.

`Approach` ranks the starting points and continues from the best one. `Approach.look` ends after a
few steps, which estimate the log-likelihood gain of a model in a quarter of the computing time.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np

from jbf.arrays import Array
from jbf.estimation.least_squares import unexplained_square
from jbf.estimation.levenberg_marquardt import SearchResult
from jbf.estimation.likelihood import noise_at
from jbf.estimation.noise import WHITE
from jbf.estimation.problem import Problem
from jbf.estimation.samples import Samples
from jbf.estimation.search import Visited, search
from jbf.estimation.solution import Solution
from jbf.models.catalogue import Parameter, find_effect

TRIAL_EVALUATIONS = 6
"""Evaluations spent on each starting point before only the best one is followed. With half of them,
an effect whose null is a flat region of the objective stays at its null."""
FOLLOWED = 2
"""Number of starting points searched for a few evaluations when candidates are ranked."""
KEPT = 12
"""Largest number of starting points kept after each combination of starting values."""
LOOKED = 3
"""Number of evaluations of a first, short search (`Approach.look`). It starts from the best
starting point of the first group of seeds."""


def many_peaks(effects: Iterable[str]) -> bool:
    """Whether the likelihood of a model with any of these effects has many local maxima."""
    return any(find_effect(name).peaks for name in effects)


class Approach:
    """Search for the minimum from the best of all starting points, assuming white noise.

    Parameters
    ----------
    problem
        The model.
    seeds
        Groups of partial starting points: values by parameter name, with the same names within a
        group. All starting values of the other parameters are tried.
    each
        Continue from the best starting point of each group instead of the best of all.
    stepped
        One additional starting point: the end of a Gauss-Newton step from a smaller model. The
        starting values are those of a strong effect. The minimum of a weak effect may be separated
        from them by a maximum of the objective.
    """

    def __init__(
        self,
        problem: Problem,
        seeds: Sequence[Sequence[Mapping[str, float]]],
        *,
        each: bool = False,
        stepped: Array | None = None,
    ) -> None:
        self.problem, self.thinned = problem, problem.thinned
        self._seeds = seeds
        self._each = each
        self._stepped = [] if stepped is None else [stepped]
        self._squares: dict[bytes, float] = {}
        self._kept: dict[int, list[Array]] = {}
        self.visited = Visited()

    @cached_property
    def _best_of_first_group(self) -> Array:
        """Best starting point of the first group of seeds, or a step from a smaller model."""
        return min([*self._likely(0), *self._stepped], key=self._square)

    @cached_property
    def starts(self) -> list[Array]:
        """Starting points in order of increasing sum of squares."""
        groups = [self._likely(k) for k in range(len(self._seeds))]
        if self._each:
            groups = [[min(group, key=self._square)] for group in groups]
        return sorted(itertools.chain(*groups, self._stepped), key=self._square)

    def _likely(self, k: int) -> list[Array]:
        """Promising starting points of group `k` of the seeds.

        The starting values of the law, then those of each effect, are combined with the points kept
        so far; later effects are at their null. If more than `KEPT` points result, those with the
        smallest sum of squares on the run with the highest speed are kept.
        """
        if k in self._kept:
            return self._kept[k]
        names, pages = self.problem.names, self.problem.parameters
        group = [{**seed, **self.problem.fixed} for seed in self._seeds[k]]
        kept = [
            np.array([seed.get(name, null_or_start(page)) for name, page in pages.items()])
            for seed in group
        ]
        unknown = (i for i, name in enumerate(names) if name not in group[0])
        for _, members in itertools.groupby(unknown, lambda i: names[i].rpartition(".")[0]):
            indices = list(members)
            choices = list(itertools.product(*(pages[names[i]].starts for i in indices)))
            kept = [_replaced(point, indices, choice) for point in kept for choice in choices]
            if len(kept) > KEPT:
                kept = sorted(kept, key=self._fastest_square)[:KEPT]
        self._kept[k] = kept
        return kept

    def _square(self, values: Array) -> float:
        """Sum of squares of weighted residuals at a starting point, N^2, computed once."""
        key = values.tobytes()
        if key not in self._squares:
            self._squares[key] = self.thinned.square(values)
        return self._squares[key]

    def _fastest_square(self, values: Array) -> float:
        """Sum of squares of weighted residuals of the run with the highest speed, N^2."""
        run, samples = self._fastest
        return samples.square(self.thinned.residuals(values, [run]))

    @cached_property
    def _fastest(self) -> tuple[int, Samples]:
        """Index of the run with the highest speed, and its samples."""
        campaign = self.thinned.campaign
        speeds = [float(np.max(np.abs(p.motion.velocity))) for p in campaign.prepared]
        run = int(np.argmax(speeds))
        return run, campaign.samples.only([run])

    def look(self, near: Solution) -> tuple[Solution, float]:
        """Search by a few steps from the first group, and compare with a smaller model's solution.

        The first result is a solution with the noise of `near`. The second one is the gain in twice
        the log likelihood: the smallest minimum of the linear models at the visited points relative
        to that of the linear model at `near`, which need not be a minimum for white noise. With
        coloured noise, it is the larger one of this gain and that over `near` in its noise.
        """
        problem, thinned, visited = self.problem, self.thinned, self.visited
        samples = thinned.campaign.samples
        search(thinned, samples, self._best_of_first_group, WHITE, LOOKED, visited=visited)
        # The next search visits the same points and must not end there as a duplicate search.
        visited.ended.clear()
        points = list(visited.points.values())
        values = min(points, key=lambda point: point.square).values
        linear = min(unexplained_square(point.jacobian, point.residual) for point in points)
        residuals = [near.residuals[i] for i in problem.searched]
        jacobian = [near.jacobian[i] for i in problem.searched]
        r, j = samples.stacked(residuals, jacobian, WHITE)
        before = unexplained_square(j, r)
        count = problem.campaign.samples.count
        promised = count * _log_ratio(before, linear)
        lines = visited.lines_at(values) if thinned is problem else None
        visited.lowest = None
        if not near.noise.white:
            # In noise of low frequency, an effect of high frequency has a large gain even if it
            # reduces the sum of squares only slightly.
            if lines is None:
                promised = np.inf
            else:
                before = float(np.sum(near.stacked()[0] ** 2))
                r, j = near.samples.stacked(*lines, near.noise)
                promised = max(promised, count * _log_ratio(before, unexplained_square(j, r)))
        samples = problem.samples_at(values, None if lines is None else lines[0])
        values = problem.wrapped(values)
        solution = problem.solution(values, samples, near.noise, False, "not followed", lines)
        return solution, promised

    def follow(
        self,
        evaluations: int,
        max_square: float = np.inf,
        followed: int = FOLLOWED,
        steps: int = TRIAL_EVALUATIONS,
    ) -> Solution:
        """Continue the search from the best starting points, and return its solution.

        Parameters
        ----------
        evaluations
            Maximum number of evaluations; enough to rank candidates, or to converge.
        max_square
            Sum of squares after the first steps, N^2, from which the search is not continued.
        followed, steps
            Number of starting points, and number of evaluations for each of them before only the
            best search is continued.
        """
        problem, thinned, visited = self.problem, self.thinned, self.visited
        thinned_samples, starts = thinned.campaign.samples, self.starts
        best = SearchResult(starts[0], False, "")
        if len(starts) > 1:
            trials = starts[:followed]
            peaks = many_peaks(problem.effects)
            ends = []
            for start in trials:
                ends.append(search(thinned, thinned_samples, start, WHITE, steps, visited))
                if peaks:
                    # Two searches that meet may separate again towards different maxima.
                    visited.ended.clear()
            best = min(
                ends, key=lambda result: visited.square(thinned, thinned_samples, result.values)
            )
        end = replace(best, converged=False, message="not followed")
        if len(starts) == 1 or _square(problem, thinned, visited, best.values) < max_square:
            if not best.converged:
                # The search continues where an earlier one ended.
                visited.ended.clear()
                best = search(
                    thinned, thinned_samples, best.values, WHITE, evaluations, visited=visited
                )
            # The minimum for all samples is near that for the thinned samples.
            end = replace(best, converged=best.converged and thinned is problem)
        values, lines = end.values, visited.lines_at(end.values) if thinned is problem else None
        samples = problem.samples_at(values, None if lines is None else lines[0])
        noise = noise_at(problem, samples, values, lines)
        values = problem.wrapped(values)
        return problem.solution(values, samples, noise, end.converged, end.message, lines)


def default_starts(problem: Problem) -> list[dict[str, float]]:
    """Starting points of a model from default starting values only, values by name."""
    return [problem.values_by_name(values) for values in Approach(problem, [[{}]]).starts]


def approach(
    problem: Problem,
    seeds: Sequence[Sequence[Mapping[str, float]]],
    evaluations: int,
    *,
    followed: int = FOLLOWED,
    steps: int = TRIAL_EVALUATIONS,
) -> Solution:
    """Rank the starting points, and search from the best one assuming white noise."""
    return Approach(problem, seeds).follow(evaluations, followed=followed, steps=steps)


def null_or_start(page: Parameter) -> float:
    """Finite value of a parameter without influence of its effect, or its first starting value."""
    null = page.null
    return null if null is not None and np.isfinite(null) else page.starts[0]


def _replaced(point: Array, indices: Sequence[int], values: Sequence[float]) -> Array:
    """Copy of a point with other values of the parameters with these indices."""
    moved: Array = point.copy()
    moved[list(indices)] = values
    return moved


def _log_ratio(before: float, after: float) -> float:
    """Logarithm of a ratio of sums of squares, finite for zero squares."""
    return float(np.log(max(before, 1e-300) / max(after, 1e-300)))


def _square(problem: Problem, thinned: Problem, visited: Visited, values: Array) -> float:
    """Sum of squares of weighted residuals over all samples, N^2."""
    if thinned is problem:
        return visited.square(problem, problem.campaign.samples, values)
    return problem.square(values)
