"""Parameters that nothing in the runs depends on, put back where they started.

A search takes them anywhere. Of such a wild number a reader, a model file or a firmware would make
something; where they started is at least a guess. An effect that ended next to its null goes there.
Nothing is put back that would change what the model predicts where samples count.
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
"""Predictions are the same where they differ by no more than this share of the residual,"""
SAME_IN_FRICTION = 1e-9
"""or of the friction itself."""
SLIDING = {"F_s_n": "F_c_n"}
"""The breakaway force of a law, and the sliding one that it is without a peak."""
SHARES = (1.0, 0.5, 0.25, 0.125)
"""How much of the way back is tried: where the start itself predicts otherwise, part of the way may
still leave a number less wild."""


@dataclass(frozen=True, eq=False)
class PutBack:
    """A solution without wild numbers.

    Attributes
    ----------
    values
        Parameter values, shape (k,).
    residuals
        Record minus prediction at these, N, one array a run.
    notes
        Parameter name to why it is held, of those looked at here.
    """

    values: Array
    residuals: Sequence[Array]
    notes: dict[str, str]


def put_back(
    problem: Problem, solution: Solution, spread: Spread, start: Mapping[str, float]
) -> PutBack:
    """Idle effects to their null, and what never moved towards where it changes nothing.

    Parameters
    ----------
    start
        Where the user had the search start, by full name; where the pages say by default.
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
            there[i] = _on_the_way(page, value, home, share)
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
    """The value at which a parameter changes nothing, or where it started.

    A breakaway force without evidence of a peak is the sliding one.
    """
    page, sliding = problem.parameters[name], SLIDING.get(name)
    if sliding in problem.parameters:
        return float(np.clip(values[problem.names.index(sliding)], page.lower, page.upper))
    return page.starts[0] if page.null is None else page.null


def _on_the_way(page: Parameter, value: float, home: float, share: float) -> float:
    """So much of the way home, in the search's variable; an infinite home is reached or not."""
    if share == 1.0 or not np.isfinite(home):
        return home if share == 1.0 else value
    if page.log:
        return float(value * (home / value) ** share)
    return value + share * (home - value)


def _same(problem: Problem, solution: Solution, values: Array) -> list[Array] | None:
    """The residuals at these values, if the model predicts as the solution does."""
    residuals = problem.residuals(values)
    samples = solution.samples
    gaps = [a - b for a, b in zip(residuals, solution.residuals, strict=True)]
    friction = [p.friction_n for p in problem.campaign.prepared]
    allowed = SAME_IN_NOISE**2 * samples.square(solution.residuals)
    allowed += SAME_IN_FRICTION**2 * samples.square(friction)
    gap = samples.square(gaps)
    return residuals if np.isfinite(gap) and gap <= allowed else None
