"""Bounded searches from one start, and the approach from the best of many starts."""

from functools import cache

import numpy as np
import pytest
from by_hand import Array, coulomb, four_runs
from campaigns import campaign as simulated
from coulomb_problems import coulomb_problem, values_of
from jbf import Rig, Run
from jbf.estimation.approach import KEPT, Approach, approach
from jbf.estimation.campaign import Campaign
from jbf.estimation.likelihood import likelihood_gain
from jbf.estimation.minimum import not_above_nested, settle
from jbf.estimation.noise import WHITE, Noise
from jbf.estimation.problem import Problem
from jbf.estimation.search import ENDED, Visited, search
from jbf.estimation.solution import Solution
from linear_campaigns import mass
from scipy import optimize


@cache
def linear() -> Problem:
    return coulomb_problem(four_runs(coulomb, noise_rms=0.1), ["sensor_offset"])


def test_search_for_a_linear_law_ends_at_its_linear_regression() -> None:
    problem = linear()
    start = values_of(problem, F_c=8.0, F_v=5.0)
    samples = problem.campaign.samples
    end = search(problem, samples, start, WHITE, 60)
    assert end.converged
    v = np.concatenate([p.motion.velocity for p in problem.campaign.prepared])
    f = np.concatenate([p.friction for p in problem.campaign.prepared])
    x = np.column_stack([np.sign(v), v, np.ones(len(v))])
    wanted = np.linalg.lstsq(x, f, rcond=None)[0]
    np.testing.assert_allclose(end.values[problem.open], wanted, rtol=1e-4, atol=1e-4)
    assert end.values[problem.names.index("F_s")] == 6.0
    assert not search(problem, samples, start, WHITE, 1).converged
    # The best mean square of innovations is stored in case of an interruption.
    square = problem.square(problem.best.values)
    assert problem.best.square == pytest.approx(square / samples.count)


def test_search_returns_residuals_and_jacobian_at_its_end() -> None:
    problem = linear()
    start = values_of(problem, F_c=8.0, F_v=5.0)
    for evaluations in (1, 2, 60):
        end = search(problem, problem.campaign.samples, start, WHITE, evaluations)
        assert end.lines is not None
        for found, wanted in zip(end.lines, problem.linearise(end.values), strict=True):
            np.testing.assert_array_equal(np.concatenate(found), np.concatenate(wanted))


def test_second_search_stops_early_if_it_reaches_values_of_an_earlier_search() -> None:
    problem, visited = linear(), Visited()
    samples = problem.campaign.samples
    start = values_of(problem, F_c=8.0, F_v=5.0)
    ends = [search(problem, samples, s, WHITE, 20, visited=visited) for s in (start, 1.7 * start)]
    assert [end.converged for end in ends] == [True, False]
    squares = [problem.square(end.values) for end in ends]
    assert squares[1] >= (1.0 - ENDED) * squares[0]
    assert visited.square(problem, samples, ends[0].values) == pytest.approx(squares[0])


@cache
def with_mass() -> Campaign:
    return Campaign.prepare(Rig(), four_runs(mass(0.2), noise_rms=0.1))


def bare_solution(campaign: Campaign, noise: Noise = WHITE) -> Solution:
    problem = Problem(campaign, "coulomb", "journal", ())
    values = settle(problem, approach(problem, [[{}]], 8)).values
    return problem.solution(values, campaign.samples, noise)


def test_approach_orders_starts_by_their_sum_of_squares() -> None:
    problem = Problem(with_mass(), "coulomb", "journal", ("inertia",))
    seeds = [[{"F_c": 5.0}], [{"F_c": 50.0}]]
    every = Approach(problem, seeds).starts
    squares = [problem.square(start) for start in every]
    assert squares == sorted(squares)
    assert len(every) == sum(len(problem.starts(seed)) for [seed] in seeds)
    step = problem.starts({"F_c": 7.0})[0]
    some = Approach(problem, seeds, each=True, stepped=step).starts
    assert sorted(s[problem.names.index("F_c")] for s in some) == [5.0, 7.0, 50.0]


def test_starting_values_of_several_effects_are_combined_one_effect_after_another() -> None:
    rig, runs, _ = simulated(11)
    effects = ("sensor_offset", "presliding", "gravity")
    problem = Problem(Campaign.prepare(rig, runs[:3]), "stribeck", "journal", effects)
    every = problem.starts({})
    kept = Approach(problem, [[{}]]).starts
    assert len(kept) == KEPT < 0.2 * len(every)
    squares = [problem.square(start) for start in every]
    best = [problem.square(start) for start in kept]
    assert best == sorted(best)
    assert best[0] < 1.1 * min(squares)
    assert np.median(best) < np.quantile(squares, 0.25)


