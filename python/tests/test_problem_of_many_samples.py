"""Rows of a campaign that are made in groups, or when they are asked for; what they cost, and what
of a model with jumps or play is left of its samples."""

from __future__ import annotations

import sys
from dataclasses import replace
from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from by_hand import LAW, Array, coulomb, four_runs
from jbf import Rig
from jbf.estimation import rows
from jbf.estimation.campaign import Campaign
from jbf.estimation.noise import WHITE, Noise
from jbf.estimation.problem import BOUNDLESS, Problem, bounded
from jbf.estimation.samples import Samples

module = sys.modules["jbf.estimation.problem"]
COLOURED = Noise(0.1, 0.5)


def weighed(campaign: Campaign) -> Samples:
    """Each run with weights of its own."""
    random = np.random.default_rng(1)
    weight = [c * random.uniform(0.1, 1.0, len(c)) for c in campaign.samples.counted]
    return replace(campaign.samples, weight=tuple(weight))


@cache
def campaign() -> Campaign:
    whole = Campaign.prepare(Rig(), four_runs(coulomb, noise_n=0.1))
    return replace(whole, samples=weighed(whole))


def posed() -> Problem:
    return Problem(campaign(), "coulomb", "journal", (), {"F_s_n": 6.0})


def values_of(problem: Problem, **more: float) -> Array:
    known = {**LAW, "F_s_n": 6.0, **more}
    return np.array([known[name] for name in problem.names])


