"""Delay of the force channel of each run: a search, and a step jointly with the law.

Friction `F_c sign(v) + F_v v` delayed by d is, to first order, less by `d F_v a`: delays and law
together are one linear regression. The search is compared with an independent scan.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from by_hand import Array
from delayed_runs import (
    DELAY,
    DURATION_S,
    TAU,
    fitted,
    one_way_acceleration,
    one_way_campaign,
    reversing_campaign,
    value,
)
from jbf.diagnosis.policy import DEFAULT
from jbf.estimation.delay_scan import scan_delays
from jbf.estimation.delays import DelayStep, drift_step, run_delay_step
from jbf.estimation.noise import WHITE
from jbf.estimation.problem import Problem
from jbf.estimation.random_effects import RandomEffects
from jbf.estimation.settings import DEFAULT as SETTINGS
from jbf.estimation.solution import Solution
from scipy import ndimage, stats

CHANCE = DEFAULT.terms.chance
DELAYS_S = (4e-3, -2e-3, 9e-3, 1e-3)
EXTENDED = pytest.mark.extended


@pytest.mark.parametrize("seed", [0, pytest.param(1, marks=EXTENDED)])
def test_run_delays_that_differ_are_recovered_within_half_a_grid_step(seed: int) -> None:
    """The search for starting values has steps of 2 ms."""
    problem, solution = fitted(reversing_campaign(DELAYS_S, seed=seed), DELAY)
    found = scan_delays(problem, solution, 0, CHANCE)
    assert found.drift == 0.0
    # The delay of the model is the part that is common to all runs.
    total = np.array(found.delays_s) + value(problem, solution, TAU)
    np.testing.assert_allclose(total, DELAYS_S, atol=1e-3)
    assert found.spread_s == pytest.approx(np.std(DELAYS_S, ddof=1), rel=0.15)


@pytest.mark.parametrize("changed", ["outliers", "offsets"])
def test_outliers_and_known_offsets_of_the_runs_do_not_change_the_delays(changed: str) -> None:
    """Outliers of 100 standard deviations, 2 % of the samples, would change unclipped delays."""
    problem, solution = fitted(reversing_campaign(DELAYS_S), DELAY)
    usual = scan_delays(problem, solution, 0, CHANCE)
    random, prepared, samples = np.random.default_rng(5), [], solution.samples
    for p, offset in zip(problem.campaign.prepared, (2.0, -1.5, 1.0, -2.0), strict=True):
        wild = np.where(random.random(len(p.run)) < 0.02, 3.0, 0.0)
        added = wild if changed == "outliers" else offset
        prepared.append(replace(p, friction=p.friction + added))
    if changed == "offsets":
        directions = tuple(np.full((len(p.run), 1), 50.0) for p in prepared)
        samples = replace(samples, between=RandomEffects(("offset",), directions, 0.03))
    campaign = replace(problem.campaign, prepared=tuple(prepared))
    again = Problem(campaign, "coulomb", "journal", DELAY, problem.fixed)
    there = again.solution(solution.values, samples, solution.noise)
    found = scan_delays(again, there, 0, CHANCE)
    np.testing.assert_allclose(found.delays_s, usual.delays_s, atol=0.6e-3)


@pytest.mark.parametrize("drift", [1e-3, pytest.param(-6e-4, marks=EXTENDED)])
def test_clock_drift_is_recovered_within_15_percent_in_reversing_runs(drift: float) -> None:
    """The error of a clock that is exact at the start has half of its final value at mid-run."""
    middle = (0.5 * drift * DURATION_S,) * 4
    found = scan_delays(*fitted(reversing_campaign(middle, drift), DELAY), 0, CHANCE)
    assert found.drift == pytest.approx(drift, rel=0.15)
    assert found.spread_s == 0.0
    np.testing.assert_allclose(found.delays_s, middle, rtol=0.15)


@pytest.mark.parametrize("seed", [0, pytest.param(1, marks=EXTENDED)])
@pytest.mark.parametrize(
    ("delay_s", "effects"),
    [(0.0, ()), (5e-3, ()), (25e-3, DELAY)],
    ids=["no delay", "common delay", "common delay in the model"],
)
def test_no_delay_is_reported_if_common_to_all_runs(
    delay_s: float, effects: Any, seed: int
) -> None:
    campaign = reversing_campaign((delay_s,) * 4, seed=seed)
    assert scan_delays(*fitted(campaign, effects), 0, CHANCE) is None


COVARIANCE = np.array([[4.0, 1.0], [1.0, 2.0]])
STEP = DelayStep(np.array([3.0, 0.0, -1.0]), COVARIANCE, np.array([True, False, True]))
"""Delay step of three runs, the second of which does not determine its delay."""


def white(problem: Problem, solution: Solution) -> DelayStep:
    return run_delay_step(problem, replace(solution, noise=WHITE))


def regression(
    problem: Problem, solution: Solution, columns: Sequence[Array], by_run: bool = True
) -> tuple[Array, Array]:
    """Coefficients of the delay columns, estimated with `F_c` and `F_v`, and their covariance.

    Samples within `linear_s` of a reversal are excluded: a jump is not linear in a delay.
    """
    rows, right = [], []
    for i, (p, residual, column) in enumerate(
        zip(problem.campaign.prepared, solution.residuals, columns, strict=True)
    ):
        width = int(np.ceil(SETTINGS.delays.linear_s / p.step_s))
        far = ~ndimage.binary_dilation(~p.motion.sign_known, iterations=width)
        keep = solution.samples.counted[i] & far
        v = p.motion.velocity
        delays = np.zeros((len(v), len(columns) if by_run else 1))
        delays[:, i if by_run else 0] = column
        weight = solution.samples.weight[i][:, None]
        design = np.column_stack([np.sign(v), v, delays]) * weight
        rows.append(design[keep])
        right.append((residual * weight[:, 0])[keep])
    x, y = np.concatenate(rows), np.concatenate(right)
    coefficients = np.linalg.lstsq(x, y, rcond=None)[0]
    misfit = y - x @ coefficients
    covariance = float(misfit @ misfit) / len(y) * np.linalg.inv(x.T @ x)
    return coefficients[2:], covariance[2:, 2:]


def test_significance_of_a_delay_step_is_that_of_its_wald_statistic() -> None:
    """(3, -1) C^-1 (3, -1)' with C^-1 = ((2, -1), (-1, 4)) / 7 is 28 / 7."""
    assert STEP.square == pytest.approx(4.0)
    assert STEP.p_value == pytest.approx(stats.chi2.sf(4.0, 2))