def test_expected_gain_of_a_linear_effect_is_the_gain_of_its_fit() -> None:
    near = bare_solution(with_mass())
    path = Approach(Problem(with_mass(), "coulomb", "journal", ("inertia",)), [[{}]])
    (seen, promised), found = path.look(near), path.follow(8)
    samples = near.samples
    before, *after = (samples.square(solution.residuals) for solution in (near, seen, found))
    seen_gain, gain = (samples.count * np.log(before / square) for square in after)
    assert promised == pytest.approx(gain, rel=0.01)
    # The expected gain excludes the remaining gain of the model without the effect.
    assert 0.0 < seen_gain <= promised * (1.0 + 1e-3)


def test_expected_gain_does_not_depend_on_the_convergence_of_the_smaller_model() -> None:
    near, effects = bare_solution(with_mass()), ("inertia",)
    bare = Problem(with_mass(), "coulomb", "journal", ())
    far = bare.solution(1.05 * near.values, near.samples, WHITE)
    assert far.samples.square(far.residuals) > 1.1 * near.samples.square(near.residuals)
    gains = [
        Approach(Problem(with_mass(), "coulomb", "journal", effects), [[{}]]).look(solution)[1]
        for solution in (near, far)
    ]
    assert gains[1] == pytest.approx(gains[0], rel=0.01)


def test_expected_gain_exceeds_the_gain_of_the_first_steps_if_the_law_is_nonlinear() -> None:
    near, samples = bare_solution(with_mass()), with_mass().samples
    path = Approach(Problem(with_mass(), "stribeck", "journal", ()), [[{"v_s": 0.02}]])
    seen, promised = path.look(near)
    gain = samples.count * np.log(samples.square(near.residuals) / samples.square(seen.residuals))
    assert promised > gain + 0.01


def test_expected_gain_in_coloured_noise_is_that_of_the_innovations() -> None:
    """A slow wave masks the mass in the squares of residuals, but not in those of innovations."""
    heavy = mass(0.3)
    runs = four_runs(lambda t, v, a: heavy(t, v, a) + 2.0 * np.sin(0.5 * t), noise_rms=0.1)
    slow = Campaign.prepare(Rig(), runs)
    problem = Problem(slow, "coulomb", "journal", ("inertia",))
    near = [bare_solution(slow, noise) for noise in (WHITE, Noise(0.6, 0.95))]
    looks = [Approach(problem, [[{}]]).look(solution) for solution in near]
    pairs = zip(looks, near, strict=True)
    plain, coloured = (likelihood_gain(seen, before) for (seen, _), before in pairs)
    assert coloured > 3.0 * max(plain, 1.0)
    plain, coloured = (promised for _, promised in looks)
    assert coloured > 3.0 * max(plain, 1.0)


def test_search_stops_unconverged_if_it_cannot_reach_the_given_sum_of_squares() -> None:
    problem = Problem(with_mass(), "stribeck", "journal", ("inertia",))
    best = Approach(problem, [[{}]]).follow(60)
    least = problem.square(best.values)
    stopped = Approach(problem, [[{}]]).follow(60, max_square=0.9 * least)
    assert (best.converged, stopped.converged) == (True, False)
    start = Approach(problem, [[{}]]).starts[0]
    assert problem.square(start) > problem.square(stopped.values) > 0.9 * least


def test_approach_reaches_the_minimum_of_a_nonlinear_curve() -> None:
    """A Stribeck curve defined here, fitted by SciPy from several starts."""
    t = np.arange(0.0, 30.0, 0.02)
    v = 0.051 + 0.05 * np.sin(0.7 * t + 1.0)
    noise = 0.1 * np.random.default_rng(3).standard_normal(len(t))
    force = 6.0 + 5.0 * np.exp(-((v / 0.02) ** 2)) + 30.0 * v + noise
    campaign = Campaign.prepare(Rig(), [Run.from_arrays(t, v, force, name="curve")])
    problem = Problem(campaign, "stribeck", "journal", (), {"delta": 2.0})
    speed, friction = campaign.prepared[0].motion.velocity, campaign.prepared[0].friction

    def residual(x: Array) -> Array:
        f_c, f_s, v_s, f_v = np.exp(x)
        return friction - f_c - (f_s - f_c) * np.exp(-((speed / v_s) ** 2)) - f_v * speed

    starts = (np.log([6.0, 10.0, v_s, 20.0]) for v_s in (0.003, 0.01, 0.03, 0.1))
    least = 2.0 * min(optimize.least_squares(residual, start).cost for start in starts)
    assert problem.square(approach(problem, [[{}]], 60).values) <= least * (1.0 + 1e-5)


def test_rms_of_a_fit_with_an_effect_does_not_exceed_that_of_the_base_law() -> None:
    campaign = with_mass()
    problem = Problem(campaign, "coulomb", "journal", ("inertia",))
    law = bare_solution(campaign)
    bad = problem.starts({"F_c": 500.0, "inertia.m_e": 80.0})[0]
    stuck = problem.solution(bad, campaign.samples, WHITE)
    found = not_above_nested(problem, stuck)
    assert found.rms <= law.rms
    assert not_above_nested(problem, found) is found
