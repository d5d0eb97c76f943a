"""The approach to a minimum: starting points are ranked, and the best followed as if the noise were
white.

It may be interrupted after a first look, which tells what a model promises for a quarter of the
work.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt

from jbf.estimation.likelihood import unexplained_square
from jbf.estimation.noise import WHITE
from jbf.estimation.noise_at import noise_at
from jbf.estimation.problem import Lines, Problem
from jbf.estimation.search import Found, Method, Visited, search
from jbf.estimation.solution import Solution
from jbf.models.catalogue import find_effect

Array = npt.NDArray[np.float64]

TRIAL_EVALUATIONS = 6
"""Steps given to each starting point before the best goes on alone: with half of them an effect
whose null is a flat place stays there."""
FOLLOWED = 2
"""How many of the starting points are given them where candidates are ranked."""
MANY = 24
"""Starting points that are all tried on all runs; of more"""
LIKELY = 6
"""one of so many, after a look at one run: the one that goes fastest goes through every speed."""
LOOKED = 3
"""Steps of a first look, from the best start that the first seed has."""


@dataclass(frozen=True)
class Look:
    """What a few steps of a fit beside a smaller model have seen, in twice the log likelihood.

    Attributes
    ----------
    gain
        What they have gained.
    promised
        What the linear model at the best of them promises.
    """

    values: Array
    gain: float
    promised: float
    lines: Lines | None


class Approach:
    """A search from the best of all starting points, as if the noise were white.

    Parameters
    ----------
    seeds
        Known values by name; starting values fill each one up.
    each
        Follow the best of each seed, not the best of all.
    stepped
        One start more: where a step from a smaller model leads. Starting values suit a strong
        effect, and may be on the far side of a hill from a weak one.
    """

    def __init__(
        self,
        problem: Problem,
        seeds: Sequence[Mapping[str, float]],
        *,
        each: bool = False,
        stepped: Array | None = None,
    ) -> None:
        self.problem, self.few = problem, problem.thinned
        self._groups = [problem.starts({**seed, **problem.fixed}) for seed in seeds]
        self._each = each
        self._stepped = [] if stepped is None else [stepped]
        self._squares: dict[bytes, float] = {}
        self._kept: dict[int, list[Array]] = {}
        self.visited = Visited()

    @cached_property
    def _nearest(self) -> Array:
        """The best start from the first seed, or from a smaller model."""
        return min([*self._likely(0), *self._stepped], key=self._square)

    @cached_property
    def starts(self) -> list[Array]:
        """Where to start from, best first."""
        groups = [self._likely(k) for k in range(len(self._groups))]
        if self._each:
            groups = [[min(group, key=self._square)] for group in groups]
        every = itertools.chain(*groups, self._stepped)
        return sorted(every, key=self._square)

    def _likely(self, k: int) -> list[Array]:
        """Of many starts of a seed, those that predict one run better than most do."""
        if k not in self._kept:
            self._kept[k] = self._likeliest(self._groups[k])
        return self._kept[k]

    def _likeliest(self, group: list[Array]) -> list[Array]:
        few = self.few
        runs = few.campaign.prepared
        if len(group) <= MANY or len(runs) < 2:
            return group
        fastest = [float(np.max(np.abs(p.motion.velocity_m_s))) for p in runs]
        which = [int(np.argmax(fastest))]
        samples = few.campaign.samples.only(which)
        squares = [samples.square(few.residuals(start, which)) for start in group]
        order = np.argsort(squares, kind="stable")
        return [group[i] for i in order[: max(MANY, len(group) // LIKELY)]]

    def _square(self, values: Array) -> float:
        """Sum of squares of weighted residuals, N^2, asked once for each start."""
        key = values.tobytes()
        if key not in self._squares:
            self._squares[key] = self.few.square(values)
        return self._squares[key]

    def look(self, near: Solution) -> Look:
        """A few steps from the first seed's best start, beside the solution of a smaller model."""
        problem, few, visited = self.problem, self.few, self.visited
        some = few.campaign.samples
        search(few, some, self._nearest, WHITE, LOOKED, visited=visited)
        # The search that follows goes the same way, and has not joined it.
        visited.ended.clear()
        places = list(visited.places.values())
        lowest = min(places, key=lambda place: place.square)
        promised = min(unexplained_square(place.jacobian, place.residual) for place in places)
        before = few.campaign.samples.square([near.residuals[i] for i in problem.searched])
        count = problem.campaign.samples.count
        gain, most = (count * _log_ratio(before, left) for left in (lowest.square, promised))
        lines = visited.lines_at(lowest.values) if few is problem else None
        visited.lowest = None
        if near.noise.colour > 0.0:
            # What little a sharp feature takes away is much beside a smooth noise.
            if lines is None:
                return Look(lowest.values, gain, np.inf, None)
            before = float(np.sum(near.stacked()[0] ** 2))
            r, j = near.samples.stacked(*lines, near.noise)
            gain = max(gain, count * _log_ratio(before, float(r @ r)))
            most = max(most, count * _log_ratio(before, unexplained_square(j, r)))
        return Look(lowest.values, gain, most, lines)

    def solution_of(self, look: Look, near: Solution) -> Solution:
        """A first look as a solution, under the noise of the smaller model."""
        problem, lines = self.problem, look.lines
        samples = problem.samples_at(look.values, lines)
        values = problem.wrapped(look.values)
        return problem.solution(values, samples, near.noise, False, "not followed", lines)

    def follow(
        self,
        evaluations: int,
        least: float = np.inf,
        followed: int = FOLLOWED,
        steps: int = TRIAL_EVALUATIONS,
        method: Method = "dogbox",
    ) -> Solution:
        """Search on.

        Parameters
        ----------
        evaluations
            Where to stop; enough to rank candidates, or to converge.
        least
            A sum of squares, N^2, that the first steps must come below: a search that leads nowhere
            is not followed.
        followed, steps, method
            How many starting points are given how many steps before the best goes on alone, and
            how.
        """
        problem, few, visited = self.problem, self.few, self.visited
        some, starts = few.campaign.samples, self.starts
        best = Found(starts[0], False, "")
        if len(starts) > 1:
            trials = starts[:followed]
            peaks = any(find_effect(name).peaks for name in problem.effects)
            short = []
            for start in trials:
                short.append(search(few, some, start, WHITE, steps, method, visited))
                if peaks:
                    # Two ways that meet may part again for different peaks.
                    visited.ended.clear()
            best = min(short, key=lambda found: visited.square(few, some, found.values))
        end = replace(best, converged=False, message="not followed")
        if len(starts) == 1 or _square(problem, few, visited, best.values) < least:
            if not best.converged or method != "dogbox":
                # It goes on where one of those before ended.
                visited.ended.clear()
                best = search(few, some, best.values, WHITE, evaluations, visited=visited)
            # The whole has its minimum near that of its part.
            end = replace(best, converged=best.converged and few is problem)
        values, lines = end.values, visited.lines_at(end.values) if few is problem else None
        samples = problem.samples_at(values, lines)
        noise = noise_at(problem, samples, values, lines)
        values = problem.wrapped(values)
        return problem.solution(values, samples, noise, end.converged, end.message, lines)


def approach(
    problem: Problem,
    seeds: Sequence[Mapping[str, float]],
    evaluations: int,
    *,
    followed: int = FOLLOWED,
    steps: int = TRIAL_EVALUATIONS,
    method: Method = "dogbox",
) -> Solution:
    """Both parts of an approach at once."""
    way = Approach(problem, seeds)
    return way.follow(evaluations, followed=followed, steps=steps, method=method)


def _log_ratio(before: float, after: float) -> float:
    return float(np.log(max(before, 1e-300) / max(after, 1e-300)))


def _square(problem: Problem, few: Problem, visited: Visited, values: Array) -> float:
    """Sum of squares of weighted residuals of the whole, N^2."""
    if few is problem:
        return visited.square(problem, problem.campaign.samples, values)
    return problem.square(values)
