"""Log predictive density of held-out samples, against the Gaussian density in scipy.

The errors of a run with derivatives J, predicted from runs with the information matrix A, have the
distribution `N(0, s^2 (I + J A^-1 J'))`.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from by_hand import Array
from jbf import Rig, Run
from jbf.estimation.campaign import Campaign
from jbf.estimation.held_out import HeldOutPart
from jbf.estimation.held_out_comparison import (
    extrapolated_runs,
    mean_square,
    predictive_deviance,
)
from jbf.estimation.noise import WHITE, Noise
from jbf.estimation.samples import Samples
from jbf.estimation.settings import DEFAULT as SETTINGS
from jbf.estimation.solution import Solution
from scipy import stats

VARIANCE = 0.3
COUNTS = (30, 20, 25)
ALL = (True, True, True)


def linear_model(rng: np.random.Generator, weighted: bool = False) -> Solution:
    """Three runs of a linear model of three parameters of very different scales."""
    jacobian = [rng.standard_normal((n, 3)) * [1e-4, 1.0, 300.0] for n in COUNTS]
    residuals = [np.sqrt(VARIANCE) * rng.standard_normal(n) for n in COUNTS]
    weight = [rng.uniform(0.2, 1.0, n) if weighted else np.ones(n) for n in COUNTS]
    counted = tuple(np.ones(n, dtype=bool) for n in COUNTS)
    samples = Samples(("a", "b", "c"), (0.1, 0.1, 0.1), counted, tuple(weight))
    return Solution((), np.zeros(3), residuals, jacobian, WHITE, True, "", samples)


def held_out(run: int, errors: Array, determined: Sequence[bool] = ALL) -> HeldOutPart:
    every = np.ones(len(errors), dtype=bool)
    return HeldOutPart((run,), (every,), np.array(determined), (errors,))


def gaussian(solution: Solution, part: HeldOutPart) -> float:
    """Minus twice the log density of the errors in a part of a run, without the constant."""
    (run,), (mask,) = part.runs, part.masks
    weight = solution.samples.weight
    slopes = zip(solution.jacobian, weight, strict=True)
    j = [(slope * w[:, None])[:, part.identified] for slope, w in slopes]
    every = np.concatenate(j) / np.linalg.norm(np.concatenate(j), axis=0)
    held_out_rows = (j[run] / np.linalg.norm(np.concatenate(j), axis=0))[mask]
    information = (
        every.T @ every
        - held_out_rows.T @ held_out_rows
        + SETTINGS.held_out.min_information * np.eye(held_out_rows.shape[1])
    )
    covariance = VARIANCE * (
        np.eye(len(held_out_rows)) + held_out_rows @ np.linalg.solve(information, held_out_rows.T)
    )
    errors = (part.residuals[0] * weight[run])[mask]
    density = stats.multivariate_normal(cov=covariance).logpdf(errors)
    return float(-2.0 * density - len(held_out_rows) * np.log(2.0 * np.pi * VARIANCE))


@pytest.mark.parametrize(
    ("weighted", "determined"), [(False, ALL), (True, ALL), (False, (True, False, True))]
)
def test_density_of_held_out_runs_is_gaussian_in_free_parameters(
    weighted: bool, determined: tuple[bool, ...]
) -> None:
    rng = np.random.default_rng(4)
    solution = linear_model(rng, weighted)
    errors = [3.0 * rng.standard_normal(n) for n in COUNTS]
    parts = [held_out(i, e, determined if i == 1 else ALL) for i, e in enumerate(errors)]
    found = predictive_deviance(solution, parts, solution.samples, WHITE, VARIANCE)
    assert found == pytest.approx(sum(gaussian(solution, p) for p in parts), rel=1e-9)


def test_held_out_error_in_a_direction_undetermined_by_other_runs_hardly_lowers_density() -> None:
    """The other runs contain a thousandth of the information on the third parameter."""
    rng = np.random.default_rng(6)
    solution = linear_model(rng)
    for i in (1, 2):
        solution.jacobian[i][:, 2] *= 0.03
    along = solution.jacobian[0][:, 2] / np.linalg.norm(solution.jacobian[0][:, 2])
    across = np.linalg.qr(np.column_stack([solution.jacobian[0], rng.standard_normal(30)]))[0][:, 3]
    rest, size = [held_out(i, np.zeros(COUNTS[i])) for i in (1, 2)], 10.0 * np.sqrt(VARIANCE)
    exact, undetermined, determined = (
        predictive_deviance(
            solution, [held_out(0, errors), *rest], solution.samples, WHITE, VARIANCE
        )
        for errors in (np.zeros(30), size * along, size * across)
    )
    assert determined - exact == pytest.approx(100.0, rel=0.01)
    assert undetermined - exact < 5.0
    # The determinant of the covariance contributes to the density.
    assert exact > np.log(300.0)


def test_half_of_a_run_is_predicted_from_the_other_half_and_the_other_runs() -> None:
    rng = np.random.default_rng(7)
    solution = linear_model(rng)
    errors = [rng.standard_normal(n) for n in COUNTS]
    first = np.arange(COUNTS[0]) < 15
    halves = [
        HeldOutPart((0,), (half,), np.ones(3, bool), (errors[0],)) for half in (first, ~first)
    ]
    parts = [*halves, held_out(1, errors[1]), held_out(2, errors[2])]
    found = predictive_deviance(solution, parts, solution.samples, WHITE, VARIANCE)
    assert found == pytest.approx(sum(gaussian(solution, p) for p in parts), rel=1e-9)


def test_log_density_of_coloured_errors_is_that_of_their_innovations() -> None:
    rng = np.random.default_rng(8)
    solution, noise = linear_model(rng), Noise(0.3, 0.6)
    errors = [rng.standard_normal(n) for n in COUNTS]
    parts = [held_out(i, e) for i, e in enumerate(errors)]
    found = predictive_deviance(solution, parts, solution.samples, noise, VARIANCE)
    white = [noise.innovations(np.asarray(j), 0.1) for j in solution.jacobian]
    same = replace(solution, jacobian=white)
    innovations = [held_out(i, noise.innovations(e, 0.1)) for i, e in enumerate(errors)]
    expected = predictive_deviance(same, innovations, same.samples, WHITE, VARIANCE)
    assert found == pytest.approx(expected, rel=1e-9)


def test_mean_square_of_coloured_residuals_is_that_of_their_innovations() -> None:
    solution, noise = linear_model(np.random.default_rng(8)), Noise(0.3, 0.6)
    own = np.concatenate([noise.innovations(r, 0.1) for r in solution.residuals])
    square, count = mean_square(solution, solution.samples, noise)
    assert (square, count) == (pytest.approx(np.mean(own**2)), sum(COUNTS))


@pytest.mark.parametrize(
    ("shares", "beyond"),
    [
        pytest.param({}, [], id="equal ranges"),
        pytest.param({0.3: 0.06}, [(0.3, 0.2)], id="faster"),
        pytest.param({0.3: 0.04}, [], id="a few faster samples"),
        pytest.param({-0.3: 0.06}, [(-0.3, 0.0)], id="other direction"),
        pytest.param({-0.3: 0.01}, [], id="a few samples in the other direction"),
        pytest.param({0.05: 0.06}, [(0.05, 0.1)], id="slower"),
    ],
)
def test_run_is_extrapolated_if_some_of_its_samples_are_beyond_all_other_runs(
    shares: dict[float, float], beyond: list[tuple[float, float]]
) -> None:
    """Three runs with speeds from 0.1 to 0.2 m/s, the last with other speeds as well."""
    time, runs = 0.01 * np.arange(1000), []
    for k in range(3):
        speed = np.linspace(0.1, 0.2, 1000)
        for other, share in shares.items() if k == 2 else ():
            speed[: round(share * 1000)] = other
        runs.append(Run.from_arrays(time, speed, 5.0 * np.sign(speed), name=f"run{k}"))
    campaign = Campaign.prepare(Rig(), runs)
    found = [
        (campaign.samples.runs[e.run], e.quantity, round(e.value, 6), round(e.others, 6))
        for e in extrapolated_runs(campaign)
    ]
    assert found == [("run2", "speed", *values) for values in beyond]
