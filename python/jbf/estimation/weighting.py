"""Plain least squares, or robust ones: whichever predicts better what it was not fitted to.

Where a fit goes is one question, how sure it is another. Of noise alone all weights lead to the
same place. Where they lead to another, the model is wrong somewhere, or a few samples are: which of
the two a weight makes worse the record of other runs tells, not a description of the noise.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from jbf.estimation.left_out import left_out_residuals
from jbf.estimation.minimum import MAX_EVALUATIONS
from jbf.estimation.noise import WHITE
from jbf.estimation.problem import Problem
from jbf.estimation.search import search
from jbf.estimation.solution import Solution

Array = npt.NDArray[np.float64]

TUNING = 1.345
"""Robust standard deviations beyond which a residual pulls no more than at that distance: 95 % as
efficient as least squares where the noise is Gaussian (Huber 1964)."""
FREEDOM = 3.0
"""Degrees of freedom of Student's t."""
ROUNDS = 4
"""Rounds of weights and fits."""
ELSEWHERE = 0.05
"""Predictions further apart than this share of the residual's RMS are two places."""
BETTER = 0.97
"""A left-out RMS smaller than so many times the other is smaller;"""
NO_WORSE, SHARPER = 1.02, 0.8
"""or one that is no worse, by its first, where the median is smaller, by its second."""


def best_weighting(problem: Problem, plain: Solution) -> Solution:
    """The solution that predicts runs left out best: this one, or one with robust weights."""
    best: Solution = plain
    left: Array | None = None
    for weights in (huber, student):
        robust = _robust(problem, plain, weights)
        apart = [a - b for a, b in zip(plain.residuals, robust.residuals, strict=True)]
        if plain.samples.rms(apart) < ELSEWHERE * plain.rms_n:
            continue
        left = left_out_residuals(problem, best) if left is None else left
        other = left_out_residuals(problem, robust)
        if _better(other, left):
            best, left = robust, other
    return best


def _better(other: Array, left: Array) -> bool:
    """Whether left-out residuals are smaller: in their squares or, where a few wild samples make up
    most of those, in their middle."""
    square = float(np.sqrt(np.mean(other**2) / max(float(np.mean(left**2)), 1e-300)))
    middle = float(np.median(np.abs(other)) / max(float(np.median(np.abs(left))), 1e-300))
    return square < BETTER or (square < NO_WORSE and middle < SHARPER)


def huber(off: Array) -> Array:
    """Weights on residuals that are so many standard deviations off: linear beyond some."""
    weight: Array = np.sqrt(np.minimum(1.0, TUNING / np.maximum(off, 1e-300)))
    return weight


def student(off: Array) -> Array:
    """The same of Student's t: what is far off hardly counts at all (Lange et al. 1989)."""
    weight: Array = np.sqrt((FREEDOM + 1.0) / (FREEDOM + off**2))
    return weight


def _robust(problem: Problem, start: Solution, weights: Callable[[Array], Array]) -> Solution:
    """The M-estimate of these weights, by least squares that follow the residuals."""
    found, samples = start, start.samples
    for _ in range(ROUNDS):
        flat = np.abs(samples.flat(found.residuals))
        scale = float(np.median(flat)) / 0.6745 if len(flat) else 0.0
        if scale <= 0.0:
            return start
        pull = [weights(np.abs(r) / scale) for r in found.residuals]
        weight = tuple(w * p for w, p in zip(start.samples.weight, pull, strict=True))
        samples = replace(start.samples, weight=weight)
        end = search(problem, samples, found.values, WHITE, MAX_EVALUATIONS)
        there = problem.wrapped(end.values)
        found = problem.solution(there, samples, WHITE, end.converged, end.message)
    return found
