"""What is fitted: search variables, starts, predictions and rows of a law that is linear."""

from __future__ import annotations

import sys
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from by_hand import LAW, Array, four_runs, one_way
from by_hand import coulomb as friction
from jbf import InputError, Parameter, Rig
from jbf.estimation.campaign import Campaign
from jbf.estimation.noise import WHITE, Noise
from jbf.estimation.peaks import CLIMBED, POINTS, REACH, other_peaks
from jbf.estimation.problem import BOUNDLESS, Best, Problem, bounded, named_values
from jbf.estimation.search import (
    NEAR,
    SAME,
    Place,
    Visited,
    _joins,
    _key,
    _one,
    search,
)

VALUES = {**LAW, "F_s_n": 6.0}


@pytest.fixture(scope="module")
def problem() -> Problem:
    campaign = Campaign.prepare(Rig(), four_runs(friction, noise_n=0.1))
    return Problem(campaign, "coulomb", "journal", ("sensor_offset",), {"F_s_n": 6.0})


def values_of(problem: Problem, **more: float) -> Array:
    known = {**VALUES, "sensor_offset.b_n": 0.0, **more}
    return np.array([known[name] for name in problem.names])


# ---- search variables --------------------------------------------------------------------------


def test_scales_are_searched_in_their_logarithm_and_what_is_fixed_stays(problem: Problem) -> None:
    values = values_of(problem)
    x = problem.encode(values)
    assert len(x) == len(problem.open) == len(problem.names) - 1
    for there, i in zip(x, problem.open, strict=True):
        page = problem.parameters[problem.names[i]]
        assert there == pytest.approx(np.log(values[i]) if page.log else values[i])
    base = values_of(problem, F_s_n=9.0)
    back = problem.decode(x, base)
    assert back == pytest.approx(np.where(np.array(problem.names) == "F_s_n", 9.0, values))
    assert base[problem.names.index("F_s_n")] == 9.0
    # Far outside they are brought back to their bounds.
    for far in (-1e9, 1e9):
        out = problem.decode(np.full(len(x), far), values)
        assert np.all((out >= problem.lower) & (out <= problem.upper))
        for i in problem.open:
            assert out[i] == (problem.lower[i] if far < 0.0 else problem.upper[i])
    wild = problem.encode(np.full(len(values), 1e300))
    assert wild == pytest.approx(problem.encode(problem.upper))


def test_starts_are_every_combination_but_for_what_is_known(problem: Problem) -> None:
    pages = problem.parameters
    starts = problem.starts({"F_s_n": 6.0, "sensor_offset.b_n": 0.125})
    others = [n for n in problem.names if n not in ("F_s_n", "sensor_offset.b_n")]
    assert len(starts) == np.prod([len(pages[n].starts) for n in others])
    place = problem.names.index("sensor_offset.b_n")
    assert {float(s[place]) for s in starts} == {0.125}
    first = [pages[n].starts[0] if n in others else None for n in problem.names]
    assert all(f is None or s == f for s, f in zip(starts[0].tolist(), first, strict=True))
    assert len({tuple(s.tolist()) for s in starts}) == len(starts)


def test_angles_come_back_within_half_a_turn() -> None:
    ring: Any = SimpleNamespace(
        parameters={"a": Parameter("a"), "b": Parameter("b", period=2.0 * np.pi)}
    )
    for turns in (-3, 0, 2):
        values = np.array([9.0, 1.0 + 2.0 * np.pi * turns])
        assert Problem.wrapped(ring, values) == pytest.approx([9.0, 1.0])
        assert values[1] == 1.0 + 2.0 * np.pi * turns


def test_derivatives_without_bound_are_none() -> None:
    j = np.array([[1.0, 2.0], [3.0, -4.0]])
    assert bounded(j, np.array([10.0, 0.5])).tolist() == [[10.0, 1.0], [30.0, -2.0]]
    wild = np.array([[1.0, 2.0 * BOUNDLESS], [np.nan, -2.0 * BOUNDLESS]])
    assert bounded(wild, np.ones(2)).tolist() == [[1.0, 0.0], [0.0, 0.0]]
    assert bounded(j, np.array([1e200, 1.0])).tolist() == [[0.0, 2.0], [0.0, -4.0]]


@pytest.mark.parametrize(
    ("given", "found"),
    [
        ({"F_c": 1.0}, {"F_c_n": 1.0}),
        ({"b": 0.0, "F_c_n": 5.0}, {"b": 0.0, "F_c_n": 5.0}),
        (None, {}),
    ],
)
def test_values_are_named_in_full(given: dict[str, float] | None, found: dict[str, float]) -> None:
    pages = {
        "F_c_n": Parameter("F_c_n", lower=1.0, upper=5.0),
        "b": Parameter("b", lower=1.0, upper=5.0, null=0.0),
    }
    assert named_values(given, pages) == found
    for wrong in (0.999, 5.001):
        with pytest.raises(InputError, match="out of range"):
            named_values({"F_c_n": wrong}, pages)


