"""Log predictive density of held-out samples, against the Gaussian density in scipy.

The errors of a run with derivatives J, predicted from runs with the information matrix A, have the
distribution `N(0, s^2 (I + J A^-1 J'))`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from by_hand import Array
from jbf.estimation.left_out import INSENSITIVE, LeftOut
from jbf.estimation.noise import WHITE, Noise
from jbf.estimation.predictive import mean_square, surprise
from jbf.estimation.samples import Samples
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
    return Solution((), np.zeros(3), residuals, jacobian, WHITE, 0.0, True, "", samples)


def held_out(run: int, errors: Array, determined: Sequence[bool] = ALL) -> LeftOut:
    """A run that a fit did not use."""
    every = np.ones(len(errors), dtype=bool)
    return LeftOut((run,), (every,), np.array(determined), (errors,))


def gaussian(
    solution: Solution, run: int, errors: Array, columns: Sequence[int] = (0, 1, 2)
) -> float:
    """Minus twice the log density of a run's errors, without the constant."""
    weight = solution.samples.weight
    j = [(solution.jacobian[i] * weight[i][:, None])[:, list(columns)] for i in range(3)]
    size = np.linalg.norm(np.concatenate(j), axis=0)
    j = [own / size for own in j]
    information = sum(j[i].T @ j[i] for i in range(3) if i != run)
    information = information + INSENSITIVE * np.eye(len(columns))
    covariance = VARIANCE * (np.eye(len(errors)) + j[run] @ np.linalg.solve(information, j[run].T))
    density = stats.multivariate_normal(cov=covariance).logpdf(errors * weight[run])
    return float(-2.0 * density - len(errors) * np.log(2.0 * np.pi * VARIANCE))


@pytest.mark.parametrize("weighted", [False, True])
def test_log_density_of_held_out_runs_is_that_of_a_gaussian_prediction(weighted: bool) -> None:
    rng = np.random.default_rng(4)
    solution = linear_model(rng, weighted)
    errors = [3.0 * rng.standard_normal(n) for n in COUNTS]
    parts = [held_out(i, e) for i, e in enumerate(errors)]
    found = surprise(solution, parts, solution.samples, WHITE, VARIANCE)
    expected = sum(gaussian(solution, i, e) for i, e in enumerate(errors))
    assert found == pytest.approx(expected, rel=1e-9)


def test_held_parameter_adds_no_uncertainty_to_the_prediction() -> None:
    rng = np.random.default_rng(5)
    solution = linear_model(rng)
    errors = [rng.standard_normal(n) for n in COUNTS]
    parts = [held_out(0, errors[0]), held_out(1, errors[1], (True, False, True))]
    parts.append(held_out(2, errors[2]))
    found = surprise(solution, parts, solution.samples, WHITE, VARIANCE)
    columns = ((0, 1, 2), (0, 2), (0, 1, 2))
    expected = sum(gaussian(solution, i, errors[i], columns[i]) for i in range(3))
    assert found == pytest.approx(expected, rel=1e-9)


def test_error_counts_little_in_a_direction_that_the_other_runs_do_not_determine() -> None:
    """The other runs hold a thousandth of the information on the third parameter."""
    rng = np.random.default_rng(6)
    solution = linear_model(rng)
    for i in (1, 2):
        solution.jacobian[i][:, 2] *= 0.03
    along = solution.jacobian[0][:, 2] / np.linalg.norm(solution.jacobian[0][:, 2])
    across = np.linalg.qr(np.column_stack([solution.jacobian[0], rng.standard_normal(30)]))[0][:, 3]
    rest = [held_out(i, np.zeros(COUNTS[i])) for i in (1, 2)]
    exact, undetermined, determined = (
        surprise(
            solution,
            [held_out(0, 10.0 * np.sqrt(VARIANCE) * direction), *rest],
            solution.samples,
            WHITE,
            VARIANCE,
        )
        for direction in (np.zeros(30), along, across)
    )
    assert determined - exact == pytest.approx(100.0, rel=0.01)
    assert undetermined - exact < 5.0
    # The determinant of the covariance contributes.
    assert exact > np.log(300.0)


def test_half_of_a_run_is_predicted_from_the_other_half_and_the_other_runs() -> None:
    rng = np.random.default_rng(7)
    solution = linear_model(rng)
    errors = [rng.standard_normal(n) for n in COUNTS]
    first = np.arange(COUNTS[0]) < 15
    halves = [LeftOut((0,), (half,), np.ones(3, bool), (errors[0],)) for half in (first, ~first)]
    parts = [*halves, held_out(1, errors[1]), held_out(2, errors[2])]
    found = surprise(solution, parts, solution.samples, WHITE, VARIANCE)
    j = np.concatenate([solution.jacobian[i] for i in range(3)])
    size = np.linalg.norm(j, axis=0)
    expected = sum(gaussian(solution, i, errors[i]) for i in (1, 2))
    for half in (first, ~first):
        own = solution.jacobian[0][half] / size
        information = (j / size).T @ (j / size) - own.T @ own + INSENSITIVE * np.eye(3)
        covariance = VARIANCE * (np.eye(15) + own @ np.linalg.solve(information, own.T))
        density = stats.multivariate_normal(cov=covariance).logpdf(errors[0][half])
        expected += -2.0 * density - 15 * np.log(2.0 * np.pi * VARIANCE)
    assert found == pytest.approx(expected, rel=1e-9)


def test_log_density_of_coloured_errors_is_that_of_their_innovations() -> None:
    rng = np.random.default_rng(8)
    solution, noise = linear_model(rng), Noise(0.3, 0.6)
    errors = [rng.standard_normal(n) for n in COUNTS]
    parts = [held_out(i, e) for i, e in enumerate(errors)]
    found = surprise(solution, parts, solution.samples, noise, VARIANCE)
    white = [noise.innovations(np.asarray(j), 0.1) for j in solution.jacobian]
    same = replace(solution, jacobian=white)
    innovations = [held_out(i, noise.innovations(e, 0.1)) for i, e in enumerate(errors)]
    expected = surprise(same, innovations, same.samples, WHITE, VARIANCE)
    assert found == pytest.approx(expected, rel=1e-9)


def test_mean_square_of_coloured_residuals_is_that_of_their_innovations() -> None:
    solution, noise = linear_model(np.random.default_rng(8)), Noise(0.3, 0.6)
    own = np.concatenate([noise.innovations(r, 0.1) for r in solution.residuals])
    square, count = mean_square(solution, solution.samples, noise)
    assert (square, count) == (pytest.approx(np.mean(own**2)), sum(COUNTS))
