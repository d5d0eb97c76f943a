"""Where a search starts and which starts it follows, of a made-up problem that is a bowl."""

from __future__ import annotations

import sys
from types import SimpleNamespace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from jbf.estimation.approach import FOLLOWED, LIKELY, MANY, TRIAL_EVALUATIONS, Approach, _log_ratio
from jbf.estimation.noise import WHITE
from jbf.estimation.search import Found

Array = npt.NDArray[np.float64]
module = sys.modules["jbf.estimation.approach"]


class Bowl:
    """A problem of one parameter, whose square is least at a place; several starts."""

    def __init__(self, starts: list[float], at: float = 0.0, *, runs: int = 1) -> None:
        self.at, self.begin, self.asked = at, starts, 0
        self.thinned: Any = self
        self.fixed: dict[str, float] = {}
        self.effects: tuple[str, ...] = ()
        fast = [0.1 * (k + 1) for k in range(runs)]
        prepared = [
            SimpleNamespace(motion=SimpleNamespace(velocity_m_s=np.array([v]))) for v in fast
        ]
        samples = SimpleNamespace(between=None, only=lambda which: SimpleNamespace(square=self.one))
        self.campaign = SimpleNamespace(prepared=prepared, samples=samples)

    def starts(self, seed: Any) -> list[Array]:
        return [np.array([x + seed.get("x", 0.0)]) for x in self.begin]

    def square(self, values: Array, samples: Any = None) -> float:
        self.asked += 1
        return float((values[0] - self.at) ** 2)

    def residuals(self, values: Array, which: list[int]) -> tuple[Array, list[int]]:
        return values, which

    def one(self, told: tuple[Array, list[int]]) -> float:
        """By the fastest run alone the place is one further."""
        assert told[1] == [len(self.campaign.prepared) - 1]
        return float((told[0][0] - self.at - 1.0) ** 2)

    def samples_at(self, values: Array, lines: Any = None) -> str:
        return "samples"

    def wrapped(self, values: Array) -> Array:
        return values

    def solution(self, values: Array, samples: Any, noise: Any, *told: Any) -> Any:
        return SimpleNamespace(values=values, noise=noise, converged=told[0], message=told[1])


def followed(
    monkeypatch: pytest.MonkeyPatch,
    problem: Any,
    *,
    seeds: list[dict[str, float]] | None = None,
    each: bool = False,
    stepped: float | None = None,
    converges: bool = True,
    **more: Any,
) -> tuple[Any, list[tuple[float, int, str]]]:
    """What a search ends with that goes half of its way in a few steps, and all of it in many; and
    each search's start, steps and method."""
    searched: list[tuple[float, int, str]] = []

    def search(
        few: Any, some: Any, start: Array, noise: Any, evaluations: int, *told: Any, **named: Any
    ) -> Found:
        assert noise is WHITE
        searched.append((float(start[0]), evaluations, told[0] if told else "dogbox"))
        share = 1.0 if evaluations > 20 else 0.5
        there = start + share * (problem.at - start)
        return Found(there, converges and share == 1.0, "ended")

    monkeypatch.setattr(module, "search", search)
    monkeypatch.setattr(module, "noise_at", lambda problem, samples, values, lines: "noise")
    last = None if stepped is None else np.array([stepped])
    way = Approach(problem, seeds or [{}], each=each, stepped=last)
    return way.follow(60, **more), searched


