"""Check of whether the curvature of the likelihood at a fit gives valid standard errors.

One standard error away from the estimate, with the other parameters following, the log likelihood
falls by one half if it is a parabola. The check evaluates it there. Where a drive rings, the
likelihood has many adjacent maxima, and the width of one of them is not a standard error.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from jbf.estimation.determined import bound_note
from jbf.estimation.problem import Problem
from jbf.estimation.solution import Solution
from jbf.estimation.spread import spread
from jbf.models.catalogue import find_effect
from jbf.models.parameter_value import ParameterValue

Array = npt.NDArray[np.float64]

BENT = 0.3
"""Permitted deviation from one of the rise of the deviance at one standard error.

It enters no verdict.
"""


def doubtful_errors(
    problem: Problem, solution: Solution, parameters: Mapping[str, ParameterValue]
) -> tuple[str, ...]:
    """Names of the parameters, other than held ones, whose standard error is not valid."""
    known = spread(problem, solution)
    x = problem.encode(solution.values)
    sd = np.where(known.separate, known.sd, np.nan)
    for k, i in enumerate(problem.open):
        # A parameter at a bound does not follow another parameter.
        page = problem.parameters[problem.names[i]]
        if bound_note(page, float(solution.values[i]), known.error(k)) is not None:
            sd[k] = np.nan
    low, high = problem.encode(problem.lower), problem.encode(problem.upper)
    found = []
    # Effects catalogued with many maxima: one standard error away may still be the same maximum.
    many = {effect for effect in problem.effects if find_effect(effect).peaks}
    for k, i in enumerate(problem.open):
        # Position of the maximum of the likelihood with this parameter one standard error away.
        way = known.correlation[:, k] * sd
        if parameters[problem.names[i]].held:
            continue
        if problem.names[i].split(".")[0] in many:
            found.append(problem.names[i])
            continue
        way = np.where(np.isfinite(way), way, 0.0)
        for side in (1.0, -1.0):
            there = x + side * way
            if np.any((there <= low) | (there >= high)):
                continue
            residuals = problem.residuals(problem.decode(there, solution.values))
            rise = solution.samples.cost(residuals, solution.noise) - solution.cost
            if abs(rise - 1.0) > BENT:
                found.append(problem.names[i])
                break
    return tuple(found)
