"""Joint Gauss-Newton step in delays and model parameters, against the normal equations.

Friction `F_c sign(v) + F_v v` delayed by d is, to first order, less by `d F_v a`: delays and law
together are one linear regression.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from by_hand import Array
from delayed_runs import (
    DELAY,
    TAU,
    fitted,
    one_way_acceleration,
    one_way_campaign,
    reversing_campaign,
    value,
)
from jbf.estimation.joint_lateness import (
    LINEAR_S,
    LatenessStep,
    drift_step,
    lateness_step,
)
from jbf.estimation.noise import WHITE
from jbf.estimation.problem import Problem
from jbf.estimation.solution import Solution
from scipy import ndimage, stats

COVARIANCE = np.array([[4.0, 1.0], [1.0, 2.0]])
STEP = LatenessStep(np.array([3.0, 0.0, -1.0]), COVARIANCE, np.array([True, False, True]))
"""A step of three runs, of which the second does not determine its delay."""


def white(problem: Problem, solution: Solution) -> LatenessStep:
    """The step with residuals that are not whitened."""
    return lateness_step(problem, replace(solution, noise=WHITE))


def regression(
    problem: Problem, solution: Solution, columns: Sequence[Array], by_run: bool = True
) -> tuple[Array, Array]:
    """Coefficients of the delay columns, estimated with `F_c` and `F_v`, and their covariance.

    Samples within `LINEAR_S` of a reversal are left out: a jump is not linear in a delay.
    """
    rows, right = [], []
    for i, (p, residual, column) in enumerate(
        zip(problem.campaign.prepared, solution.residuals, columns, strict=True)
    ):
        width = int(np.ceil(LINEAR_S / p.step_s))
        far = ~ndimage.binary_dilation(~p.motion.sign_known, iterations=width)
        keep = solution.samples.counted[i] & far
        v = p.motion.velocity_m_s
        delays = np.zeros((len(v), len(columns) if by_run else 1))
        delays[:, i if by_run else 0] = column
        weight = solution.samples.weight[i][:, None]
        design = np.column_stack([np.sign(v), v, delays]) * weight
        rows.append(design[keep])
        right.append((residual * weight[:, 0])[keep])
    x, y = np.concatenate(rows), np.concatenate(right)
    coefficients = np.linalg.lstsq(x, y, rcond=None)[0]
    left = y - x @ coefficients
    covariance = float(left @ left) / len(y) * np.linalg.inv(x.T @ x)
    return coefficients[2:], covariance[2:, 2:]


# ---- statistics of a step ------------------------------------------------------------------------


def test_significance_of_a_step_is_that_of_its_wald_statistic() -> None:
    """(3, -1) C^-1 (3, -1)' with C^-1 = ((2, -1), (-1, 4)) / 7 is 28 / 7."""
    assert STEP.square == pytest.approx(4.0)
    assert STEP.chance == pytest.approx(stats.chi2.sf(4.0, 2))


@pytest.mark.parametrize("share", [0.25, 1.0])
def test_significance_of_unequal_delays_follows_from_distances_to_the_weighted_mean(
    share: float,
) -> None:
    """Delays (5, 1) plus the step (3, -1) are (8, 0); the rows of C^-1 sum to 1/7 and 3/7, so the
    mean is 2, and (6, -2) has the square 112 / 7."""
    delays = np.array([5.0, 99.0, 1.0])
    expected = stats.chi2.sf(share * 112.0 / 7.0, 1)
    assert STEP.differ_chance(delays, share) == pytest.approx(expected)
    assert STEP.differ_chance(delays + 40.0, share) == pytest.approx(expected)


def test_mean_delay_is_weighted_by_inverse_variances() -> None:
    assert STEP.mean_s(np.array([6.0, 99.0, 3.0])) == pytest.approx((6.0 / 4 + 3.0 / 2) / 0.75)


def test_runs_without_information_on_the_delay_do_not_change_its_significance() -> None:
    nothing = LatenessStep(np.zeros(2), np.zeros((0, 0)), np.zeros(2, dtype=bool))
    assert nothing.chance == 1.0
    assert nothing.mean_s(np.array([1.0, 2.0])) == 0.0
    assert nothing.differ_chance(np.ones(2), 1.0) == 1.0
    one = LatenessStep(np.array([0.0, 3.0]), np.eye(1), np.array([False, True]))
    assert one.chance == pytest.approx(stats.chi2.sf(9.0, 1))
    assert one.differ_chance(np.zeros(2), 1.0) == 1.0


# ---- delay of each run ---------------------------------------------------------------------------


def test_delay_step_solves_the_normal_equations() -> None:
    problem, solution = fitted(one_way_campaign((2e-3, -1e-3, 3e-3)))
    step = white(problem, solution)
    viscous = value(problem, solution, "F_v_n_s_m")
    t = [p.run.time_s for p in problem.campaign.prepared]
    columns = [-viscous * one_way_acceleration(i, t[i]) for i in range(3)]
    delays, covariance = regression(problem, solution, columns)
    assert step.told.all()
    np.testing.assert_allclose(step.late_s, delays, atol=2e-5)
    np.testing.assert_allclose(step.late_s, (2e-3, -1e-3, 3e-3), atol=4e-4)
    np.testing.assert_allclose(step.covariance_s2, covariance, rtol=0.02, atol=1e-11)


