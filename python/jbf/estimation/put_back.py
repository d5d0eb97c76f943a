"""Reset of parameters on which nothing in the runs depends to their starting values.

A search may move such parameters anywhere. A reader, a model file or firmware would interpret the
arbitrary number; the starting value is at least a guess. An effect that ended next to its null is
set to it. Nothing is reset that would change the prediction at the samples that count.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from jbf.estimation.determined import NEVER_MOVED, NO_EFFECT, idle_effects
from jbf.estimation.problem import Problem
from jbf.estimation.solution import Solution
from jbf.estimation.spread import Spread
from jbf.models.catalogue import Parameter

Array = npt.NDArray[np.float64]

SAME_IN_NOISE = 1e-4
"""Largest difference of equal predictions, as a fraction of the residual.

It is a numerical tolerance.
"""
SAME_IN_FRICTION = 1e-9
"""Largest difference of equal predictions, as a fraction of the friction.

It is a numerical tolerance.
"""
SLIDING = {"F_s": "F_c"}
"""Breakaway force of a law, and the sliding force that it equals without a peak."""
SHARES = (1.0, 0.5, 0.25, 0.125)
"""Fractions of the distance to the start that are tried.

If the starting value itself changes the prediction, a partial reset may still give a less extreme
value. It is a numerical resolution.
"""


@dataclass(frozen=True, eq=False)
class PutBack:
    """A solution without arbitrary parameter values.

    Attributes
    ----------
    values
        Parameter values, shape (k,).
    residuals
        Record minus prediction at these values, N, one array a run.
    notes
        Parameter name to the reason why it is held, for the parameters considered here.
    """

    values: Array
    residuals: Sequence[Array]
    notes: dict[str, str]


def put_back(
    problem: Problem, solution: Solution, spread: Spread, start: Mapping[str, float]
) -> PutBack:
    """Set idle effects to their null, and unidentified parameters towards a neutral value.

    Parameters
    ----------
    start
        The user's starting values by full name; by default those of the catalogue.
    """
    found = PutBack(solution.values, solution.residuals, {})
    found = _idle_to_null(found, problem, solution, spread, start)
    for k, i in enumerate(problem.open):
        name = problem.names[i]
        if spread.moved[k] or name in found.notes:
            continue
        page, value = problem.parameters[name], float(found.values[i])
        home = start.get(name, _home(problem, name, found.values))
        note = f"flat here: these runs tell only that it is not {home:.3g}"
        for share in SHARES:
            there = found.values.copy()
            there[i] = _moved_towards(page, value, home, share)
            residuals = _same(problem, solution, there)
            if residuals is not None:
                note = NEVER_MOVED if share == 1.0 else note
                found = PutBack(there, residuals, found.notes)
                break
        found = PutBack(found.values, found.residuals, {**found.notes, name: note})
    return found


def _idle_to_null(
    found: PutBack,
    problem: Problem,
    solution: Solution,
    spread: Spread,
    start: Mapping[str, float],
) -> PutBack:
    errors = {problem.names[i]: spread.error(k) for k, i in enumerate(problem.open)}
    idle = idle_effects(
        problem.effects, problem.parameters, solution.values.tolist(), errors, problem.fixed
    )
    for effect in idle:
        own = [i for i in problem.open if problem.names[i].startswith(f"{effect}.")]
        there = found.values.copy()
        for i in own:
            name, page = problem.names[i], problem.parameters[problem.names[i]]
            there[i] = start.get(name, page.starts[0]) if page.null is None else page.null
        residuals = _same(problem, solution, there)
        if residuals is not None:
            notes = dict.fromkeys((problem.names[i] for i in own), NO_EFFECT)
            found = PutBack(there, residuals, {**found.notes, **notes})
    return found


def _home(problem: Problem, name: str, values: Array) -> float:
    """Value at which a parameter changes nothing, or its starting value.

    A breakaway force without evidence of a peak equals the sliding force.
    """
    page, sliding = problem.parameters[name], SLIDING.get(name)
    if sliding in problem.parameters:
        return float(np.clip(values[problem.names.index(sliding)], page.lower, page.upper))
    return page.starts[0] if page.null is None else page.null


def _moved_towards(page: Parameter, value: float, home: float, share: float) -> float:
    """Move a value by a fraction of the distance to `home`, in the search variable.

    An infinite `home` is reached only with a fraction of one.
    """
    if share == 1.0 or not np.isfinite(home):
        return home if share == 1.0 else value
    if page.log:
        return float(value * (home / value) ** share)
    return value + share * (home - value)


def _same(problem: Problem, solution: Solution, values: Array) -> list[Array] | None:
    """Residuals at these values if the prediction equals that of the solution, otherwise None."""
    residuals = problem.residuals(values)
    samples = solution.samples
    gaps = [a - b for a, b in zip(residuals, solution.residuals, strict=True)]
    friction = [p.friction for p in problem.campaign.prepared]
    allowed = SAME_IN_NOISE**2 * samples.square(solution.residuals)
    allowed += SAME_IN_FRICTION**2 * samples.square(friction)
    gap = samples.square(gaps)
    return residuals if np.isfinite(gap) and gap <= allowed else None