# ---- predictions -------------------------------------------------------------------------------


def test_predictions_residuals_and_rows_belong_together(problem: Problem) -> None:
    values = values_of(problem, F_c_n=5.2, **{"sensor_offset.b_n": 0.3})
    predictions, residuals = problem.predict(values), problem.residuals(values)
    for f, r, p in zip(predictions, residuals, problem.campaign.prepared, strict=True):
        v = p.motion.velocity_m_s
        assert f == pytest.approx(5.2 * np.sign(v) + 20.0 * v + 0.3)
        assert r == pytest.approx(p.friction_n - f)
    some = problem.residuals(values, [2, 0])
    assert [np.array_equal(a, residuals[i]) for a, i in zip(some, (2, 0), strict=True)] == [
        True
    ] * 2
    assert problem.square(values) == pytest.approx(problem.campaign.samples.square(residuals))
    left, slopes = problem.linearise(values)
    h = 1e-6
    x = problem.encode(values)
    for k in range(len(x)):
        step = np.where(np.arange(len(x)) == k, h, 0.0)
        up, down = (problem.predict(problem.decode(x + s * step, values)) for s in (1.0, -1.0))
        for run in range(4):
            assert slopes[run][:, k] == pytest.approx((up[run] - down[run]) / (2.0 * h), abs=1e-4)
            assert left[run] == pytest.approx(residuals[run])


@pytest.mark.parametrize("noise", [WHITE, Noise(0.1, 0.5)])
def test_few_rows_have_the_products_of_all(problem: Problem, noise: Noise) -> None:
    values, samples = values_of(problem), problem.campaign.samples
    lines = problem.linearise(values)
    r, j = samples.stacked(*lines, noise)
    for given in (None, lines):
        few, slopes, count = problem.gauss_newton_rows(values, samples, noise, given)
        assert count == len(r)
        assert few @ few == pytest.approx(r @ r)
        assert slopes.T @ few == pytest.approx(j.T @ r)
        assert slopes.T @ slopes == pytest.approx(j.T @ j)
    found = problem.solution(values, samples, noise)
    assert found.cost == pytest.approx(count * np.log(float(r @ r) / count))
    assert found.converged
    assert found.effects == ("sensor_offset",)


def test_all_of_a_short_campaign_is_searched(problem: Problem) -> None:
    assert problem.searched == [0, 1, 2, 3]
    assert problem.thinned is problem
    assert problem.few_numbers
    assert problem.samples_at(values_of(problem)) is problem.campaign.samples


def test_the_best_that_was_seen_is_kept() -> None:
    best = Best()
    assert best.values is None
    for square, kept in ((5.0, 5.0), (7.0, 5.0), (5.0, 5.0), (3.0, 3.0)):
        best.seen(np.array([square]), square)
        assert best.square == kept
    assert best.values is not None
    assert best.values.tolist() == [3.0]


# ---- searches ----------------------------------------------------------------------------------


def test_a_search_finds_what_linear_regression_does(problem: Problem) -> None:
    start = values_of(problem, F_c_n=8.0, F_v_n_s_m=5.0)
    samples = problem.campaign.samples
    end = search(problem, samples, start, WHITE, 60)
    assert end.converged
    v = samples.flat([p.motion.velocity_m_s for p in problem.campaign.prepared])
    f = samples.flat([p.friction_n for p in problem.campaign.prepared])
    x = np.column_stack([np.sign(v), v, np.ones(len(v))])
    wanted = np.linalg.lstsq(x, f, rcond=None)[0]
    found = [
        end.values[problem.names.index(n)] for n in ("F_c_n", "F_v_n_s_m", "sensor_offset.b_n")
    ]
    assert found == pytest.approx(wanted, rel=1e-4, abs=1e-4)
    assert end.values[problem.names.index("F_s_n")] == 6.0
    short = search(problem, samples, start, WHITE, 1)
    assert not short.converged


def place(values: list[float], square: float = 100.0, moves: float = 1.0) -> Place:
    """A place whose two parameters each move a row of its own."""
    at = np.array(values)
    return Place(at, at, at, np.array([np.sqrt(square), 0.0]), moves * np.eye(2), 50)


def test_the_lowest_place_is_remembered_with_its_lines() -> None:
    visited = Visited()
    first, lower, higher = (
        place([1.0, 2.0], 100.0),
        place([1.5, 2.0], 50.0),
        place([3.0, 1.0], 70.0),
    )
    lines: Any = ([np.ones(3)], [np.ones((3, 2))])
    assert visited.lines_at(first.values) is None
    visited.come(first, lines)
    assert visited.lines_at(first.values) is lines
    visited.come(lower, lines)
    visited.come(higher, lines)
    visited.come(place([9.0, 9.0], 1.0), None)
    assert visited.lowest is not None
    assert visited.lowest[0] is lower
    assert visited.lines_at(lower.values) is lines
    assert visited.lines_at(first.values) is None
    # Of two that are as low the first.
    visited.come(place([2.5, 2.5], 50.0), lines)
    assert visited.lowest[0] is lower
    assert visited.at(higher.values) is higher
    assert visited.at(np.array([7.0, 7.0])) is None
    assert higher.square == pytest.approx(70.0)


