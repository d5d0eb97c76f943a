"""Bounded Gauss-Newton searches from one start, and the approach from the best of many starts."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from by_hand import Array, coulomb, four_runs
from campaigns import campaign as simulated
from coulomb_problems import coulomb_problem, values_of
from jbf import Rig, Run
from jbf.estimation.approach import LIKELY, MANY, Approach, approach
from jbf.estimation.campaign import Campaign
from jbf.estimation.minimum import settle
from jbf.estimation.noise import WHITE, Noise
from jbf.estimation.problem import Problem
from jbf.estimation.search import Visited, search
from jbf.estimation.solution import Solution
from scipy import optimize

OFFSET = "sensor_offset.b_n"


@cache
def linear() -> Problem:
    """Coulomb's law and an offset, which is linear."""
    return coulomb_problem(four_runs(coulomb, noise_n=0.1), ["sensor_offset"])


def regression(problem: Problem) -> Array:
    """Bounded least squares for F_c, F_v and the offset by scipy."""
    v = np.concatenate([p.motion.velocity_m_s for p in problem.campaign.prepared])
    f = np.concatenate([p.friction_n for p in problem.campaign.prepared])
    x = np.column_stack([np.sign(v), v, np.ones(len(v))])
    return np.asarray(optimize.lsq_linear(x, f, ([0.0, 0.0, -np.inf], np.inf)).x)


def free_values(problem: Problem, values: Array) -> Array:
    return values[[problem.names.index(n) for n in ("F_c_n", "F_v_n_s_m", OFFSET)]]


@pytest.mark.parametrize("method", ["dogbox", "trf"])
def test_search_for_a_linear_law_ends_at_its_linear_regression(method: str) -> None:
    problem = linear()
    start = values_of(problem, F_c_n=8.0, F_v_n_s_m=5.0)
    samples = problem.campaign.samples
    end = search(problem, samples, start, WHITE, 60, method)  # type: ignore[arg-type]
    assert end.converged
    found = free_values(problem, end.values)
    np.testing.assert_allclose(found, regression(problem), rtol=1e-4, atol=1e-4)
    # Fixed parameters do not change.
    assert end.values[problem.names.index("F_s_n")] == 6.0
    assert not search(problem, samples, start, WHITE, 1).converged
    best = problem.best.values
    assert best is not None
    # The best mean square of innovations is stored in case of an interruption.
    assert problem.best.square == pytest.approx(problem.square(best) / samples.count)


def test_search_ends_at_a_bound_if_the_minimum_lies_beyond_it() -> None:
    """Friction that falls with speed: the viscous coefficient is not negative."""
    runs = four_runs(lambda t, v, a: 5.0 * np.sign(v) - 3.0 * v, noise_n=0.01)
    falling = coulomb_problem(runs, ["sensor_offset"])
    start = values_of(falling, F_v_n_s_m=1e9)
    found = free_values(falling, search(falling, falling.campaign.samples, start, WHITE, 60).values)
    assert found[1] == pytest.approx(0.0, abs=1e-6)
    np.testing.assert_allclose(found, regression(falling), atol=1e-3)


def test_second_search_stops_early_if_it_reaches_values_of_an_earlier_search() -> None:
    problem = linear()
    samples, visited = problem.campaign.samples, Visited()
    start = values_of(problem, F_c_n=8.0, F_v_n_s_m=5.0)
    ends = [search(problem, samples, s, WHITE, 20, visited=visited) for s in (start, 1.7 * start)]
    assert [end.converged for end in ends] == [True, False]
    squares = [problem.square(end.values) for end in ends]
    assert squares[1] >= squares[0]
    assert visited.square(problem, samples, ends[0].values) == pytest.approx(squares[0])


@cache
def with_mass() -> Campaign:
    return Campaign.prepare(
        Rig(), four_runs(lambda t, v, a: coulomb(t, v, a) + 0.2 * a, noise_n=0.1)
    )


def bare_solution(campaign: Campaign, noise: Noise = WHITE) -> Solution:
    """The law without effects, under a given noise."""
    problem = Problem(campaign, "coulomb", "journal", ())
    values = settle(problem, approach(problem, [{}], 8)).values
    return problem.solution(values, campaign.samples, noise)


def test_starts_are_ordered_by_their_sum_of_squares() -> None:
    problem = Problem(with_mass(), "coulomb", "journal", ("inertia_leak",))
    seeds = [{"F_c_n": 5.0}, {"F_c_n": 50.0}]
    every = Approach(problem, seeds).starts
    squares = [problem.square(start) for start in every]
    assert squares == sorted(squares)
    assert len(every) == sum(len(problem.starts(seed)) for seed in seeds)
    # The best of each seed, and a step from a smaller model.
    step = problem.starts({"F_c_n": 7.0})[0]
    some = Approach(problem, seeds, each=True, stepped=step).starts
    assert sorted(s[problem.names.index("F_c_n")] for s in some) == [5.0, 7.0, 50.0]


