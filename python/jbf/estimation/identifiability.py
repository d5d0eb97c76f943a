"""Detection of parameters that are not identifiable; they are held fixed, with a reason.

The value of a held parameter is used for prediction only and is not an estimate. If the predictions
do not depend on a parameter near the solution, the search may end at an arbitrary value. It is
therefore reset to a neutral one, unless the deviance (minus twice the log likelihood) increases by
more than `MAX_DEVIANCE_INCREASE`. Other held parameters keep the value at the end of the search.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from jbf.arrays import Array
from jbf.estimation.bounds import at_bound, bound_note
from jbf.estimation.problem import Problem
from jbf.estimation.solution import Solution
from jbf.estimation.standard_errors import StandardErrors
from jbf.models.catalogue import Parameter
from jbf.models.parameter_value import ParameterValue

HELD = "held at the given value"
"""Note of a parameter that was not fitted."""
STATED = "not fitted: a given value, or a reference taken from the runs"
"""Note of a number that is given, or taken from the runs, and not fitted."""
NOT_DETERMINED = "not determined by these runs"
NOT_SEPARATE = "not identifiable: another parameter has the same effect in these runs"
NO_EFFECT = "at its null: no effect"
ONE_SIDED = 2.0
"""Standard errors added to the value of a scale for its upper limit."""
MAX_DEVIANCE_INCREASE = 0.1
"""Largest increase of the deviance due to all resets together. If the likelihood is quadratic, it
corresponds to a change of one parameter by 0.32 standard errors."""
SAME_IN_FRICTION = 1e-9
"""RMS difference of predictions, relative to the RMS friction, below which they are equal.

