"""How far the open parameters of a fit may be off: the curvature of the likelihood and, where the
residual is not the noise that it is described by, the long-run variance of what pulls at each."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from jbf.estimation.long_run import between_runs, score_inflation
from jbf.estimation.problem import Problem
from jbf.estimation.solution import Solution

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

INSENSITIVE = 1e-9
"""A parameter moves nothing where its derivative is less than this share of the largest."""
SINGULAR = 1e12
"""Condition number of the normal equations from which on parameters are not separately known."""
TAKES_PART = 1e-3
"""The share in such a combination from which on a parameter is one of those."""


@dataclass(frozen=True, eq=False)
class Spread:
    """Of each open parameter, in their order.

    Attributes
    ----------
    sd
        Standard deviation in the search's variable, shape (k,), by the curvature; nan of one that
        never moved.
    inflation
        By how much the residual's long-run variance and the smoothing of the motion make it larger,
        shape (k,), at least one.
    scale
        Change of the parameter with the search's variable, shape (k,).
    correlation
        Shape (k, k); nan of those that never moved.
    moved
        Whether the runs depend on it.
    separate
        Whether no combination of others does the same.
    """

    sd: Array
    inflation: Array
    scale: Array
    correlation: Array
    moved: Mask
    separate: Mask

    def error(self, k: int) -> float:
        """One standard error in the parameter's unit; nan where there is none."""
        return float(self.sd[k] * self.inflation[k] * self.scale[k])


def spread(problem: Problem, solution: Solution) -> Spread:
    """The spread at a solution."""
    r, j = solution.stacked()
    free = j.shape[1]
    variance = float(r @ r) / max(len(r) - free, 1)
    size = np.linalg.norm(j, axis=0)
    moved = size > INSENSITIVE * max(float(size.max(initial=0.0)), 1e-300)
    separate = np.ones(free, dtype=bool)
    covariance = np.full((free, free), np.nan)
    if moved.any():
        unit = j[:, moved] / size[moved]
        normal = unit.T @ unit
        inverse = np.linalg.pinv(normal, rcond=1e-13, hermitian=True)
        scale = np.outer(size[moved], size[moved])
        covariance[np.ix_(moved, moved)] = variance * inverse / scale
        separate[moved] = _separate(normal)
    sd = np.sqrt(np.diag(covariance))
    with np.errstate(invalid="ignore", divide="ignore"):
        correlation = covariance / np.outer(sd, sd)
    values = np.abs(solution.values)
    change = np.where(problem.log, values, 1.0)[problem.open]
    inflation = np.ones(free)
    if moved.any():
        inflation[moved] = _inflation(solution, covariance[np.ix_(moved, moved)], moved)
    if solution.systematic is not None:
        with np.errstate(invalid="ignore", divide="ignore"):
            inflation = np.hypot(inflation, np.nan_to_num(solution.systematic / sd))
    return Spread(sd, inflation, change, correlation, moved, separate)


def _inflation(solution: Solution, covariance: Array, moved: Mask) -> Array:
    """How many times as large as by the curvature each standard deviation is: a parameter follows
    a weighted sum of the innovations, whose variance they tell themselves (Newey & West 1987)."""
    samples = solution.samples
    parts = [
        samples.stacked(solution.residuals, solution.jacobian, solution.noise, [i])
        for i in range(len(samples.runs))
    ]
    # A scale of its own for each parameter: their units have nothing to do with each other.
    influence = [
        j[:, moved] @ (covariance / np.sqrt(np.maximum(np.diag(covariance), 1e-300)))
        for _, j in parts
    ]
    innovations = [r for r, _ in parts]
    found = []
    for k in range(len(covariance)):
        own = [a[:, k] for a in influence]
        ratio = score_inflation(own, innovations, samples.steps_s)
        found.append(np.sqrt(max(ratio, between_runs(own, innovations, ratio))))
    ratios: Array = np.array(found)
    return ratios


def _separate(normal: Array) -> Mask:
    """Which parameters take no part in a combination that the runs cannot see."""
    sizes, ways = np.linalg.eigh(normal)
    unseen = ways[:, sizes * SINGULAR < sizes[-1]]
    part: Mask = np.linalg.norm(unseen, axis=1) < TAKES_PART
    return part