def test_significance_of_unequal_delays_is_that_of_their_weighted_scatter() -> None:
    """Delays (5, 1) plus the step (3, -1) are (8, 0); the rows of C^-1 sum to 1/7 and 3/7, so the
    mean is 2, and (6, -2) has the square 112 / 7."""
    delays = np.array([5.0, 99.0, 1.0])
    expected = stats.chi2.sf(112.0 / 7.0, 1)
    assert STEP.differences_p_value(delays) == pytest.approx(expected)
    assert STEP.differences_p_value(delays + 40.0) == pytest.approx(expected)


def test_mean_delay_is_weighted_by_inverse_variances() -> None:
    assert STEP.mean_s(np.array([6.0, 99.0, 3.0])) == pytest.approx((6.0 / 4 + 3.0 / 2) / 0.75)


def test_runs_without_information_on_the_delay_do_not_change_its_significance() -> None:
    nothing = DelayStep(np.zeros(2), np.zeros((0, 0)), np.zeros(2, dtype=bool))
    assert nothing.p_value == 1.0
    assert nothing.mean_s(np.array([1.0, 2.0])) == 0.0
    assert nothing.differences_p_value(np.ones(2)) == 1.0
    one = DelayStep(np.array([0.0, 3.0]), np.eye(1), np.array([False, True]))
    assert one.p_value == pytest.approx(stats.chi2.sf(9.0, 1))
    assert one.differences_p_value(np.zeros(2)) == 1.0


def test_delay_step_of_unidirectional_runs_solves_the_normal_equations() -> None:
    problem, solution = fitted(one_way_campaign((2e-3, -1e-3, 3e-3)))
    step = white(problem, solution)
    viscous = value(problem, solution, "F_v")
    t = [p.run.time_s for p in problem.campaign.prepared]
    columns = [-viscous * one_way_acceleration(i, t[i]) for i in range(3)]
    delays, covariance = regression(problem, solution, columns)
    assert step.identifiable.all()
    np.testing.assert_allclose(step.delays_s, delays, atol=2e-5)
    np.testing.assert_allclose(step.delays_s, (2e-3, -1e-3, 3e-3), atol=4e-4)
    np.testing.assert_allclose(step.covariance_s2, covariance, rtol=0.02, atol=1e-11)


def test_samples_next_to_reversals_are_excluded_from_the_delay_step() -> None:
    delays_s = (2e-3, -1e-3, 3e-3, 0.0)
    problem, solution = fitted(reversing_campaign(delays_s, noise_rms=0.1, speed_noise_m_s=1e-3))
    assert all(np.any(~p.motion.sign_known) for p in problem.campaign.prepared)
    step = white(problem, solution)
    viscous = value(problem, solution, "F_v")
    columns = [-viscous * p.motion.acceleration for p in problem.campaign.prepared]
    delays, covariance = regression(problem, solution, columns)
    sd = np.sqrt(np.diag(covariance))
    assert np.all(np.abs(step.delays_s - delays) < 0.15 * sd)
    np.testing.assert_allclose(np.sqrt(np.diag(step.covariance_s2)), sd, rtol=0.05)


