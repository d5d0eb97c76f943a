"""When one step of Gauss and Newton is the whole way to a fit without a run, and what is known of
the halves of one: by made-up fits."""

from __future__ import annotations

import sys
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from by_hand import Array
from jbf.estimation.between_runs import BetweenRuns
from jbf.estimation.left_out import (
    EVALUATIONS,
    LeftOut,
    _predicted,
    _Told,
    errors_by_run,
    halves_left_out,
    left_out_by_run,
    left_out_residuals,
    left_out_rms,
)
from jbf.estimation.noise import WHITE
from jbf.estimation.solution import Solution
from made_of import record, samples_of

module = sys.modules["jbf.estimation.left_out"]
N = 6
HERE, STEP = np.array([1.0, 2.0]), np.array([0.25, -0.5])
FAR = 9.0
"""Values from which on the made-up problem has its bound."""


def solution(effects: tuple[str, ...] = (), converged: bool = True) -> Solution:
    runs = [record(0.02 * np.arange(N), name=name) for name in "ab"]
    jacobian = [np.ones((N, 2)), np.ones((N, 2))]
    left = [np.zeros(N)] * 2
    return Solution(effects, HERE, left, jacobian, WHITE, 0.0, converged, "", samples_of(runs))


class Fits:
    """A problem of two parameters; what was predicted, and where searches began and ended."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, squares: dict[float, float]) -> None:
        self.searched: list[Array] = []
        self.names, self.open = ["a", "b"], [0, 1]
        self.campaign = SimpleNamespace(prepared=["a", "b"], only=lambda rest: rest)
        part = SimpleNamespace(open=[0], square=lambda values, kept: squares[float(values[0])])
        monkeypatch.setattr(module, "_of", lambda problem, campaign, held: part)
        monkeypatch.setattr(module, "search", self.search)

    def search(self, part: Any, kept: Any, start: Array, noise: Any, evaluations: int) -> Any:
        assert evaluations == EVALUATIONS == 12
        assert kept.runs == ("b",)
        self.searched.append(start)
        return SimpleNamespace(values=np.array([100.0, 100.0]))

    def encode(self, values: Array) -> Array:
        return np.minimum(values, FAR)

    def decode(self, x: Array, base: Array) -> Array:
        return np.minimum(x, FAR)

    def residuals(self, values: Array, which: list[int]) -> list[Array]:
        assert which == [0]
        return [np.full(N, values[0])]


@pytest.mark.parametrize(
    ("square", "way", "straight", "effects", "converged", "stepped"),
    [
        (1.0, STEP, True, (), True, True),
        # Three standard deviations of either parameter, and no more.
        (18.0, STEP, True, (), True, True),
        (18.001, STEP, True, (), True, False),
        # A step that would leave the bounds; one that bends; one of a search that had not ended.
        (1.0, np.array([9.0, 0.0]), True, (), True, False),
        (1.0, STEP, False, (), True, False),
        (1.0, STEP, True, (), False, False),
        # A drive that rings has peak beside peak.
        (1.0, STEP, True, ("drive_compliance",), True, False),
        (1.0, STEP, True, ("sensor_offset",), True, True),
    ],
)
@pytest.mark.parametrize("better", [True, False])
def test_a_short_and_straight_step_is_the_whole_way(
    square: float,
    way: Array,
    straight: bool,
    effects: tuple[str, ...],
    converged: bool,
    stepped: bool,
    better: bool,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Else a search goes on from its end, or from the whole's solution where that is better."""
    end = float(min(HERE[0] + way[0], FAR))
    problem: Any = Fits(monkeypatch, {1.0: 5.0, end: 4.0 if better else 6.0})
    monkeypatch.setattr(module, "_straight", lambda *given: straight)
    told: Any = SimpleNamespace(known=np.ones((2, 2)), step=lambda rest: (way, square))
    (found,) = _predicted(problem, solution(effects, converged), told, [0], [1])
    if stepped:
        assert (float(found[0]), problem.searched) == (end, [])
    else:
        assert float(found[0]) == 100.0
        assert [float(start[0]) for start in problem.searched] == [end if better else 1.0]


def test_where_no_sample_was_left_out_nothing_is_wrong(monkeypatch: pytest.MonkeyPatch) -> None:
    none: Any = None
    for left, rms in (([], 0.0), ([0.0], 0.0), ([3.0], 3.0), ([3.0, 4.0], np.sqrt(12.5))):
        parts = [np.array(left), np.zeros(0)]
        monkeypatch.setattr(module, "left_out_by_run", lambda *given, parts=parts, **more: parts)
        assert left_out_rms(none, none) == pytest.approx(rms)