def test_samples_next_to_reversals_are_excluded_from_the_delay_step() -> None:
    """In reversing runs the regression agrees only without them."""
    delays_s = (2e-3, -1e-3, 3e-3, 0.0)
    problem, solution = fitted(reversing_campaign(delays_s, noise_n=0.1, speed_noise_m_s=1e-3))
    assert all(np.any(~p.motion.sign_known) for p in problem.campaign.prepared)
    step = white(problem, solution)
    viscous = value(problem, solution, "F_v_n_s_m")
    columns = [-viscous * p.motion.acceleration_m_s2 for p in problem.campaign.prepared]
    delays, covariance = regression(problem, solution, columns)
    sd = np.sqrt(np.diag(covariance))
    assert np.all(np.abs(step.late_s - delays) < 0.15 * sd)
    np.testing.assert_allclose(np.sqrt(np.diag(step.covariance_s2)), sd, rtol=0.05)


def test_delay_of_the_model_and_the_step_add_up_to_the_delay_of_each_run() -> None:
    delays_s = (12e-3, 9e-3, 13e-3)
    problem, solution = fitted(one_way_campaign(delays_s), DELAY)
    step = white(problem, solution)
    total = step.late_s + value(problem, solution, TAU)
    np.testing.assert_allclose(total, delays_s, atol=4e-4)
    alone = white(*fitted(one_way_campaign((0.0,) * 3)))
    np.testing.assert_allclose(np.diag(step.covariance_s2), np.diag(alone.covariance_s2), rtol=0.1)


@pytest.mark.parametrize(("ratio", "determined"), [(0.98, True), (1.02, False)])
def test_delay_and_drift_are_not_determined_if_their_error_exceeds_the_linear_range(
    ratio: float, determined: bool
) -> None:
    """Standard errors are proportional to the residuals; that of a drift counts over a run."""
    problem, solution = fitted(one_way_campaign((0.0, 0.0), durations_s=(20.0, 10.0)))
    plain = replace(solution, noise=WHITE)
    delay_sd = lateness_step(problem, plain).covariance_s2[0, 0] ** 0.5
    drift_sd = drift_step(problem, plain).variance ** 0.5 * 20.0
    delay, drift = (
        replace(plain, residuals=[ratio * LINEAR_S / sd * r for r in plain.residuals])
        for sd in (delay_sd, drift_sd)
    )
    assert lateness_step(problem, delay).told[0] == determined
    assert np.isfinite(drift_step(problem, drift).variance) == determined


def test_no_delay_is_determined_if_all_residuals_are_zero() -> None:
    """Without a residual there is no estimate of the error."""
    problem, solution = fitted(one_way_campaign((0.0,) * 3, noise_n=0.0))
    step = lateness_step(problem, solution)
    assert np.all(np.isfinite(step.late_s))
    exact = replace(solution, residuals=[np.zeros(len(r)) for r in solution.residuals], noise=WHITE)
    step = lateness_step(problem, exact)
    assert not np.any(step.told)
    assert step.chance == 1.0


@pytest.mark.extended
def test_p_values_of_campaigns_without_delay_are_uniform() -> None:
    """Wald's test under its null hypothesis, by the test of Kolmogorov and Smirnov."""
    chances = [
        lateness_step(*fitted(one_way_campaign((0.0,) * 3, seed=s))).chance for s in range(60)
    ]
    assert stats.kstest(chances, "uniform").pvalue > 0.02


# ---- one clock -----------------------------------------------------------------------------------


def test_drift_step_solves_the_normal_equations() -> None:
    """A clock that was right at the start of each run; one run is half as long as the other."""
    drift = 1.2e-4
    campaign = one_way_campaign((0.0, 0.0), drift, durations_s=(20.0, 10.0))
    problem, solution = fitted(campaign)
    viscous = value(problem, solution, "F_v_n_s_m")
    times = [p.run.time_s for p in campaign.prepared]
    columns = [-viscous * one_way_acceleration(i, t) * t for i, t in enumerate(times)]
    (expected,), covariance = regression(problem, solution, columns, by_run=False)
    step = drift_step(problem, replace(solution, noise=WHITE))
    assert step.drift == pytest.approx(expected, rel=0.02)
    assert step.drift == pytest.approx(drift, abs=4.0 * covariance[0, 0] ** 0.5)
    assert step.variance == pytest.approx(covariance[0, 0], rel=0.02)
    assert step.square == pytest.approx(step.drift**2 / step.variance)


def test_common_delay_biases_the_drift_unless_both_are_estimated() -> None:
    """The regression of a constant on t over the length T of a run has the slope 3 d / (2 T)."""
    delay_s = 3e-3
    campaign = one_way_campaign((delay_s,) * 2, seed=5)
    there = fitted(campaign)
    alone, with_delay = drift_step(*there), drift_step(*there, beside_delay=True)
    assert alone.drift == pytest.approx(1.5 * delay_s / 20.0, rel=0.3)
    assert alone.square > 50.0
    assert with_delay.square < 9.0
    assert with_delay.variance == pytest.approx(4.0 * alone.variance, rel=0.3)
    # The delay of a model that has one is not estimated twice.
    delayed = fitted(campaign, DELAY)
    assert drift_step(*delayed, beside_delay=True) == drift_step(*delayed)
