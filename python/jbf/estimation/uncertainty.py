"""How sure a fit is of its parameters: errors from the curvature of the likelihood, or why there is
none."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from jbf.estimation.problem import Problem
from jbf.estimation.solution import Solution
from jbf.models.catalogue import Parameter
from jbf.models.parameter_value import ParameterValue

Array = npt.NDArray[np.float64]

HELD = "held fixed"
"""The note of a parameter that was not fitted."""
INSENSITIVE = 1e-9
"""A parameter moves nothing where its derivative is less than this share of the largest."""
SINGULAR = 1e12
"""Condition number of the normal equations from which on parameters are not separately known."""
AT_BOUND = 1e-6
"""A value is at its bound where it is off it by less than this share of the width in the
logarithm, or of its own size or error."""


def parameter_values(problem: Problem, solution: Solution) -> tuple[list[ParameterValue], Array]:
    """Values with standard errors, and the correlations, shape (k, k).

    Where an error cannot be had, the note says why.
    """
    r, j = solution.stacked()
    free = j.shape[1]
    variance = float(r @ r) / max(len(r) - free, 1)
    size = np.linalg.norm(j, axis=0)
    sensitive = size > INSENSITIVE * max(float(size.max(initial=0.0)), 1e-300)
    covariance = np.full((free, free), np.nan)
    if sensitive.any():
        unit = j[:, sensitive] / size[sensitive]
        inverse = np.linalg.pinv(unit.T @ unit, rcond=1e-13, hermitian=True)
        index = np.flatnonzero(sensitive)
        scale = np.outer(size[sensitive], size[sensitive])
        covariance[np.ix_(index, index)] = variance * inverse / scale
        singular = bool(np.linalg.cond(unit.T @ unit) > SINGULAR)
    else:
        singular = True
    sd = np.sqrt(np.diag(covariance))
    with np.errstate(invalid="ignore", divide="ignore"):
        correlation = covariance / np.outer(sd, sd)
    pages = list(problem.parameters.values())
    results = []
    for i, (value, page) in enumerate(zip(solution.values.tolist(), pages, strict=True)):
        if i not in problem.open:
            results.append(ParameterValue(value, None, HELD))
            continue
        k = problem.open.index(i)
        error = float(sd[k] * (abs(value) if page.log else 1.0))
        note = None if sensitive[k] else "never moved: these runs do not depend on it"
        note = note or bound_note(page, value, error)
        if singular:
            note = note or "not separately known: another parameter does the same in these runs"
        results.append(ParameterValue(value, None if note else error, note))
    return results, correlation


def bound_note(page: Parameter, value: float, error: float) -> str | None:
    """That a value stands at one of its bounds, if it does.

    A linear parameter is judged by its own size and error, not by the width between its bounds,
    which is often many times what any machine has.
    """
    for side, bound, wish in (("lower", page.lower, "less"), ("upper", page.upper, "more")):
        if page.log:
            off = abs(np.log(value) - np.log(bound))
            near = off < AT_BOUND * (np.log(page.upper) - np.log(page.lower))
        else:
            sizes = [abs(value), abs(bound), error if np.isfinite(error) else 0.0]
            near = abs(value - bound) <= AT_BOUND * max(sizes)
        if near:
            return f"at its {side} bound {bound:g}: the runs ask for {wish}"
    return None
