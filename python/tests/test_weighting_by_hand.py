"""Robust weights that follow their residuals, by made-up searches."""

from __future__ import annotations

import sys
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from by_hand import Array
from jbf.estimation.minimum import MAX_EVALUATIONS
from jbf.estimation.noise import WHITE
from jbf.estimation.solution import Solution
from jbf.estimation.weighting import ROUNDS, _better, _robust, huber, student
from made_of import record, samples_of

module = sys.modules["jbf.estimation.weighting"]
SHAPE = np.array([1.0, -2.0, 3.0, -4.0, 50.0, 0.0])
COUNTED = np.array([1, 1, 1, 1, 1, 0])
WEIGHT = np.array([1.0, 0.5, 1.0, 1.0, 1.0, 0.0])


def solution(residuals: Array, at: float = 0.0) -> Solution:
    samples = samples_of([record(0.02 * np.arange(6))], [COUNTED], [WEIGHT])
    return Solution((), np.array([at]), [residuals], [], WHITE, 0.0, True, "", samples)


class Rounds:
    """Each search moves the value on by one, and halves all residuals but the wild one."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.weights: list[Array] = []
        monkeypatch.setattr(module, "search", self.search)

    def search(self, problem: Any, samples: Any, start: Array, noise: Any, evaluations: int) -> Any:
        assert (noise, evaluations) == (WHITE, MAX_EVALUATIONS)
        assert start[0] == len(self.weights)
        self.weights.append(samples.weight[0])
        return SimpleNamespace(values=start + 1.0, converged=True, message="ended")

    def wrapped(self, values: Array) -> Array:
        return values

    def solution(self, values: Array, samples: Any, *told: Any) -> Solution:
        residuals = SHAPE * np.where(np.abs(SHAPE) < 40.0, 0.5 ** values[0], 1.0)
        return solution(residuals, float(values[0]))


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("weights", [huber, student])
def test_weights_follow_the_residuals_for_four_rounds(
    unit: float, weights: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Residuals in deviations that their median tells, of those that count; beside the weights that
    samples have."""
    problem: Any = Rounds(monkeypatch)
    found = _robust(problem, solution(unit * SHAPE), weights)
    assert ROUNDS == len(problem.weights) == 4
    assert found.values.tolist() == [4.0]
    # The first of 1, 2, 3, 4 and 50 in units of 3 / 0.6745.
    off = np.abs(SHAPE) / (3.0 / 0.6745)
    assert problem.weights[0] == pytest.approx(WEIGHT * weights(off))
    # Then the wild one is twice as far off as before, in such units.
    second = np.where(np.abs(SHAPE) < 40.0, off, 2.0 * off)
    assert problem.weights[1] == pytest.approx(WEIGHT * weights(second))


def test_without_residuals_there_is_nothing_to_follow(monkeypatch: pytest.MonkeyPatch) -> None:
    problem: Any = Rounds(monkeypatch)
    exact = solution(np.array([0.0, 0.0, 0.0, 1.0, 2.0, 9.0]))
    assert _robust(problem, exact, huber) is exact
    nothing = solution(SHAPE)
    none = samples_of([record(0.02 * np.arange(6))], [np.zeros(6)])
    assert problem.weights == []
    empty = Solution((), nothing.values, [SHAPE], [], WHITE, 0.0, True, "", none)
    assert _robust(problem, empty, huber) is empty


def test_of_errors_that_are_mostly_nothing_squares_decide() -> None:
    left = np.array([0.0, 0.0, 0.0, 3.0])
    assert _better(0.9 * left, left)
    # A middle of nothing is no more than any.
    assert _better(0.99 * left, left)
    assert not _better(1.1 * left, left)
    assert not _better(left, np.zeros(4))


@pytest.mark.parametrize("unit", [1e-9, 1.0, 1e9])
def test_a_middle_is_smaller_by_its_share(unit: float) -> None:
    left = unit * np.array([1.0, -1.0, 1.0, 1e3, -1e3])
    assert not _better(np.array([0.9, 0.9, 0.9, 1.0, 1.0]) * left, left)
    assert _better(np.array([0.7, 0.7, 0.7, 1.0, 1.0]) * left, left)