def test_values_are_one_but_for_their_last_bits() -> None:
    values = np.array([0.1, -3e7, 0.0])
    assert _key(np.exp(np.log(np.abs(values[:2])))) == _key(np.abs(values[:2]))
    assert _key(values * (1.0 + 1e-15)) == _key(values)
    assert _key(values * (1.0 + 1e-11)) != _key(values)


def test_two_places_are_one_where_data_cannot_tell_them() -> None:
    """A step that moves predictions by less than a tenth of the residual, of parameters that differ
    by less than three tenths of themselves."""
    assert (NEAR, SAME) == (0.3, 0.1)
    here = place([10.0, 10.0])
    for step, one in ((0.99, True), (1.01, False)):
        assert _one(here, place([10.0 + step, 10.0])) == one
        assert _one(place([10.0 + step, 10.0]), here) == one
        # Of the two the lower residual counts, and either's derivatives.
        assert _one(here, place([10.0 + 0.5 * step, 10.0], 25.0)) == one
        assert _one(here, place([10.0 + 0.5 * step, 10.0], moves=2.0)) == one
    # Far apart they are two, unless nothing depends on it.
    small = [place([1.0, 10.0], 1e6), place([1.4, 10.0], 1e6), place([1.45, 10.0], 1e6)]
    assert _one(small[0], small[1])
    assert _one(place([7.0, 10.0], 1e6), place([10.0, 10.0], 1e6))
    assert not _one(small[0], small[2])
    still = [place([1.0, 10.0], 1e6, 0.0), place([99.0, 10.0], 1e6, 0.0)]
    assert _one(*still)


def test_a_search_joins_another_that_went_as_low() -> None:
    here = place([10.0, 10.0], 100.0)
    near = place([10.1, 10.0], 120.0)
    assert _joins(here, [near, place([50.0, 1.0], 99.0)])
    assert _joins(here, [near, place([50.0, 1.0], 100.0)])
    assert not _joins(here, [near])
    assert not _joins(here, [place([50.0, 1.0], 1.0)])


# ---- peaks -------------------------------------------------------------------------------------


def test_minima_on_a_grid_are_climbed_but_for_the_one_at_hand() -> None:
    """A well at each of some places, the deepest first; on a grid of a logarithm either way."""
    grid = 4.0 * np.exp(np.linspace(-np.log(REACH), np.log(REACH), POINTS))
    middle = POINTS // 2
    assert grid[middle] == pytest.approx(4.0)
    wells = {middle - 8: 3.0, middle + 6: 5.0, middle + 12: 1.0, middle: 9.0}

    def square(values: Array) -> float:
        k = int(np.argmin(np.abs(np.log(grid / values[1]))))
        return 10.0 - wells.get(k, 0.0)

    found = other_peaks(square, np.array([7.0, 4.0]), 1, 1e-9, 1e9)
    assert CLIMBED == 2
    assert [v[0] for v in found] == [7.0, 7.0]
    assert [v[1] for v in found] == pytest.approx([grid[middle + 6], grid[middle - 8]])
    inside = other_peaks(
        square, np.array([7.0, 4.0]), 1, float(grid[middle - 7]), float(grid[middle + 7])
    )
    assert pytest.approx(grid[middle + 6]) in [v[1] for v in inside]
    assert all(grid[middle - 7] < v[1] < grid[middle + 7] for v in inside)


def test_one_run_is_as_long_as_it_was_made() -> None:
    campaign = Campaign.prepare(Rig(), [one_way("a", friction)])
    alone = Problem(campaign, "coulomb", "journal", ())
    assert alone.searched == [0]
    assert len(alone.residuals(alone.starts({})[0])[0]) == 501


def test_samples_that_remember_how_their_run_began_are_set_aside(
    problem: Problem, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By each of what remembers."""
    module = sys.modules["jbf.estimation.problem"]
    lengths = [len(p.run) for p in problem.campaign.prepared]
    parts: Any = {"film": (0, 10), "contact": (5, 30)}

    def remembering(chain: Any, values: Any, prepared: Any, memory: str, noise_n: float) -> Any:
        first, last = parts[memory]
        return [(np.arange(n) >= first) & (np.arange(n) < last) for n in lengths]

    monkeypatch.setattr(module, "memories", lambda law, effects: list(parts))
    monkeypatch.setattr(module, "remembering", remembering)
    every = problem.campaign.samples
    left = problem._settled(every, values_of(problem), 1.0)
    for before, after in zip(every.counted, left.counted, strict=True):
        assert not after[:30].any()
        assert np.array_equal(after[30:], before[30:])
