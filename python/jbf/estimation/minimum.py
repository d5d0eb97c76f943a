"""The least squares of innovations: from starting points to a minimum.

`approach` ranks starting points and follows the best as if the noise were white, `settle` converges
with the colour of the noise, `search_peaks` looks for a higher peak where an effect makes many.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from jbf.estimation.noise import WHITE, Noise, estimate_noise
from jbf.estimation.peaks import other_peaks
from jbf.estimation.problem import Lines, Problem
from jbf.estimation.samples import Samples
from jbf.estimation.search import Found, Method, Visited, search
from jbf.estimation.solution import Solution
from jbf.models.catalogue import find_effect, find_law

Array = npt.NDArray[np.float64]

MAX_EVALUATIONS = 60
"""Steps of a search that converges."""
TRIAL_EVALUATIONS = 6
"""Steps given to each starting point before the best goes on alone: with half of them an effect
whose null is a flat place stays there."""
FOLLOWED = 2
"""How many of the starting points are given them where candidates are ranked,"""
FOLLOWED_IN_A_FIT = 6
"""and where one model is fitted: to their ends where no film makes that dear, since the squares of
a law that is wrong have many valleys."""
MOST_FORGIVEN = 1.02
"""A fit weighted by the colour of its noise may have so many times the plain fit's RMS. Of coloured
noise it has hardly more; the error of a wrong model is as smooth, and would be forgiven."""


def approach(
    problem: Problem,
    seeds: Sequence[Mapping[str, float]],
    evaluations: int,
    least: float = np.inf,
    *,
    each: bool = False,
    followed: int = FOLLOWED,
    steps: int = TRIAL_EVALUATIONS,
    method: Method = "dogbox",
) -> Solution:
    """Search from the best of all starting points, as if the noise were white.

    Parameters
    ----------
    seeds
        Known values by name; starting values fill each one up.
    evaluations
        Where to stop; enough to rank candidates, or to converge.
    least
        A sum of squares, N^2, that the first steps must come below: a search that leads nowhere is
        not followed.
    each
        Follow the best of each seed, not the best of all.
    followed, steps, method
        How many starting points are given how many steps before the best goes on alone, and how.
    """
    few = problem.thinned
    some = few.campaign.samples
    groups = [problem.starts({**seed, **problem.fixed}) for seed in seeds]
    if each:
        groups = [[min(group, key=few.square)] for group in groups]
    starts = sorted(itertools.chain.from_iterable(groups), key=few.square)
    visited = Visited()
    best = Found(starts[0], False, "")
    if len(starts) > 1:
        trials = starts[:followed]
        short = [search(few, some, s, WHITE, steps, method, visited) for s in trials]
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


def settle(problem: Problem, near: Solution, samples: Samples | None = None) -> Solution:
    """Converge from a solution, with the colour of its noise.

    Parameters
    ----------
    samples
        Those to fit; the campaign's where not given, and then those beside jumps weighed anew.
    """
    every = problem.campaign.samples if samples is None else samples
    end, noise = Found(near.values, near.converged, near.message), near.noise
    if not near.converged:
        end = search(problem, every, end.values, WHITE, MAX_EVALUATIONS)
        noise = noise_at(problem, every, end.values)
    if near.samples is not every:
        # With jumps at full weight the search found its way; with little it finds the place.
        left = problem.samples_at(end.values)
        there = problem.solution(end.values, left, noise, False, end.message)
        return settle(problem, there, left)
    if noise.colour > 0.0:
        again = search(problem, every, end.values, noise, MAX_EVALUATIONS)
        most = MOST_FORGIVEN**2 * problem.square(end.values, every)
        if problem.square(again.values, every) <= most:
            end = again
            noise = noise_at(problem, every, end.values)
    return problem.solution(problem.wrapped(end.values), every, noise, end.converged, end.message)


def search_peaks(problem: Problem, near: Solution) -> Solution:
    """The highest peak near a solution, where an effect makes many."""
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


def minimum(problem: Problem, seeds: Sequence[Mapping[str, float]]) -> Solution:
    """Approach, settle, and look for a higher peak."""
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


def _square(problem: Problem, few: Problem, visited: Visited, values: Array) -> float:
    """Sum of squares of weighted residuals of the whole, N^2."""
    if few is problem:
        return visited.square(problem, problem.campaign.samples, values)
    return problem.square(values)


def noise_at(
    problem: Problem, samples: Samples, values: Array, lines: Lines | None = None
) -> Noise:
    """The noise description that fits the residuals at some values, the runs' deviations apart; of
    many long runs, those of some. `lines` are the residuals there, if they are known."""
    which = problem.searched
    samples = samples if len(which) == len(samples.runs) else samples.only(which)
    residuals = problem.residuals(values, which) if lines is None else lines[0]
    residuals = samples.without_deviations(residuals, WHITE)
    masked = [r * c for r, c in zip(residuals, samples.counted, strict=True)]
    return estimate_noise(masked, samples.steps_s, samples.counted, problem.campaign.most_noise_n)