def test_the_best_starts_have_a_few_steps_and_the_best_of_them_goes_on(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assert (FOLLOWED, TRIAL_EVALUATIONS) == (2, 6)
    found, searched = followed(monkeypatch, Bowl([8.0, -3.0, 5.0, 1.5]))
    assert searched == [(1.5, 6, "dogbox"), (-3.0, 6, "dogbox"), (0.75, 60, "dogbox")]
    assert found.values.tolist() == [0.0]
    assert (found.converged, found.message, found.noise) == (True, "ended", "noise")
    found, searched = followed(
        monkeypatch, Bowl([8.0, -3.0, 5.0, 1.5]), followed=3, steps=9, method="trf"
    )
    assert searched[:3] == [(1.5, 9, "trf"), (-3.0, 9, "trf"), (5.0, 9, "trf")]
    # By another method it goes on even where it has converged.
    ended, searched = followed(monkeypatch, Bowl([2.0, 1.0]), steps=30, method="trf")
    assert len(searched) == 3
    ended, searched = followed(monkeypatch, Bowl([2.0, 1.0]), steps=30)
    assert len(searched) == 2
    assert ended.converged


def test_one_start_is_followed_to_its_end(monkeypatch: pytest.MonkeyPatch) -> None:
    found, searched = followed(monkeypatch, Bowl([8.0]), least=-1.0)
    assert searched == [(8.0, 60, "dogbox")]
    assert found.converged


@pytest.mark.parametrize(("least", "goes_on"), [(0.5, False), (0.5625, False), (0.57, True)])
def test_what_does_not_come_low_enough_is_not_followed(
    least: float, goes_on: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The best of two ends at 0.75, whose square is 0.5625."""
    found, searched = followed(monkeypatch, Bowl([-3.0, 1.5]), least=least)
    assert len(searched) == 2 + goes_on
    assert (found.message, found.converged) == (
        ("ended", True) if goes_on else ("not followed", False)
    )
    assert found.values.tolist() == ([0.0] if goes_on else [0.75])


def test_a_part_that_converged_is_not_the_whole(monkeypatch: pytest.MonkeyPatch) -> None:
    whole, part = Bowl([8.0]), Bowl([8.0])
    whole.thinned = part
    found, _ = followed(monkeypatch, whole)
    assert not found.converged
    assert found.message == "ended"


def test_starts_are_those_of_all_seeds_or_the_best_of_each(monkeypatch: pytest.MonkeyPatch) -> None:
    seeds = [{"x": 0.0}, {"x": 10.0}]
    every = Approach(Bowl([1.0, 3.0]), seeds)  # type: ignore[arg-type]
    assert [float(s[0]) for s in every.starts] == [1.0, 3.0, 11.0, 13.0]
    best = Approach(Bowl([1.0, 3.0]), seeds, each=True, stepped=np.array([2.0]))  # type: ignore[arg-type]
    assert [float(s[0]) for s in best.starts] == [1.0, 2.0, 11.0]
    _, searched = followed(monkeypatch, Bowl([4.0, 3.0]), stepped=0.5)
    assert searched[0][0] == 0.5


def test_each_start_is_asked_once() -> None:
    problem = Bowl([1.0, 3.0, 5.0])
    way = Approach(problem, [{}])  # type: ignore[arg-type]
    assert len(way.starts) == 3
    assert way._nearest.tolist() == [1.0]
    assert problem.asked == 3


@pytest.mark.parametrize(
    ("count", "runs", "kept"),
    [(24, 3, 24), (25, 3, 24), (25, 1, 25), (144, 3, 24), (150, 3, 25), (240, 2, 40)],
)
def test_of_many_starts_those_stay_that_are_likely_by_the_fastest_run(
    count: int, runs: int, kept: int
) -> None:
    """One of six, and two dozen at least."""
    assert (MANY, LIKELY) == (24, 6)
    problem = Bowl([float(k) for k in range(count)], runs=runs)
    way = Approach(problem, [{}])  # type: ignore[arg-type]
    starts = [float(s[0]) for s in way.starts]
    assert len(starts) == kept
    # About 1, where that run has its best: 0 to 2, 3, ...
    assert sorted(starts) == [float(k) for k in range(kept)]


def test_ratios_of_nothing_are_finite() -> None:
    assert _log_ratio(4.0, 1.0) == pytest.approx(np.log(4.0))
    assert np.isfinite(_log_ratio(1.0, 0.0))
    assert _log_ratio(0.0, 0.0) == 0.0


@pytest.mark.parametrize("part", [False, True])
def test_what_every_sample_says_where_it_ends_is_not_asked_for_again(
    part: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of a search of the whole; what a part of the runs says is not what all do."""
    problem = Bowl([2.0])
    if part:
        problem.thinned = Bowl([2.0])
    asked: list[Any] = []

    def noted(*given: Any) -> str:
        asked.append(given[-1])
        return "noted"

    monkeypatch.setattr(module, "noise_at", noted)
    monkeypatch.setattr(problem, "samples_at", noted)
    monkeypatch.setattr(problem, "solution", noted)
    monkeypatch.setattr(module, "search", lambda *given, **named: Found(np.zeros(1), True, ""))
    way: Any = Approach(problem, [{}])  # type: ignore[arg-type]
    way.visited = SimpleNamespace(lines_at=lambda values: "lines", ended=[])
    way.follow(10)
    assert asked == [None if part else "lines"] * 3