def test_delay_of_the_model_and_the_step_add_up_to_the_delay_of_each_run() -> None:
    delays_s = (12e-3, 9e-3, 13e-3)
    problem, solution = fitted(one_way_campaign(delays_s), DELAY)
    step = white(problem, solution)
    total = step.delays_s + value(problem, solution, TAU)
    np.testing.assert_allclose(total, delays_s, atol=4e-4)
    alone = white(*fitted(one_way_campaign((0.0,) * 3)))
    np.testing.assert_allclose(np.diag(step.covariance_s2), np.diag(alone.covariance_s2), rtol=0.1)


@pytest.mark.parametrize(("ratio", "known"), [(0.98, True), (1.02, False)])
def test_delay_or_drift_is_undetermined_beyond_the_linear_range(ratio: float, known: bool) -> None:
    """Standard errors scale with the residuals; that of a drift is multiplied by the duration."""
    problem, solution = fitted(one_way_campaign((0.0, 0.0), durations_s=(20.0, 10.0)))
    plain = replace(solution, noise=WHITE)
    delay_sd = run_delay_step(problem, plain).covariance_s2[0, 0] ** 0.5
    drift_sd = drift_step(problem, plain).variance ** 0.5 * 20.0
    scales = (ratio * SETTINGS.delays.linear_s / sd for sd in (delay_sd, drift_sd))
    delay, drift = (replace(plain, residuals=[x * r for r in plain.residuals]) for x in scales)
    assert run_delay_step(problem, delay).identifiable[0] == known
    assert np.isfinite(drift_step(problem, drift).variance) == known


def test_no_delay_is_determined_if_all_residuals_are_zero() -> None:
    problem, solution = fitted(one_way_campaign((0.0,) * 3, noise_rms=0.0))
    step = run_delay_step(problem, solution)
    assert np.all(np.isfinite(step.delays_s))
    exact = replace(solution, residuals=[np.zeros(len(r)) for r in solution.residuals], noise=WHITE)
    step = run_delay_step(problem, exact)
    assert not np.any(step.identifiable)
    assert step.p_value == 1.0


@pytest.mark.extended
def test_p_values_of_campaigns_without_delay_are_uniform() -> None:
    """P-values of Wald's test under its null hypothesis, by the test of Kolmogorov and Smirnov."""
    campaigns = (one_way_campaign((0.0,) * 3, seed=seed) for seed in range(60))
    chances = [run_delay_step(*fitted(campaign)).p_value for campaign in campaigns]
    assert stats.kstest(chances, "uniform").pvalue > 0.02


def test_drift_step_of_unidirectional_runs_solves_the_normal_equations() -> None:
    drift = 1.2e-4
    campaign = one_way_campaign((0.0, 0.0), drift, durations_s=(20.0, 10.0))
    problem, solution = fitted(campaign)
    viscous = value(problem, solution, "F_v")
    times = [p.run.time_s for p in campaign.prepared]
    columns = [-viscous * one_way_acceleration(i, t) * t for i, t in enumerate(times)]
    (expected,), covariance = regression(problem, solution, columns, by_run=False)
    step = drift_step(problem, replace(solution, noise=WHITE))
    assert step.drift == pytest.approx(expected, rel=0.02)
    assert step.drift == pytest.approx(drift, abs=4.0 * covariance[0, 0] ** 0.5)
    assert step.variance == pytest.approx(covariance[0, 0], rel=0.02)
    assert step.square == pytest.approx(step.drift**2 / step.variance)


def test_common_delay_biases_the_drift_unless_both_are_estimated() -> None:
    """The regression of a constant d on t over a run of duration T has the slope 3 d / (2 T)."""
    delay_s = 3e-3
    campaign = one_way_campaign((delay_s,) * 2, seed=5)
    there = fitted(campaign)
    alone, with_delay = drift_step(*there), drift_step(*there, with_delay=True)
    assert alone.drift == pytest.approx(1.5 * delay_s / 20.0, rel=0.3)
    assert alone.square > 50.0
    assert with_delay.square < 9.0
    assert with_delay.variance == pytest.approx(4.0 * alone.variance, rel=0.3)
    # A delay that the model contains is not estimated twice.
    delayed = fitted(campaign, DELAY)
    assert drift_step(*delayed, with_delay=True) == drift_step(*delayed)
