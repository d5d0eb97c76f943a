"""Does the curvature of the likelihood at a fit tell how sure its parameters are?

A standard error says that the log likelihood falls by one half, one standard error away, all else
following: so it does where it is a parabola. Looked for there, it may not: where a drive rings,
peak stands beside peak, and the width of one of them is no error.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from jbf.estimation.problem import Problem
from jbf.estimation.solution import Solution
from jbf.models.catalogue import find_effect

Array = npt.NDArray[np.float64]

BENT = 0.3
"""How far the rise at one standard error may be off one."""


def doubtful_errors(
    problem: Problem, solution: Solution, stderr: list[float | None], correlations: Array
) -> tuple[str, ...]:
    """Names of the parameters whose standard error is no error.

    Parameters
    ----------
    stderr
        One for each parameter of the problem; None where there is none.
    correlations : array, shape (k, k)
        Of the parameters that are not held.
    """
    x = problem.encode(solution.values)
    sd = np.full(len(x), np.nan)
    for k, i in enumerate(problem.open):
        error = stderr[i]
        if error is not None:
            sd[k] = error / abs(solution.values[i]) if problem.log[i] else error
    low, high = problem.encode(problem.lower), problem.encode(problem.upper)
    found = []
    # Catalogued as having many: one standard error away may still be the same peak.
    many = {effect for effect in problem.effects if find_effect(effect).peaks}
    for k, i in enumerate(problem.open):
        # Where the likelihood is highest with this parameter one standard error off.
        way = correlations[:, k] * sd
        if not np.isfinite(sd[k]):
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
