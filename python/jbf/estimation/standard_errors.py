"""Standard errors of the free parameters of a fit, and their validity.

Standard errors are computed from the curvature of the log likelihood. If the noise model does not
describe the residual, they are increased by the long-run variance of the score of each parameter
(`variance`). `doubtful_errors` checks that the log likelihood is quadratic up to one standard
error.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from jbf.arrays import Array, Mask
from jbf.estimation.bounds import bound_note
from jbf.estimation.problem import Problem
from jbf.estimation.solution import Solution
from jbf.estimation.variance import cluster_inflation, score_inflation
from jbf.models.catalogue import find_effect
from jbf.models.parameter_value import ParameterValue

INSENSITIVE = 1e-9
"""Fraction of the largest derivative below which the runs do not depend on a parameter."""
SINGULAR = 1e12
"""Condition number of the normal equations above which parameters cannot be separated."""
TAKES_PART = 1e-3
"""Weight of a parameter in an unidentifiable combination above which it is unidentifiable."""
BENT = 0.3
"""Accepted deviation from one of the rise of the deviance one standard error from the minimum."""


@dataclass(frozen=True, eq=False)
class StandardErrors:
    """Uncertainty of each free parameter, in their order.

    Attributes
    ----------
    sd
        Standard deviation of the search variable from the curvature, shape (k,); nan if the runs
        do not depend on the parameter.
    inflation
        Factor on the standard deviation due to the long-run variance of the residual and the
        smoothing of the motion, shape (k,), at least one.
    scale
        Derivative of the parameter with respect to the search variable, shape (k,).
    correlation
        Correlation matrix, shape (k, k); nan for parameters on which the runs do not depend.
    sensitive
        Whether the runs depend on the parameter.
    separate
        Whether no combination of other parameters has the same effect.
    """

    sd: Array
    inflation: Array
    scale: Array
    correlation: Array
    sensitive: Mask
    separate: Mask

    def error(self, k: int) -> float:
        """Standard error of the free parameter `k` in its unit; nan if it is unknown."""
        return float(self.sd[k] * self.inflation[k] * self.scale[k])


def standard_errors(problem: Problem, solution: Solution) -> StandardErrors:
    """Compute the standard errors and correlations of the free parameters at a solution."""
    r, j = solution.stacked()
    free = j.shape[1]
    variance = float(r @ r) / max(len(r) - free, 1)
    size = np.linalg.norm(j, axis=0)
    sensitive = size > INSENSITIVE * max(float(size.max(initial=0.0)), 1e-300)
    separate = np.ones(free, dtype=bool)
    covariance = np.full((free, free), np.nan)
    if sensitive.any():
        unit = j[:, sensitive] / size[sensitive]
        normal = unit.T @ unit
        inverse = np.linalg.pinv(normal, rcond=1e-13, hermitian=True)
        sizes = np.outer(size[sensitive], size[sensitive])
        covariance[np.ix_(sensitive, sensitive)] = variance * inverse / sizes
        separate[sensitive] = _separate(normal)
    sd = np.sqrt(np.diag(covariance))
    with np.errstate(invalid="ignore", divide="ignore"):
        correlation = covariance / np.outer(sd, sd)
    values = np.abs(solution.values)
    scale = np.where(problem.log, values, 1.0)[problem.open]
    inflation = np.ones(free)
    if sensitive.any():
        inflation[sensitive] = _inflation(
            solution, covariance[np.ix_(sensitive, sensitive)], sensitive
        )
    if solution.systematic is not None:
        with np.errstate(invalid="ignore", divide="ignore"):
            inflation = np.hypot(inflation, np.nan_to_num(solution.systematic / sd))
    return StandardErrors(sd, inflation, scale, correlation, sensitive, separate)


def _inflation(solution: Solution, covariance: Array, sensitive: Mask) -> Array:
    """Ratio of robust (HAC) to curvature-based standard error of each parameter, shape (k,).

    The variance of the score is estimated from the innovations within runs (Newey & West 1987) and
    between runs; the larger one is used.
    """
    samples, settings = solution.samples, solution.samples.settings.variance
    parts = [
        samples.stacked(solution.residuals, solution.jacobian, solution.noise, [i])
        for i in range(len(samples.runs))
    ]
    # Each parameter has its own scale, since the units differ.
    influence = [
        j[:, sensitive] @ (covariance / np.sqrt(np.maximum(np.diag(covariance), 1e-300)))
        for _, j in parts
    ]
    innovations = [r for r, _ in parts]
    ratios = []
    for k in range(len(covariance)):
        directions = [a[:, k] for a in influence]
        within = score_inflation(directions, innovations, samples.steps_s, settings)
        between = cluster_inflation(directions, innovations, within, settings)
        ratios.append(np.sqrt(max(within, between)))
    return np.array(ratios)


def _separate(normal: Array) -> Mask:
    """Mask of the parameters that are part of no unidentifiable combination."""
    sizes, axes = np.linalg.eigh(normal)
    unseen = axes[:, sizes * SINGULAR < sizes[-1]]
    return np.asarray(np.linalg.norm(unseen, axis=1) < TAKES_PART)


def doubtful_errors(
    problem: Problem, solution: Solution, parameters: Mapping[str, ParameterValue]
) -> tuple[str, ...]:
    """Names of estimated parameters whose standard error is not valid.

    Notes
    -----
    The log likelihood is evaluated one standard error away from the estimate, with the other
    parameters at their conditional maximum. If it is quadratic, it decreases by one half. The
    likelihood of a drive with a resonance has many adjacent maxima, and the width of one of them is
    not a standard error.
    """
    errors = standard_errors(problem, solution)
    x = problem.encode(solution.values)
    sd = np.where(errors.separate, errors.sd, np.nan)
    for k, i in enumerate(problem.open):
        # A parameter at a bound remains there if another parameter is displaced.
        page = problem.parameters[problem.names[i]]
        if bound_note(page, float(solution.values[i]), errors.error(k)) is not None:
            sd[k] = np.nan
    low, high = problem.encode(problem.lower), problem.encode(problem.upper)
    doubtful = []
    # For effects whose likelihood has many maxima, the check at one standard error may reach only
    # one of the maxima.
    many = {effect for effect in problem.effects if find_effect(effect).peaks}
    for k, i in enumerate(problem.open):
        # Conditional maximum of the likelihood for a displacement of this parameter by one standard
        # error, to first order.
        direction = errors.correlation[:, k] * sd
        if parameters[problem.names[i]].held:
            continue
        if problem.names[i].split(".")[0] in many:
            doubtful.append(problem.names[i])
            continue
        direction = np.where(np.isfinite(direction), direction, 0.0)
        for side in (1.0, -1.0):
            displaced = x + side * direction
            if np.any((displaced <= low) | (displaced >= high)):
                continue
            residuals = problem.residuals(problem.decode(displaced, solution.values))
            rise = solution.samples.cost(residuals, solution.noise) - solution.cost
            if abs(rise - 1.0) > BENT:
                doubtful.append(problem.names[i])
                break
    return tuple(doubtful)
