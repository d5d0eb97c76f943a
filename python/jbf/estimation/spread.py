"""How far the open parameters of a fit may be off: the curvature of the likelihood."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

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
        Standard deviation in the search's variable, shape (k,); nan of one that never moved.
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
    scale: Array
    correlation: Array
    moved: Mask
    separate: Mask

    def error(self, k: int) -> float:
        """One standard error in the parameter's unit; nan where there is none."""
        return float(self.sd[k] * self.scale[k])


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
    return Spread(sd, change, correlation, moved, separate)


def _separate(normal: Array) -> Mask:
    """Which parameters take no part in a combination that the runs cannot see."""
    sizes, ways = np.linalg.eigh(normal)
    unseen = ways[:, sizes * SINGULAR < sizes[-1]]
    part: Mask = np.linalg.norm(unseen, axis=1) < TAKES_PART
    return part
