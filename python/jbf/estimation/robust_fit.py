"""Choice between plain and robust least squares by held-out error.

If the residual is Gaussian noise, plain and robust estimates agree. If the estimates differ, either
the model is wrong or the record contains outliers. The held-out error decides between these two
cases, because the weights affect the estimates and not only their uncertainty.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from jbf.estimation.held_out import held_out_by_run
from jbf.estimation.minimum import MAX_EVALUATIONS
from jbf.estimation.noise import WHITE
from jbf.estimation.problem import Problem
from jbf.estimation.search import search_solution
from jbf.estimation.solution import Solution

Array = npt.NDArray[np.float64]
TUNING = 1.345
"""Huber's constant: limit of the influence of a residual, in robust standard deviations. The
efficiency is 95 % of least squares for Gaussian noise (Huber 1964)."""
FREEDOM = 3.0
"""Degrees of freedom of Student's t."""
ROUNDS = 4
"""Number of iterations of weights and fits."""
ELSEWHERE = 0.05
"""Difference of two models' predictions above which their estimates differ. The difference is a
fraction of the residual's RMS."""
BETTER = 0.97
"""Ratio of held-out RMS values below which one of them counts as smaller."""
NO_WORSE, SHARPER = 1.02, 0.8
"""Accepted ratio of held-out RMS values, if the ratio of the medians is at most the second
value."""


def best_weighting(problem: Problem, plain: Solution) -> Solution:
    """Choose between least squares (`plain`) and robust weights by the held-out error."""
    best: Solution = plain
    errors: Array | None = None
    for weights in (huber, student):
        robust = _robust(problem, plain, weights)
        changes = [a - b for a, b in zip(plain.residuals, robust.residuals, strict=True)]
        if plain.samples.rms(changes) < ELSEWHERE * plain.rms:
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
    return rms < BETTER or (rms < NO_WORSE and median < SHARPER)


def huber(residual: Array, tuning: float = TUNING) -> Array:
    """Square roots of the Huber weights of absolute residuals given in standard deviations."""
    return np.asarray(np.sqrt(np.minimum(1.0, tuning / np.maximum(residual, 1e-300))))


def student(residual: Array) -> Array:
    """Square roots of the weights of Student's t for absolute residuals in standard deviations.

    Outliers have almost no weight (Lange et al. 1989).
    """
    return np.asarray(np.sqrt((FREEDOM + 1.0) / (FREEDOM + residual**2)))


def _robust(problem: Problem, start: Solution, weights: Callable[[Array], Array]) -> Solution:
    """M-estimate for a weight function by iteratively reweighted least squares."""
    solution, samples = start, start.samples
    for _ in range(ROUNDS):
        flat = np.abs(samples.flat(solution.residuals))
        scale = float(np.median(flat)) / 0.6745 if len(flat) else 0.0
        if scale <= 0.0:
            return start
        factors = [weights(np.abs(r) / scale) for r in solution.residuals]
        weight = tuple(w * f for w, f in zip(start.samples.weight, factors, strict=True))
        samples = replace(start.samples, weight=weight)
        solution = search_solution(problem, samples, solution.values, WHITE, MAX_EVALUATIONS)
    return solution
