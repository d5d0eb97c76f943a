"""The least squares of innovations: from starting points to a minimum.

`approach` ranks starting points and follows the best as if the noise were white, `settle` converges
with the colour of the noise, `search_peaks` looks for a higher peak where an effect makes many.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from typing import Literal

import numpy as np
import numpy.typing as npt
from scipy import optimize

from jbf.estimation.noise import WHITE, Noise, estimate_noise
from jbf.estimation.peaks import other_peaks
from jbf.estimation.problem import Problem
from jbf.estimation.samples import Samples
from jbf.estimation.solution import Solution
from jbf.models.catalogue import find_effect, find_law

Array = npt.NDArray[np.float64]
Method = Literal["dogbox", "trf"]

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


def search(
    problem: Problem,
    samples: Samples,
    start: Array,
    noise: Noise,
    evaluations: int,
    method: Method = "dogbox",
) -> tuple[Array, bool, str]:
    """Least squares on innovations from one start: values, whether converged, what ended it.

    Parameters
    ----------
    method
        `dogbox` takes the fewest steps; `trf` stays off the bounds on its way and finds lower
        valleys where a law is wrong.
    """
    memory: dict[bytes, tuple[Array, Array]] = {}

    def evaluate(x: Array) -> tuple[Array, Array]:
        key = x.tobytes()
        if key not in memory:
            memory.clear()
            values = problem.decode(x, start)
            r, j, count = problem.gauss_newton_rows(values, samples, noise)
            problem.best.seen(values, float(r @ r) / max(count, 1))
            memory[key] = (-r, j)
        return memory[key]

    def residual(x: Array) -> Array:
        return evaluate(x)[0]

    def jacobian(x: Array) -> Array:
        return evaluate(x)[1]

    low, high = problem.encode(problem.lower), problem.encode(problem.upper)
    x0 = problem.encode(start)
    margin = 1e-9 * np.maximum(np.abs(high - low), 1.0)
    margin = np.minimum(margin, 0.25 * (high - low))
    found = optimize.least_squares(
        residual,
        np.clip(x0, low + margin, high - margin),
        jac=jacobian,
        bounds=(low, high),
        method=method,
        x_scale="jac",
        # A hundredth of a unit of chi-square is far below what any verdict turns on.
        xtol=1e-7,
        ftol=1e-6,
        gtol=1e-12,
        max_nfev=evaluations,
    )
    return problem.decode(found.x, start), bool(found.status > 0), str(found.message)


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
    best = starts[0]
    if len(starts) > 1:
        short = [search(few, some, s, WHITE, steps, method)[0] for s in starts[:followed]]
        best = min(short, key=few.square)
    values, converged, message = best, False, "not followed"
    if len(starts) == 1 or problem.square(best) < least:
        values, converged, message = search(few, some, best, WHITE, evaluations)
        # The whole has its minimum near that of its part.
        converged = converged and few is problem
    samples = problem.samples_at(values)
    noise = noise_at(problem, samples, values)
    return problem.solution(problem.wrapped(values), samples, noise, converged, message)


def settle(problem: Problem, near: Solution, samples: Samples | None = None) -> Solution:
    """Converge from a solution, with the colour of its noise.

    Parameters
    ----------
    samples
        Those to fit; the campaign's where not given, and then those beside jumps weighed anew.
    """
    every = problem.campaign.samples if samples is None else samples
    values, noise = near.values, near.noise
    converged, message = near.converged, near.message
    if not near.converged:
        values, converged, message = search(problem, every, values, WHITE, MAX_EVALUATIONS)
        noise = noise_at(problem, every, values)
    if near.samples is not every:
        # With jumps at full weight the search found its way; with little it finds the place.
        left = problem.samples_at(values)
        return settle(problem, problem.solution(values, left, noise, False, message), left)
    if noise.colour > 0.0:
        again = search(problem, every, values, noise, MAX_EVALUATIONS)
        if problem.square(again[0], every) <= MOST_FORGIVEN**2 * problem.square(values, every):
            values, converged, message = again
            noise = noise_at(problem, every, values)
    return problem.solution(problem.wrapped(values), every, noise, converged, message)


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
        ends = [search(problem, samples, s, noise, TRIAL_EVALUATIONS)[0] for s in starts]
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


def noise_at(problem: Problem, samples: Samples, values: Array) -> Noise:
    """The noise description that fits the residuals at some values, the runs' deviations apart; of
    many long runs, those of some."""
    which = problem.searched
    samples = samples if len(which) == len(samples.runs) else samples.only(which)
    residuals = samples.without_deviations(problem.residuals(values, which), WHITE)
    masked = [r * c for r, c in zip(residuals, samples.counted, strict=True)]
    return estimate_noise(masked, samples.steps_s, samples.counted, problem.campaign.most_noise_n)