It matters only for records without noise, where any difference changes the likelihood."""
SLIDING = {"F_s": "F_c"}
"""Breakaway force of a law, and the sliding force to which it is equal without a Stribeck peak."""
SHARES = (1.0, 0.5, 0.25, 0.125)
"""Fractions of the distance to the neutral value by which a reset is tried. If the neutral value
itself is less likely, a partial reset may still give a less extreme value."""


def reason_not_identifiable(
    page: Parameter, value: float, error: float, *, sensitive: bool = True, separate: bool = True
) -> str | None:
    """Reason why a fitted parameter is not identifiable; None if it is identifiable.

    The value and its standard error are in the parameter's unit; the error is nan if it is unknown.
    `sensitive` states whether the predictions for the runs depend on the parameter, and `separate`
    whether it can be distinguished from all other parameters.
    """
    if not sensitive:
        return NOT_DETERMINED
    note = bound_note(page, value, error)
    if note is None and not separate:
        note = NOT_SEPARATE
    return note or _exceeds_itself(page, value, error)


def _exceeds_itself(page: Parameter, value: float, error: float) -> str | None:
    """Note if the standard error of a positive parameter exceeds its value, otherwise None.

    The order of magnitude of a positive (scale) parameter is undetermined if the error exceeds the
    value. A signed parameter may be zero within its error.
    """
    if not (page.log or page.lower == 0.0) or not error > abs(value):
        return None
    reason = f"not determined: its standard error, {error:.2g}, exceeds its value"
    most = value + ONE_SIDED * error
    # For a logarithmic parameter with such an error, neither limit of the interval is valid.
    if page.log or most >= page.upper:
        return reason
    return f"{reason}; it is below {most:.2g}"


def idle_effects(
    effects: Collection[str],
    pages: Mapping[str, Parameter],
    values: Iterable[float],
    errors: Mapping[str, float] | None = None,
    fixed: Collection[str] = (),
) -> tuple[str, ...]:
    """Effects whose fitted parameters have their null values, so that they have no influence.

    `pages` has the catalogue entries by full parameter name, and `values` is in the same order. The
    standard errors, where they are known, are by full name. `fixed` has the names of parameters
    that were not fitted.
    """
    errors, named = errors or {}, list(zip(pages.items(), values, strict=True))

    def idle(effect: str) -> bool:
        """Whether all parameters of the effect that have a null are at it."""
        null = [
            at_null(page, value, errors.get(name, math.nan), fixed=name in fixed)
            for (name, page), value in named
            if page.null is not None and name.startswith(f"{effect}.")
        ]
        return bool(null) and all(null)

    return tuple(filter(idle, effects))


def at_null(page: Parameter, value: float, error: float = math.nan, *, fixed: bool = False) -> bool:
    """Whether a value is at its parameter's null, the value without influence.

    A fit stops at a null that is a bound, or at the bound next to an infinite null. A null between
    the bounds does not stop a fit: an estimate there is an ordinary estimate with an error.
    """
    if page.null is None or fixed:
        return value == page.null
    if page.lower < page.null < page.upper:
        return False
    bound = page.lower if page.null <= page.lower else page.upper
    return value == page.null or at_bound(page, value, bound, error)


@dataclass(frozen=True, eq=False)
class Reset:
    """Solution in which unidentifiable parameters have neutral values.

    Attributes
    ----------
    values
        Parameter values, shape (k,).
    residuals
        Record minus prediction at these values, N, one array per run.
    notes
        Parameter name to the reason why it is held, for the parameters considered here.
    """

    values: Array
    residuals: Sequence[Array]
    notes: dict[str, str]


def reset_unidentified(
    problem: Problem, solution: Solution, errors: StandardErrors, start: Mapping[str, float]
) -> Reset:
    """Set effects without influence to their null, and parameters without it to neutral values.

    `start` has the user's starting values by full name; the others are those of the catalogue.
    """
    values = solution.values
    notes: dict[str, str] = {}
    residuals: Sequence[Array] = solution.residuals
    by_name = {problem.names[i]: errors.error(k) for k, i in enumerate(problem.open)}
    idle = idle_effects(
        problem.effects, problem.parameters, values.tolist(), by_name, problem.fixed
    )
    for effect in idle:
        indices = [i for i in problem.open if problem.names[i].startswith(f"{effect}.")]
        trial = values.copy()
        for i in indices:
            name, page = problem.names[i], problem.parameters[problem.names[i]]
            trial[i] = start.get(name, page.starts[0]) if page.null is None else page.null
        accepted = _equally_likely(problem, solution, trial)
        if accepted is not None:
            values, residuals = trial, accepted
            notes |= dict.fromkeys((problem.names[i] for i in indices), NO_EFFECT)
    for k, i in enumerate(problem.open):
        name = problem.names[i]
        if errors.sensitive[k] or name in notes:
            continue
        page, value = problem.parameters[name], float(values[i])
        neutral = start.get(name, _neutral(problem, name, values))
        notes[name] = f"not determined: its neutral value, {neutral:.3g}, is less likely"
        for share in SHARES:
            trial = values.copy()
            trial[i] = _moved_towards(page, value, neutral, share)
            accepted = _equally_likely(problem, solution, trial)
            if accepted is not None:
                values, residuals = trial, accepted
                if share == 1.0:
                    notes[name] = NOT_DETERMINED
                break
    return Reset(values, residuals, notes)


def _neutral(problem: Problem, name: str, values: Array) -> float:
    """Value at which a parameter has no influence; its starting value if there is none.

    A breakaway force without evidence of a peak equals the sliding force.
    """
    page, sliding = problem.parameters[name], SLIDING.get(name)
    if sliding in problem.parameters:
        return float(np.clip(values[problem.names.index(sliding)], page.lower, page.upper))
    return page.starts[0] if page.null is None else page.null


def _moved_towards(page: Parameter, value: float, target: float, share: float) -> float:
    """Move a value by the fraction `share` of the distance to `target`, in the search variable.

    An infinite `target` is reached only if the fraction is one.
    """
    if share == 1.0 or not np.isfinite(target):
        return target if share == 1.0 else value
    if page.log:
        return float(value * (target / value) ** share)
    return value + share * (target - value)


def _equally_likely(problem: Problem, solution: Solution, values: Array) -> list[Array] | None:
    """Residuals at these values if the deviance increases by at most `MAX_DEVIANCE_INCREASE`."""
    residuals = problem.residuals(values)
    samples = solution.samples
    gaps = [a - b for a, b in zip(residuals, solution.residuals, strict=True)]
    friction = [p.friction for p in problem.campaign.prepared]
    if samples.square(gaps) <= SAME_IN_FRICTION**2 * samples.square(friction):
        return residuals
    # The comparison is false for predictions that are not finite.
    loss = samples.cost(residuals, solution.noise) - solution.cost
    return residuals if loss <= MAX_DEVIANCE_INCREASE else None


def parameter_values(
    problem: Problem, reset: Reset, errors: StandardErrors
) -> dict[str, ParameterValue]:
    """Return values with standard errors by name; unidentifiable parameters are marked as held."""
    results = {}
    values = reset.values.tolist()
    for i, (name, page) in enumerate(problem.parameters.items()):
        error, note = None, reset.notes.get(name)
        if i not in problem.open:
            note = STATED if page.stated else HELD
        elif note is None:
            k = problem.open.index(i)
            error = errors.error(k)
            separate = bool(errors.separate[k])
            note = reason_not_identifiable(page, values[i], error, separate=separate)
        results[name] = ParameterValue(values[i], None if note else error, note, note is not None)
    return results


def correlations(
    problem: Problem, parameters: dict[str, ParameterValue], errors: StandardErrors
) -> Array:
    """Correlations of the parameters that are not held, in their order, shape (k, k)."""
    kept = [k for k, i in enumerate(problem.open) if not parameters[problem.names[i]].held]
    return np.asarray(errors.correlation[kept][:, kept])