def test_many_starts_are_first_reduced_by_their_error_in_one_run() -> None:
    rig, runs, _ = simulated(11)
    effects = ("sensor_offset", "inertia_leak", "gravity")
    problem = Problem(Campaign.prepare(rig, runs[:3]), "stribeck", "journal", effects)
    every = problem.starts({})
    squares = sorted(problem.square(start) for start in every)
    kept = Approach(problem, [{}]).starts
    assert len(kept) == max(MANY, len(every) // LIKELY) < 0.5 * len(every)
    assert problem.square(kept[0]) == squares[0]
    assert {problem.square(start) for start in kept} >= set(squares[: MANY // 2])
    # A single run cannot be reduced.
    single = Problem(problem.campaign.only([0]), "stribeck", "journal", effects)
    assert len(Approach(single, [{}]).starts) == len(every)


def test_expected_gain_of_a_linear_effect_is_the_gain_of_its_fit() -> None:
    near = bare_solution(with_mass())
    path = Approach(Problem(with_mass(), "coulomb", "journal", ("inertia_leak",)), [{}])
    look = path.look(near)
    seen, found = path.solution_of(look, near), path.follow(8)
    samples = near.samples
    seen_gain, gain = (
        samples.count * np.log(samples.square(near.residuals) / samples.square(s.residuals))
        for s in (seen, found)
    )
    assert look.promised == pytest.approx(gain, rel=0.01)
    assert look.gain == pytest.approx(seen_gain)
    assert 0.0 < look.gain <= look.promised * (1.0 + 1e-9)


def test_expected_gain_exceeds_the_gain_of_the_first_steps_if_the_law_is_nonlinear() -> None:
    near, samples = bare_solution(with_mass()), with_mass().samples
    path = Approach(Problem(with_mass(), "stribeck", "journal", ()), [{"v_s_m_s": 0.02}])
    look = path.look(near)
    seen = samples.square(path.solution_of(look, near).residuals)
    gain = samples.count * np.log(samples.square(near.residuals) / seen)
    assert look.gain == pytest.approx(gain, rel=1e-3, abs=1e-3)
    assert look.promised > look.gain + 0.01


def test_expected_gain_in_coloured_noise_is_that_of_the_innovations() -> None:
    """A slow wave hides the mass in the squares of residuals, but not of innovations."""
    runs = four_runs(
        lambda t, v, a: coulomb(t, v, a) + 0.3 * a + 2.0 * np.sin(0.5 * t), noise_n=0.1
    )
    slow = Campaign.prepare(Rig(), runs)
    problem = Problem(slow, "coulomb", "journal", ("inertia_leak",))
    plain, coloured = (
        Approach(problem, [{}]).look(bare_solution(slow, noise))
        for noise in (WHITE, Noise(0.6, 0.95))
    )
    assert coloured.gain > 3.0 * max(plain.gain, 1.0)
    assert coloured.promised > 3.0 * max(plain.promised, 1.0)


def test_search_stops_before_convergence_if_it_cannot_reach_the_given_sum_of_squares() -> None:
    problem = Problem(with_mass(), "stribeck", "journal", ("inertia_leak",))
    best = Approach(problem, [{}]).follow(60)
    least = problem.square(best.values)
    stopped = Approach(problem, [{}]).follow(60, least=0.9 * least)
    assert (best.converged, stopped.converged) == (True, False)
    start = Approach(problem, [{}]).starts[0]
    assert problem.square(start) > problem.square(stopped.values) > 0.9 * least


def test_approach_reaches_the_minimum_of_a_nonlinear_curve() -> None:
    """A Stribeck curve written out here, fitted from several starts by scipy."""
    t = np.arange(0.0, 30.0, 0.02)
    v = 0.051 + 0.05 * np.sin(0.7 * t + 1.0)
    noise = 0.1 * np.random.default_rng(3).standard_normal(len(t))
    force = 6.0 + 5.0 * np.exp(-((v / 0.02) ** 2)) + 30.0 * v + noise
    campaign = Campaign.prepare(Rig(), [Run.from_arrays(t, v, force, name="curve")])
    problem = Problem(campaign, "stribeck", "journal", (), {"delta": 2.0})
    speed, friction = campaign.prepared[0].motion.velocity_m_s, campaign.prepared[0].friction_n

    def residual(x: Array) -> Array:
        f_c, f_s, v_s, f_v = np.exp(x)
        curve: Array = f_c + (f_s - f_c) * np.exp(-((speed / v_s) ** 2)) + f_v * speed
        return friction - curve

    ends = [
        2.0 * optimize.least_squares(residual, np.log([6.0, 10.0, v_s, 20.0])).cost
        for v_s in (0.003, 0.01, 0.03, 0.1)
    ]
    assert problem.square(approach(problem, [{}], 60).values) <= min(ends) * (1.0 + 1e-5)