def test_what_only_runs_that_were_left_out_know_is_held(monkeypatch: pytest.MonkeyPatch) -> None:
    """No step is tried then; a search begins where what was held is put back."""
    problem: Any = Fits(monkeypatch, {})
    asked: list[list[bool]] = []

    def held(problem: Any, unknown: Array) -> dict[str, float]:
        asked.append(unknown.tolist())
        return {"b": 0.5}

    monkeypatch.setattr(module, "_held", held)
    none: Any = None
    told: Any = SimpleNamespace(known=np.array([[1.0, 1.0], [1.0, 0.0]]), step=none)
    (found,) = _predicted(problem, solution(), told, [0], [1])
    assert asked == [[False, True]]
    assert [start.tolist() for start in problem.searched] == [[1.0, 0.5]]
    assert found.tolist() == [100.0] * N


def test_a_step_of_one_innovation_is_as_long_as_its_noise() -> None:
    told = _Told(np.ones((1, 1)), [(np.array([3.0, 0.0]), np.array([[2.0], [0.0]]))], [1])
    step, square = told.step([0])
    assert (step.tolist(), square) == ([1.5], 1.0)


def test_a_step_without_residuals_is_none() -> None:
    told = _Told(np.ones((1, 1)), [(np.zeros(2), np.ones((2, 1)))], [0])
    step, square = told.step([0])
    assert (step.tolist(), square) == ([0.0], 0.0)


def test_of_a_half_that_alone_knows_a_parameter_the_other_tells_nothing(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The first parameter shows everywhere, the second in the first half of the second run: up and
    down by as much."""
    runs = [record(0.02 * np.arange(N), name=name) for name in "abc"]
    own = np.stack([np.ones(N), [1.0, -1.0, 0.0, 0.0, 0.0, 0.0]], axis=1)
    other = np.stack([np.ones(N), np.zeros(N)], axis=1)
    jacobian = [other, own, other]
    there = Solution((), HERE, [np.zeros(N)] * 3, jacobian, WHITE, 0.0, True, "", samples_of(runs))
    kept: list[Any] = []

    def fitted(part: Any, samples: Any, start: Array, near: Any) -> Array:
        kept.append(samples)
        return np.full(2, float(len(kept)))

    monkeypatch.setattr(module, "_of", lambda problem, campaign, held: None)
    monkeypatch.setattr(module, "_held", lambda problem, unknown: {})
    monkeypatch.setattr(module, "_at", lambda problem, solution, held: HERE)
    monkeypatch.setattr(module, "_fitted", fitted)
    problem: Any = SimpleNamespace(
        campaign=None, residuals=lambda values, which: [np.full(N, values[0])]
    )
    parts = halves_left_out(problem, there, 1)
    first = np.arange(N) < 3
    assert [part.told.tolist() for part in parts] == [[True, False], [True, True]]
    assert [part.left[0].tolist() for part in parts] == [first.tolist(), (~first).tolist()]
    assert [part.runs for part in parts] == [(1,), (1,)]
    assert [float(part.residuals[0][0]) for part in parts] == [1.0, 2.0]
    assert [s.counted[1].tolist() for s in kept] == [(~first).tolist(), first.tolist()]
    assert all(s.counted[0].all() and s.counted[2].all() for s in kept)


def test_what_runs_deviate_by_is_taken_off_where_that_is_asked_for(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A zero of a run's own, 2 N, far larger than its noise: no model predicts it, and no more than
    a hundredth of it is left."""
    between = BetweenRuns(("zero",), (np.full((N, 1), 50.0),) * 2, 1.0)
    there = replace(solution(), samples=replace(solution().samples, between=between))
    every = np.ones(N, dtype=bool)
    parts = [LeftOut((i,), (every,), np.ones(2, dtype=bool), (np.full(N, 2.0),)) for i in (0, 1)]
    monkeypatch.setattr(module, "left_out", lambda problem, solution: parts)
    problem: Any = None
    for apart, rms in (({}, 2.0), ({"apart": False}, 2.0), ({"apart": True}, 0.0)):
        assert left_out_rms(problem, there, **apart) == pytest.approx(rms, abs=0.02)
        by_run = left_out_by_run(problem, there, **apart)
        assert [float(e[0]) for e in by_run] == pytest.approx([rms] * 2, abs=0.02)
        errors = errors_by_run(there, parts, **apart)
        assert float(errors[1][3]) == pytest.approx(rms, abs=0.02)
    assert left_out_residuals(problem, there).tolist() == [2.0] * (2 * N)
