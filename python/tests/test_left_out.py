"""What a run that was left out may know of the fit: nothing; and the search's own variables."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from by_hand import Array, coulomb, four_runs, one_way
from jbf import Parameter, Rig, Run, diagnose, forget_effect, register_effect
from jbf.estimation import left_out as left_out_module
from jbf.estimation.campaign import Campaign
from jbf.estimation.left_out import (
    _straight,
    errors_by_run,
    halves_left_out,
    left_out_rms,
    only_witnesses,
)
from jbf.estimation.minimum import minimum, search
from jbf.estimation.noise import WHITE
from jbf.estimation.problem import Problem
from jbf.estimation.solution import Solution

NOISE_N = 0.1
PUSH = Parameter("k_n", "N", lower=-10.0, upper=10.0, null=0.0, starts=(0.5,))
PUSH_N = 3.0


def pushed(push: Array, k_n: float) -> Array:
    """A force that the run itself records: where it does not, nothing is known of it."""
    return k_n * push


@pytest.fixture
def own_effect() -> Iterator[None]:
    register_effect(pushed, parameters=[PUSH])
    yield
    forget_effect("pushed")


def left_out(runs: list[Run], *effects: str) -> tuple[float, Problem, Array]:
    problem = Problem(Campaign.prepare(Rig(), runs), "coulomb", "journal", effects)
    solution = minimum(problem, [{}])
    return left_out_rms(problem, solution), problem, solution.values


def first_is_pushed(others: float = 0.0) -> list[Run]:
    """Four runs, the first of them pushed, and the others by so small a share of it."""
    runs = []
    for i, run in enumerate(four_runs(coulomb, noise_n=NOISE_N)):
        push = np.sign(np.sin(9.0 * run.time_s)) * (1.0 if i == 0 else others)
        force = np.asarray(run.friction_n) + PUSH_N * push
        runs.append(replace(run, friction_n=force, extra={"push": push}))
    return runs


@pytest.mark.usefixtures("own_effect")
@pytest.mark.parametrize("others", [0.0, 1e-3])
def test_what_only_the_left_out_run_knows_does_not_leak_into_its_prediction(others: float) -> None:
    found, problem, values = left_out(first_is_pushed(others), "pushed")
    assert values[problem.names.index("pushed.k_n")] == pytest.approx(PUSH_N, rel=0.01)
    # Without the first run nobody knows of a push: its prediction misses all of it. A thousandth
    # of it tells nothing (0.1 N of noise are 5 N of push in these runs): a fit to that would miss
    # by what noise makes of it.
    missed = np.sqrt(NOISE_N**2 + PUSH_N**2 / 4.0)
    assert missed > 10.0 * NOISE_N
    assert found == pytest.approx(missed, rel=0.02)


@pytest.mark.usefixtures("own_effect")
def test_half_of_the_only_witness_tells_what_the_other_half_does() -> None:
    problem = Problem(Campaign.prepare(Rig(), first_is_pushed()), "coulomb", "journal", ("pushed",))
    solution = minimum(problem, [{}])
    assert only_witnesses(problem, solution) == {0}
    left = errors_by_run(solution, halves_left_out(problem, solution, 0))[0]
    assert len(left) == np.count_nonzero(solution.samples.counted[0])
    assert np.std(left) == pytest.approx(NOISE_N, rel=0.1)


@pytest.mark.usefixtures("own_effect")
def test_a_half_that_was_left_out_drives_nothing() -> None:
    # The push is three times as large in the second half: each half is missed by the difference.
    first, *others = first_is_pushed()
    more = np.where(first.time_s > 5.0, 3.0, 1.0) * first.extra["push"]
    force = np.asarray(first.friction_n) + PUSH_N * (more - first.extra["push"])
    problem = Problem(
        Campaign.prepare(Rig(), [replace(first, friction_n=force), *others]),
        "coulomb",
        "journal",
        ("pushed",),
    )
    solution = minimum(problem, [{}])
    left = errors_by_run(solution, halves_left_out(problem, solution, 0))[0]
    assert np.std(left) == pytest.approx(2.0 * PUSH_N, rel=0.02)


@pytest.mark.usefixtures("own_effect")
def test_where_several_runs_tell_of_all_there_is_no_only_witness() -> None:
    problem = Problem(
        Campaign.prepare(Rig(), first_is_pushed(1.0)), "coulomb", "journal", ("pushed",)
    )
    assert not only_witnesses(problem, minimum(problem, [{}]))
    alone = Problem(
        Campaign.prepare(Rig(), first_is_pushed()[:1]), "coulomb", "journal", ("pushed",)
    )
    assert not only_witnesses(alone, minimum(alone, [{}]))


@pytest.mark.usefixtures("own_effect")
def test_an_effect_that_only_one_run_shows_is_confirmed_by_its_halves() -> None:
    found = diagnose(Rig(), first_is_pushed(), law="coulomb")
    assert found.effects == ("pushed",)
    (reason,) = (t.reason for t in found.steps[0].trials if t.outcome == "added")
    assert "left-out runs and halves of a 0.09" in reason


def test_the_halves_of_a_single_run_take_turns() -> None:
    # The second half has 1 N more: each half is predicted with the other's friction.
    run = one_way(
        "only", lambda t, v, a: coulomb(t, v, a) + (t > 5.0), rate=2.0 * np.pi, noise_n=NOISE_N
    )
    found, _, _ = left_out([run])
    assert found == pytest.approx(np.hypot(1.0, NOISE_N), rel=0.02)


def test_a_run_that_was_left_out_drives_nothing() -> None:
    runs = four_runs(coulomb, noise_n=NOISE_N)
    plain, _, _ = left_out(runs)
    # One run is off by 1 N in the direction of motion: it alone is missed by that, and the
    # others by a third of it where it is among the three that were fitted.
    name, v, f = runs[0].name, runs[0].velocity_m_s, np.asarray(runs[0].friction_n)
    off = Run.from_arrays(runs[0].time_s, v, f + np.sign(v), name=name)
    found, _, _ = left_out([off, *runs[1:]])
    assert plain == pytest.approx(NOISE_N, rel=0.03)
    assert found == pytest.approx(np.sqrt(NOISE_N**2 + (1.0 + 3.0 / 9.0) / 4.0), rel=0.03)


# ---- the search's variables -------------------------------------------------------------------


@pytest.fixture(scope="module")
def problem() -> Problem:
    runs = four_runs(coulomb, noise_n=NOISE_N)
    return Problem(
        Campaign.prepare(Rig(), runs),
        "coulomb",
        "journal",
        ("direction_asymmetry", "wear_in"),
        {"F_s_n": 6.0},
    )


def test_the_search_cannot_leave_the_bounds(problem: Problem) -> None:
    base = problem.starts({"F_s_n": 6.0})[0]
    away = np.full(len(problem.open), 1e9)
    for side, bound in ((away, problem.upper), (-away, problem.lower)):
        there = problem.decode(side, base)
        np.testing.assert_array_equal(there[problem.open], bound[problem.open])
    # What is held stays, wherever the search goes.
    held = problem.names.index("F_s_n")
    assert problem.decode(away, base)[held] == 6.0


def test_bounds_come_back_inside_to_the_bit(problem: Problem) -> None:
    # Beyond a bound by a rounding error, and no model file would take it.
    for bound in (problem.lower, problem.upper):
        back = problem.decode(problem.encode(bound), bound)
        assert np.all(back >= problem.lower)
        assert np.all(back <= problem.upper)
        np.testing.assert_allclose(back, bound, rtol=1e-14)
        beyond = problem.encode(bound * np.where(bound > 0, 1.1, 0.9) + 0.1)
        assert np.all(beyond >= problem.encode(problem.lower))
        assert np.all(beyond <= problem.encode(problem.upper))


def test_scales_are_searched_in_their_logarithm(problem: Problem) -> None:
    values = problem.starts({"F_s_n": 6.0})[0]
    x = problem.encode(values)
    for k, i in enumerate(problem.open):
        wanted = np.log(values[i]) if problem.log[i] else values[i]
        assert x[k] == wanted
    np.testing.assert_allclose(problem.decode(x, values), values, rtol=1e-14)


def test_angles_are_wrapped_and_nothing_else() -> None:
    t = np.arange(0.0, 10.0, 0.02)
    v = 0.1 + 0.05 * np.sin(t)
    angle = np.concatenate(([0.0], np.cumsum(0.5 * (v[1:] + v[:-1]) * 0.02))) / 0.0127
    run = Run.from_arrays(t, v, coulomb(t, v, v), angle_rad=angle)
    problem = Problem(
        Campaign.prepare(Rig.thesis(), [run]), "coulomb", "journal", ("position_ripple",)
    )
    values = problem.starts({})[0]
    where = problem.names.index("position_ripple.theta_0_rad")
    for angle_rad, wrapped in ((4.0, 4.0 - 2.0 * np.pi), (-7.0, -7.0 + 2.0 * np.pi), (3.0, 3.0)):
        values[where] = angle_rad
        found = problem.wrapped(values)
        assert found[where] == pytest.approx(wrapped)
        np.testing.assert_array_equal(np.delete(found, where), np.delete(values, where))


def test_a_solution_keeps_record_minus_prediction(problem: Problem) -> None:
    values = problem.starts({"F_s_n": 6.0})[0]
    solution = problem.solution(values, problem.campaign.samples, WHITE)
    for p, f, residual in zip(
        problem.campaign.prepared, problem.predict(values), solution.residuals, strict=True
    ):
        np.testing.assert_array_equal(residual, p.friction_n - f)
    assert solution.rms_n == pytest.approx(
        np.sqrt(np.mean(np.concatenate(solution.residuals) ** 2))
    )
    n = sum(map(len, solution.residuals))
    assert solution.cost == pytest.approx(2.0 * n * np.log(solution.rms_n))
    assert problem.square(values) == pytest.approx(n * solution.rms_n**2)


# ---- one step in place of a search ------------------------------------------------------------


def searched(problem: Problem, monkeypatch: pytest.MonkeyPatch, short: float) -> tuple[float, int]:
    """The left-out error with steps up to so many standard deviations, and how many searches."""
    searches = []

    def counted(*given: Any) -> Any:
        searches.append(1)
        return search(*given)

    solution = minimum(problem, [{}])
    monkeypatch.setattr(left_out_module, "search", counted)
    monkeypatch.setattr(left_out_module, "SHORT", short)
    return left_out_rms(problem, solution), len(searches)


def test_of_runs_that_agree_a_step_is_the_whole_way(monkeypatch: pytest.MonkeyPatch) -> None:
    campaign = Campaign.prepare(Rig(), four_runs(coulomb, noise_n=NOISE_N))
    problem = Problem(campaign, "coulomb", "journal", ())
    stepped, none = searched(problem, monkeypatch, 3.0)
    whole, all_four = searched(problem, monkeypatch, 0.0)
    assert (none, all_four) == (0, 4)
    assert stepped == pytest.approx(whole, rel=1e-4)


def test_where_the_way_is_long_or_bends_a_search_goes_on(monkeypatch: pytest.MonkeyPatch) -> None:
    runs = four_runs(coulomb, noise_n=NOISE_N)
    name, v, f = runs[0].name, runs[0].velocity_m_s, np.asarray(runs[0].friction_n)
    off = Run.from_arrays(runs[0].time_s, v, f + 3.0 * np.sign(v), name=name)
    campaign = Campaign.prepare(Rig(), [off, *runs[1:]])
    far, searches = searched(Problem(campaign, "stribeck", "journal", ()), monkeypatch, 3.0)
    assert searches > 0
    exact, every = searched(Problem(campaign, "stribeck", "journal", ()), monkeypatch, 0.0)
    assert every == 4
    assert far == pytest.approx(exact, rel=1e-3)


@pytest.mark.parametrize(("bend", "straight"), [(0.0, True), (0.04, True), (0.06, False)])
def test_a_way_is_straight_where_predictions_go_as_their_derivatives_say(
    bend: float, straight: bool
) -> None:
    random = np.random.default_rng(0)
    slope, here = random.standard_normal((500, 1)), 1e-6 * random.standard_normal(500)
    counted = np.arange(500) < 400
    change = slope[:, 0] * 0.3
    there = here - change + np.where(counted, bend, 7.0) * np.abs(change)
    solution = SimpleNamespace(
        residuals=[here], jacobian=[slope], samples=SimpleNamespace(counted=[counted])
    )
    way = np.array([0.3])
    assert _straight(cast(Solution, solution), way, [0], [there]) == straight
