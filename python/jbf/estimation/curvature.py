"""Does the curvature of the likelihood at a fit tell how sure its parameters are?

A standard error says that the log likelihood falls by one half, one standard error away, all else
following: so it does where it is a parabola. Looked for there, it may not: where a drive rings,
peak stands beside peak, and the width of one of them is no error.
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
"""How far the rise at one standard error may be off one."""


def doubtful_errors(
    problem: Problem, solution: Solution, parameters: Mapping[str, ParameterValue]
) -> tuple[str, ...]:
    """Names of the parameters whose standard error is no error; of held ones nothing is said."""
    known = spread(problem, solution)
    x = problem.encode(solution.values)
    sd = np.where(known.separate, known.sd, np.nan)
    for k, i in enumerate(problem.open):
        # What stands at a bound does not move along with another.
        page = problem.parameters[problem.names[i]]
        if bound_note(page, float(solution.values[i]), known.error(k)) is not None:
            sd[k] = np.nan
    low, high = problem.encode(problem.lower), problem.encode(problem.upper)
    found = []
    # Catalogued as having many: one standard error away may still be the same peak.
    many = {effect for effect in problem.effects if find_effect(effect).peaks}
    for k, i in enumerate(problem.open):
        # Where the likelihood is highest with this parameter one standard error off.
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
