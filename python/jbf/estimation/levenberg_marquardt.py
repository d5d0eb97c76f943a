"""Nonlinear least squares within bounds by the Levenberg-Marquardt method.

A step s minimises ``|r - J s|^2 + d |D s|^2`` within the bounds, for residuals r, the Jacobian J of
the prediction, damping d, and the largest norms D of the columns of J so far. The inner problem is
solved by an active-set method. A variable at its bound does not shorten the step of the others,
unlike in `dogbox` of scipy, which may then end far from a minimum.

If a function for the residuals alone is given, the Jacobian is kept (as in a chord method) while
the ratio of actual to predicted decrease is close to one, since residuals cost less.

References
----------
Nielsen, Damping parameter in Marquardt's method, IMM-REP-1999-05, Technical University of Denmark.
Stark & Parker, Bounded-variable least-squares, Computational Statistics 10 (1995), 129-141.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy import optimize

from jbf.arrays import Array
from jbf.estimation.least_squares import triangular

INITIAL_DAMPING = 1e-4
"""Damping of the first step, relative to the squares of the columns of the Jacobian."""
LEAST_FACTOR = 1.0 / 3.0
"""Smallest factor on the damping after an accepted step. The factor is 1 - (2 r - 1)^3 for a ratio
r of actual to predicted decrease, at most 2 (Nielsen 1999)."""
FIRST_INCREASE = 8.0
"""Factor by which the first rejected step increases the damping; it doubles at each further one."""
MAX_DAMPING = 1e10
"""Damping at which a search ends, because no step reduces the sum of squares."""
ACCEPTED = 1e-4
"""Smallest ratio of actual to predicted decrease of an accepted step."""
TRUSTED = 0.25
"""Ratio of actual to predicted decrease above which a small decrease ends the search."""
ACCURATE = 0.25
"""Largest difference from one of the ratio of actual to predicted decrease of a step, at which the
Jacobian is kept for the next step."""
RESIDUALS_COST = 0.2
"""Computing cost of residuals relative to that of residuals and Jacobian with ten parameters."""
SMALL_DECREASE = "the sum of squares decreases by less than the tolerance"
"""Message of a search that has converged."""


@dataclass(frozen=True)
class SearchResult:
    """End of a search: values, whether they are a minimum, and why the search ended."""

    values: Array
    converged: bool
    message: str


def minimise(
    evaluate: Callable[[Array], tuple[Array, Array]],
    start: Array,
    bounds: tuple[Array, Array],
    longest: Array,
    evaluations: int,
    tolerance: float,
    residuals: Callable[[Array], Array] | None = None,
) -> SearchResult:
    """Minimise the sum of squares of residuals within bounds.

    Parameters
    ----------
    evaluate
        Function of the variables, shape (p,). It returns the residuals (measured minus predicted),
        shape (n,), and the Jacobian of the prediction, shape (n, p).
    start
        Variables at the beginning, within the bounds.
    bounds
        Lower and upper bounds, each of shape (p,); lower < upper.
    longest
        Largest change of each variable in one step; it may be infinite.
    evaluations
        Maximum number of calls of `evaluate`, without the final one. A call of `residuals` counts
        as the fraction `RESIDUALS_COST` of one.
    tolerance
        Relative decrease of the sum of squares, predicted or achieved by a step, below which the
        search has converged.
    residuals
        Function that returns the residuals without the Jacobian. If it is given, steps are tested
        with it, and the Jacobian is kept while it predicts the decrease well (`ACCURATE`). The last
        call of `evaluate` is at the variables of the result.

    Returns
    -------
    SearchResult
        The variables with the smallest sum of squares, and why the search ended.
    """
    low, high = bounds
    x = start
    residual, jacobian = evaluate(x)
    reduced, factor = triangular(residual, jacobian)
    jacobian_is_current = True
    norms = np.zeros(len(x))
    damping, increase, spent = INITIAL_DAMPING, FIRST_INCREASE, 1.0
    converged, message = False, "the maximum number of evaluations is reached"
    while spent < evaluations:
        norms = np.maximum(norms, np.linalg.norm(factor, axis=0))
        square = float(reduced @ reduced)
        within = np.maximum(low - x, -longest), np.minimum(high - x, longest)
        step = bounded_step(reduced, factor, norms, within, damping)
        linear = reduced - factor @ step
        predicted = square - float(linear @ linear)
        step_is_current, ratio = jacobian_is_current, -1.0
        if predicted <= tolerance * square:
            if jacobian_is_current:
                converged, message = True, SMALL_DECREASE
                break
        else:
            trial = np.clip(x + step, low, high)
            if residuals is None:
                new_residual, new_jacobian = evaluate(trial)
                spent += 1.0
            else:
                new_residual, new_jacobian = residuals(trial), jacobian
                spent += RESIDUALS_COST
            decrease = square - float(new_residual @ new_residual)
            ratio = decrease / predicted if np.isfinite(decrease) else -1.0
        if ratio > ACCEPTED:
            x, residual, jacobian = trial, new_residual, new_jacobian
            jacobian_is_current = residuals is None
            damping *= max(LEAST_FACTOR, 1.0 - (2.0 * ratio - 1.0) ** 3)
            increase = FIRST_INCREASE
            if decrease <= tolerance * square and ratio > TRUSTED and step_is_current:
                converged, message = True, SMALL_DECREASE
                break
        elif step_is_current:
            damping *= increase
            increase *= 2.0
            if damping > MAX_DAMPING:
                converged, message = np.isfinite(decrease), "no step decreases the sum of squares"
                break
            continue
        if not jacobian_is_current and abs(ratio - 1.0) > ACCURATE:
            residual, jacobian = evaluate(x)
            jacobian_is_current = True
            spent += 1.0
        reduced, factor = triangular(residual, jacobian)
    if not jacobian_is_current:
        evaluate(x)
    return SearchResult(x, bool(converged), message)


def bounded_step(
    residual: Array,
    jacobian: Array,
    norms: Array,
    within: tuple[Array, Array],
    damping: float,
) -> Array:
    """Minimum of the damped linear model within an interval of each variable.

    The damping is relative to the squares of `norms`. It must be positive where the data may not
    determine all variables.
    """
    scale = np.where(norms > 0.0, norms, 1.0)
    damped = np.vstack([jacobian / scale, np.sqrt(damping) * np.eye(len(scale))])
    target = np.concatenate([residual, np.zeros(len(scale))])
    low, high = (limit * scale for limit in within)
    inner = optimize.lsq_linear(damped, target, (low, high), method="bvls")
    return np.asarray(inner.x / scale)
