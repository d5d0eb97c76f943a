"""Other peaks and other weights are followed where they lead to less, by made-up models."""

from __future__ import annotations

import sys
from types import SimpleNamespace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from jbf.estimation.minimum import search_peaks
from jbf.estimation.peaks import other_peaks
from jbf.estimation.weighting import ELSEWHERE, best_weighting, huber, student
from made_of import record, samples_of

Array = npt.NDArray[np.float64]
minima = sys.modules["jbf.estimation.minimum"]
weighting = sys.modules["jbf.estimation.weighting"]
PEAK = "drive_compliance.J_kg_m2"


def looked(
    monkeypatch: pytest.MonkeyPatch,
    ends: list[float],
    *,
    effects: tuple[str, ...] = ("sensor_offset", "drive_compliance"),
    fixed: tuple[str, ...] = (),
) -> tuple[float, list[int]]:
    """The square at which a search among these ends, from 4; and along which parameter."""
    asked: list[int] = []
    names = ("sensor_offset.b_n", PEAK)

    def others(square: Any, values: Array, which: int, low: float, high: float) -> list[Array]:
        assert (low, high) == (0.5, 50.0)
        asked.append(which)
        return [np.array([end]) for end in ends]

    problem: Any = SimpleNamespace(
        effects=effects,
        fixed=fixed,
        names=list(names),
        lower=np.array([-9.0, 0.5]),
        upper=np.array([9.0, 50.0]),
        square=lambda values, samples: float(values[0]) ** 2,
        solution=lambda values, samples, noise, converged: SimpleNamespace(
            values=values, samples=samples, noise=noise
        ),
    )
    monkeypatch.setattr(minima, "other_peaks", others)
    monkeypatch.setattr(
        minima,
        "search",
        lambda p, samples, start, noise, evaluations: SimpleNamespace(values=start),
    )
    monkeypatch.setattr(minima, "settle", lambda p, near: near)
    near: Any = SimpleNamespace(values=np.array([2.0]), samples=None, noise=None)
    return float(search_peaks(problem, near).values[0]), asked


def test_peaks_are_looked_for_up_to_five_times_the_value_and_down_to_a_fifth() -> None:
    """At 41 places of a logarithm, the value among them; within bounds alone."""
    asked: list[float] = []

    def square(values: Array) -> float:
        asked.append(float(values[1]))
        return 0.0

    other_peaks(square, np.array([7.0, 2.0]), 1, 1e-9, 1e9)
    assert asked == pytest.approx(2.0 * 5.0 ** np.linspace(-1.0, 1.0, 41))
    asked.clear()
    other_peaks(square, np.array([7.0, 2.0]), 1, 1.0, 4.0)
    assert (len(asked), min(asked) > 1.0, max(asked) < 4.0) == (17, True, True)


def test_the_lowest_of_other_peaks_is_taken_where_it_is_lower(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assert looked(monkeypatch, [3.0, 1.0, 1.5]) == (1.0, [1])
    assert looked(monkeypatch, [3.0, 2.0]) == (2.0, [1])
    assert looked(monkeypatch, []) == (2.0, [1])
    # One that is as low is another place, and no better.
    assert looked(monkeypatch, [-2.0]) == (2.0, [1])


def test_an_effect_of_one_peak_or_of_a_fixed_one_is_passed_over(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assert looked(monkeypatch, [1.0], effects=("sensor_offset",)) == (2.0, [])
    assert looked(monkeypatch, [1.0], fixed=(PEAK,)) == (2.0, [])
    assert looked(monkeypatch, [1.0], fixed=("sensor_offset.b_n",)) == (1.0, [1])


def weighed(
    monkeypatch: pytest.MonkeyPatch, places: dict[str, float], left: dict[str, float]
) -> tuple[str, list[str]]:
    """Which of three fits is taken: each predicts so much more than the plain one, and leaves so
    much of what was left out; and which of them were asked for that."""
    n = 100
    samples = samples_of([record(0.02 * np.arange(n))])
    swings = np.where(np.arange(n) % 2, 1.0, -1.0)

    def of(name: str) -> Any:
        residual = swings + places[name]
        return SimpleNamespace(name=name, residuals=[residual], samples=samples, rms_n=1.0)

    fits = {name: of(name) for name in ("plain", "huber", "student")}
    asked: list[str] = []

    def errors(problem: Any, solution: Any) -> Array:
        asked.append(solution.name)
        found: Array = left[solution.name] * swings
        return found

    named = {huber: "huber", student: "student"}
    monkeypatch.setattr(weighting, "_robust", lambda p, plain, weights: fits[named[weights]])
    monkeypatch.setattr(weighting, "left_out_residuals", errors)
    problem: Any = None
    found: Any = best_weighting(problem, fits["plain"])
    return found.name, asked


@pytest.mark.parametrize(
    ("places", "left", "taken", "asked"),
    [
        # What leads to the same place is no other answer.
        ((0.04, 0.04), (0.1, 0.1), "plain", []),
        ((0.04, 0.06), (0.1, 0.5), "student", ["plain", "student"]),
        ((0.06, 0.04), (0.5, 0.1), "huber", ["plain", "huber"]),
        ((0.06, 0.06), (0.5, 0.4), "student", ["plain", "huber", "student"]),
        ((0.06, 0.06), (0.5, 0.6), "huber", ["plain", "huber", "student"]),
        ((0.06, 0.06), (1.1, 1.2), "plain", ["plain", "huber", "student"]),
    ],
)
def test_weights_that_lead_elsewhere_are_taken_where_they_predict_better(
    places: tuple[float, float],
    left: tuple[float, float],
    taken: str,
    asked: list[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assert ELSEWHERE == 0.05
    where = dict(zip(("plain", "huber", "student"), (0.0, *places), strict=True))
    leaves = dict(zip(("plain", "huber", "student"), (1.0, *left), strict=True))
    assert weighed(monkeypatch, where, leaves) == (taken, asked)