@pytest.mark.parametrize("held", [1, 1100, 2500, 10**9])
def test_rows_of_groups_say_what_all_say(held: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of 501 samples by two parameters a run: one, two or all of them at a time."""
    problem = posed()
    samples, values = problem.campaign.samples, values_of(problem)
    r, j = samples.stacked(*problem.linearise(values), COLOURED)
    monkeypatch.setattr(rows, "GROUP", held)
    few, slopes, count = problem.gauss_newton_rows(values, samples, COLOURED)
    assert count == len(r)
    assert slopes.T @ slopes == pytest.approx(j.T @ j)
    assert slopes.T @ few == pytest.approx(j.T @ r)
    assert few @ few == pytest.approx(r @ r)
    parts = {1: 4, 1100: 4, 2500: 2, 10**9: 1}[held]
    assert len(few) == 3 * parts


@pytest.mark.parametrize(("most", "few"), [(4 * 501 * 2, True), (4 * 501 * 2 - 1, False)])
def test_a_solution_holds_so_many_numbers_or_makes_them_again(
    most: int, few: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "MOST_HELD", most)
    problem = posed()
    assert problem.few_numbers == few
    values = values_of(problem, F_c_n=4.5)
    found = problem.solution(values, problem.campaign.samples, WHITE)
    residuals, jacobian = problem.linearise(values)
    assert len(found.residuals) == len(found.jacobian) == 4
    for i in (3, 0):
        assert found.residuals[i].tolist() == residuals[i].tolist()
        assert found.jacobian[i].tolist() == jacobian[i].tolist()
    assert (found.residuals[1] is found.residuals[1]) == few


def test_of_some_runs_a_search_is_as_long_as_they_are(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "every_so_many", lambda lengths, names: [1, 3])
    problem = posed()
    thin = problem.thinned
    assert thin is problem.thinned
    assert [p.run.name for p in thin.campaign.prepared] == ["b", "d"]
    assert problem.searched == [1, 3]
    values = values_of(problem)
    for one, i in zip(thin.residuals(values), (1, 3), strict=True):
        assert one.tolist() == problem.residuals(values)[i].tolist()
    # Its runs are numbered anew; what it sees is the best of the whole.
    assert thin.best is problem.best
    monkeypatch.setattr(module, "every_so_many", lambda lengths, names: list(range(len(lengths))))
    assert thin.searched == [0, 1]
    assert thin.thinned is thin


def test_what_is_stated_is_not_fitted_and_stays_where_it_is_given() -> None:
    stated = "stroke_dependence.x_0_m"
    problem = Problem(campaign(), "coulomb", "journal", ("stroke_dependence",))
    page = problem.parameters[stated]
    assert page.stated
    assert problem.fixed[stated] == page.starts[0]
    assert problem.names.index(stated) not in problem.open
    given = {stated: page.starts[0] + 0.25}
    mine = Problem(campaign(), "coulomb", "journal", ("stroke_dependence",), given)
    assert mine.fixed[stated] == given[stated]


def test_derivatives_cost_twice_what_a_prediction_does() -> None:
    problem = posed()
    values, work = values_of(problem), problem.campaign.work
    work.renew()
    problem.predict(values)
    once = work.taken
    assert once > 0.0
    problem.linearise(values)
    assert work.taken == pytest.approx(3.0 * once)
    work.renew()
    problem.predict(values, [0, 1])
    assert work.taken == pytest.approx(0.5 * once)


def test_a_derivative_as_large_as_is_without_bound_is_none() -> None:
    assert bounded(np.array([[BOUNDLESS, 1.0]]), np.ones(2)).tolist() == [[0.0, 1.0]]
    least = np.nextafter(BOUNDLESS, 0.0)
    assert bounded(np.array([[least, 1.0]]), np.ones(2)).tolist() == [[least, 1.0]]
    assert bounded(np.zeros((0, 2)), np.ones(2)).shape == (0, 2)
    assert BOUNDLESS == 1e50


@pytest.mark.parametrize("count", [3, 5])
def test_runs_and_what_a_chain_says_of_them_go_in_step(
    count: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "active_effects", lambda *given: ("sensor_hysteresis",))
    problem = posed()
    values = values_of(problem)
    lines = [(np.zeros(501), np.zeros((501, 2)))] * count
    problem.chain = SimpleNamespace(  # type: ignore[assignment]
        predict=lambda values, motions: [f for f, _ in lines],
        jacobian=lambda values, motions, by: lines,
        inner_steps=lambda values, motions: 1.0,
    )
    for call in (problem.residuals, problem.linearise, problem.samples_at):
        with pytest.raises(ValueError, match="zip"):
            call(values)
    with pytest.raises(ValueError, match="zip"):
        problem.samples_at(values, ([f for f, _ in lines], []))


@pytest.mark.parametrize(
    ("active", "beside", "settled"),
    [
        ((), False, False),
        (("sensor_offset",), False, False),
        (("time_delay",), True, False),
        (("sensor_lag",), True, False),
        (("sensor_hysteresis",), True, True),
        (("time_delay", "sensor_hysteresis"), True, True),
    ],
)
@pytest.mark.parametrize("known", [True, False])
def test_what_a_model_leaves_of_its_samples_is_told_by_its_effects(
    active: tuple[str, ...],
    beside: bool,
    settled: bool,
    known: bool,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Beside jumps, and where a run remembers how it began: by a noise as large as the residual."""
    problem = posed()
    every, values = problem.campaign.samples, values_of(problem, F_c_n=7.0)
    residuals = problem.residuals(values)
    predicted = problem.predict(values)
    asked: list[str] = []

    def remember(samples: Samples, values: Array, noise_n: float) -> Any:
        asked.append("settled")
        assert noise_n == pytest.approx(every.rms(residuals))
        return "fewer"

    def jumps(samples: Any, prepared: Any, predictions: Any, effects: Any) -> Any:
        asked.append("beside")
        assert samples == ("fewer" if settled else every)
        assert tuple(effects) == active
        for one, other in zip(predictions, predicted, strict=True):
            assert one == pytest.approx(other)
        return "least"

    monkeypatch.setattr(module, "active_effects", lambda *given: active)
    monkeypatch.setattr(module, "samples_beside_jumps", jumps)
    monkeypatch.setattr(problem, "_settled", remember)
    lines: Any = (residuals, None) if known else None
    if known:
        monkeypatch.setattr(problem, "predict", None)
    found: Any = problem.samples_at(values, lines)
    assert found is every if not beside else found == "least"
    assert asked == ["settled"] * settled + ["beside"] * beside
