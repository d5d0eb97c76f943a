"""Delay of the force channel of each run, against known delays and an independent scan."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from by_hand import Array
from delayed_runs import (
    DELAY,
    DURATION_S,
    TAU,
    fitted,
    one_way_campaign,
    one_way_speed,
    reversing_campaign,
    value,
)
from jbf.diagnosis.policy import DEFAULT
from jbf.estimation.between_runs import BetweenRuns
from jbf.estimation.lateness import Lateness, lateness
from jbf.estimation.prepared import Prepared
from jbf.estimation.problem import Problem
from jbf.estimation.solution import Solution
from scipy import optimize, stats

CHANCE = DEFAULT.deviation_chance
DELAYS_S = (4e-3, -2e-3, 9e-3, 1e-3)
EXTENDED = pytest.mark.extended


def estimated(
    delays_s: Sequence[float], drift: float = 0.0, effects: Sequence[str] = (), *, seed: int = 0
) -> Lateness | None:
    """The estimate for reversing runs with these delays."""
    return lateness(*fitted(reversing_campaign(delays_s, drift, seed=seed), effects), 0, CHANCE)


def scanned(problem: Problem, solution: Solution) -> tuple[Array, Array]:
    """Delay of each one-way run and its variance, by least squares of `F_c + F_v v(t - d)`."""
    dry, viscous = (value(problem, solution, name) for name in ("F_c_n", "F_v_n_s_m"))
    delays, variances = [], []
    for i, p in enumerate(problem.campaign.prepared):

        def residual(delay_s: float, run: int = i, p: Prepared = p) -> Array:
            v = one_way_speed(run, p.run.time_s - delay_s)
            left: Array = p.friction_n - dry - viscous * v
            return left

        best = optimize.minimize_scalar(
            lambda d, r=residual: float(np.sum(r(d) ** 2)), bounds=(-0.03, 0.03), method="bounded"
        ).x
        slope = (residual(best + 1e-5) - residual(best - 1e-5)) / 2e-5
        delays.append(best)
        variances.append(float(np.mean(residual(best) ** 2) / np.sum(slope**2)))
    return np.array(delays), np.array(variances)


@pytest.mark.parametrize("seed", [0, pytest.param(1, marks=EXTENDED)])
def test_delays_that_differ_between_runs_are_recovered(seed: int) -> None:
    problem, solution = fitted(reversing_campaign(DELAYS_S, seed=seed), DELAY)
    found = lateness(problem, solution, 0, CHANCE)
    assert found is not None
    assert found.drift == 0.0
    # The model's own delay is the part that all runs share.
    total = np.array(found.late_s) + value(problem, solution, TAU)
    np.testing.assert_allclose(total, DELAYS_S, atol=0.6e-3)
    assert found.spread_s == pytest.approx(np.std(DELAYS_S, ddof=1), rel=0.15)


def test_delays_and_their_spread_are_those_of_a_least_squares_scan() -> None:
    """The spread between runs is that of DerSimonian and Laird from these estimates."""
    problem, solution = fitted(one_way_campaign((4e-3, -3e-3, -5e-3, 4e-3), noise_n=0.02))
    found = lateness(problem, solution, 0, CHANCE)
    assert found is not None
    delays, variances = scanned(problem, solution)
    np.testing.assert_allclose(found.late_s, delays, atol=0.25 * np.sqrt(variances.min()))
    w = 1.0 / variances
    q = np.sum(w * (delays - np.average(delays, weights=w)) ** 2)
    spread = np.sqrt((q - 3.0) / (np.sum(w) - np.sum(w**2) / np.sum(w)))
    assert found.spread_s == pytest.approx(spread, rel=0.05)


@pytest.mark.parametrize(
    ("delays_s", "noise_n", "seed"),
    [((-3e-3,) * 4, 0.1, 1), ((3e-3, -2e-3, 2e-3, -1e-3), 0.06, 0)],
    ids=["common early force", "spread between runs"],
)
def test_delays_are_reported_only_if_half_their_chi_square_is_significant(
    delays_s: tuple[float, ...], noise_n: float, seed: int
) -> None:
    """Half, since residuals are never quite as white as the noise model assumes."""
    problem, solution = fitted(one_way_campaign(delays_s, noise_n=noise_n, seed=seed))
    delays, variances = scanned(problem, solution)
    w = 1.0 / variances
    mean = np.average(delays, weights=w)
    q = np.sum(w * (delays - mean) ** 2)
    p = stats.chi2.sf(0.5 * q, 3)
    if min(delays_s) == max(delays_s):
        p = stats.chi2.sf(0.5 * mean**2 * np.sum(w) / max(q / 3.0, 1.0), 1)
    assert 1e-6 < p < 0.1
    assert lateness(problem, solution, 0, 2.0 * p) is not None
    assert lateness(problem, solution, 0, 0.5 * p) is None
    # No spread is estimated from two runs.
    if min(delays_s) < 0.0 < max(delays_s):
        assert lateness(*fitted(problem.campaign.only([0, 1])), 0, 2.0 * p) is None


@pytest.mark.parametrize("changed", ["outliers", "offsets"])
def test_outliers_and_known_offsets_of_the_runs_do_not_change_the_delays(changed: str) -> None:
    """Unclipped, 2 % of outliers of 100 standard deviations would by several milliseconds."""
    problem, solution = fitted(reversing_campaign(DELAYS_S), DELAY)
    usual = lateness(problem, solution, 0, CHANCE)
    random, prepared, samples = np.random.default_rng(5), [], solution.samples
    for p, offset in zip(problem.campaign.prepared, (2.0, -1.5, 1.0, -2.0), strict=True):
        wild = np.where(random.random(len(p.run)) < 0.02, 3.0, 0.0)
        added = wild if changed == "outliers" else offset
        prepared.append(replace(p, friction_n=p.friction_n + added))
    if changed == "offsets":
        directions = tuple(np.full((len(p.run), 1), 50.0) for p in prepared)
        samples = replace(samples, between=BetweenRuns(("offset",), directions, 0.03))
    campaign = replace(problem.campaign, prepared=tuple(prepared))
    again = Problem(campaign, "coulomb", "journal", DELAY, problem.fixed)
    there = again.solution(solution.values, samples, solution.noise)
    found = lateness(again, there, 0, CHANCE)
    assert usual is not None
    assert found is not None
    np.testing.assert_allclose(found.late_s, usual.late_s, atol=0.6e-3)


@pytest.mark.parametrize("drift", [1e-3, pytest.param(-6e-4, marks=EXTENDED)])
def test_clock_drift_is_recovered(drift: float) -> None:
    """A clock that was right at the start has half of its error in the middle of the run."""
    middle = (0.5 * drift * DURATION_S,) * 4
    found = estimated(middle, drift, DELAY)
    assert found is not None
    assert found.drift == pytest.approx(drift, rel=0.1)
    assert found.spread_s == 0.0
    np.testing.assert_allclose(found.late_s, middle, rtol=0.1)


@pytest.mark.parametrize("seed", [0, pytest.param(1, marks=EXTENDED)])
@pytest.mark.parametrize(
    ("delay_s", "effects"),
    [(0.0, ()), (5e-3, ()), (25e-3, DELAY)],
    ids=["no delay", "common delay", "common delay in the model"],
)
def test_no_delay_is_reported_if_it_is_common_to_all_runs(
    delay_s: float, effects: tuple[str, ...], seed: int
) -> None:
    assert estimated((delay_s,) * 4, effects=effects, seed=seed) is None


def test_delay_is_reported_if_the_force_leads_the_motion_in_all_runs() -> None:
    """No instrument responds early, so that a delay effect cannot describe it."""
    found = estimated((-6e-3,) * 4)
    assert found is not None
    assert (found.drift, found.spread_s) == (0.0, 0.0)
    np.testing.assert_allclose(found.late_s, -6e-3, atol=0.5e-3)


def test_delay_outside_the_range_is_replaced_by_the_weighted_mean_of_the_others() -> None:
    problem, solution = fitted(one_way_campaign((14e-3, -12e-3, 9e-3, 60e-3)))
    found = lateness(problem, solution, 0, CHANCE)
    assert found is not None
    *others, last = found.late_s
    w = 1.0 / scanned(problem, solution)[1][:3]
    assert last == pytest.approx(np.average(others, weights=w), abs=0.3e-3)


def test_second_search_resolves_delays_below_one_millisecond() -> None:
    """It searches within 8 ms in steps of 0.5 ms."""
    small = (6e-4, -4e-4, 9e-4, 1e-4)
    there = fitted(reversing_campaign(small, noise_n=3e-3), DELAY)
    found = lateness(*there, 1, CHANCE)
    assert found is not None
    total = np.array(found.late_s) + value(*there, TAU)
    np.testing.assert_allclose(total, small, atol=0.06e-3)


def test_delays_are_recovered_from_jumps_at_reversals_within_a_share_of_a_step() -> None:
    found = lateness(*fitted(reversing_campaign(DELAYS_S)), 0, CHANCE, at_jumps=True)
    assert found is not None
    np.testing.assert_allclose(found.late_s, DELAYS_S, atol=2.2e-3)
    assert lateness(*fitted(reversing_campaign((0.0,) * 4)), 0, CHANCE, at_jumps=True) is None
