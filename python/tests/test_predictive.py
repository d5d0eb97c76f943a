"""The log predictive density against the Gaussian that it is the density of."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest
from jbf.estimation.left_out import INSENSITIVE, LeftOut
from jbf.estimation.noise import WHITE, Noise
from jbf.estimation.predictive import mean_square, surprise
from jbf.estimation.samples import Samples
from jbf.estimation.solution import Solution
from scipy import stats

Array = npt.NDArray[np.float64]

VARIANCE = 0.3
COUNTS = (30, 20, 25)


def solved(rng: np.random.Generator, weights: bool = False) -> Solution:
    """Three runs of a linear model of three parameters, of very different sizes."""
    jacobian = [rng.standard_normal((n, 3)) * [1e-4, 1.0, 300.0] for n in COUNTS]
    residuals = [np.sqrt(VARIANCE) * rng.standard_normal(n) for n in COUNTS]
    weight = [rng.uniform(0.2, 1.0, n) if weights else np.ones(n) for n in COUNTS]
    counted = tuple(np.ones(n, dtype=bool) for n in COUNTS)
    samples = Samples(("a", "b", "c"), (0.1, 0.1, 0.1), counted, tuple(weight))
    return Solution((), np.zeros(3), residuals, jacobian, WHITE, 0.0, True, "", samples)


def whole(run: int, residual: Array, told: tuple[bool, ...] = (True, True, True)) -> LeftOut:
    """One run that had no part in a fit."""
    return LeftOut((run,), (np.ones(len(residual), dtype=bool),), np.array(told), (residual,))


def gaussian(solution: Solution, run: int, errors: Array, told: list[int]) -> float:
    """Minus twice the log density of a run's errors, by the covariance of the whole prediction."""
    weight = solution.samples.weight
    j = [(solution.jacobian[i] * weight[i][:, None])[:, told] for i in range(3)]
    size = np.linalg.norm(np.concatenate(j), axis=0)
    j = [own / size for own in j]
    known = sum(j[i].T @ j[i] for i in range(3) if i != run) + INSENSITIVE * np.eye(len(told))
    spread = VARIANCE * (np.eye(len(errors)) + j[run] @ np.linalg.solve(known, j[run].T))
    density = stats.multivariate_normal(cov=spread).logpdf(errors * weight[run])
    return float(-2.0 * density - len(errors) * np.log(2.0 * np.pi * VARIANCE))


@pytest.mark.parametrize("weights", [False, True])
def test_it_is_the_density_of_a_gaussian_prediction(weights: bool) -> None:
    rng = np.random.default_rng(4)
    solution = solved(rng, weights)
    errors = [3.0 * rng.standard_normal(n) for n in COUNTS]
    parts = [whole(i, e) for i, e in enumerate(errors)]
    found = surprise(solution, parts, solution.samples, WHITE, VARIANCE)
    wanted = sum(gaussian(solution, i, e, [0, 1, 2]) for i, e in enumerate(errors))
    assert found == pytest.approx(wanted, rel=1e-9)


def test_a_parameter_that_was_held_makes_no_prediction_uncertain() -> None:
    rng = np.random.default_rng(5)
    solution = solved(rng)
    errors = [rng.standard_normal(n) for n in COUNTS]
    parts = [whole(0, errors[0]), whole(1, errors[1], (True, False, True)), whole(2, errors[2])]
    found = surprise(solution, parts, solution.samples, WHITE, VARIANCE)
    told = ([0, 1, 2], [0, 2], [0, 1, 2])
    wanted = sum(gaussian(solution, i, errors[i], told[i]) for i in range(3))
    assert found == pytest.approx(wanted, rel=1e-9)


def test_an_error_along_what_the_others_do_not_know_tells_little() -> None:
    rng = np.random.default_rng(6)
    solution = solved(rng)
    for i in (1, 2):
        # Only the first run knows of the third parameter: the others hold a thousandth of it.
        solution.jacobian[i][:, 2] *= 0.03
    along = solution.jacobian[0][:, 2] / np.linalg.norm(solution.jacobian[0][:, 2])
    across = np.linalg.qr(np.column_stack([solution.jacobian[0], rng.standard_normal(30)]))[0][:, 3]
    size = 10.0 * np.sqrt(VARIANCE)
    rest = [whole(i, np.zeros(COUNTS[i])) for i in (1, 2)]
    base, one, other = (
        surprise(solution, [whole(0, size * way), *rest], solution.samples, WHITE, VARIANCE)
        for way in (np.zeros(30), along, across)
    )
    assert other - base == pytest.approx(100.0, rel=0.01)
    assert one - base < 5.0
    # It is paid for all the same.
    assert base > np.log(300.0)


def test_half_of_a_run_is_predicted_from_the_other_half_too() -> None:
    rng = np.random.default_rng(7)
    solution = solved(rng)
    errors = [rng.standard_normal(n) for n in COUNTS]
    told, first = np.ones(3, dtype=bool), np.arange(COUNTS[0]) < 15
    halves = [LeftOut((0,), (half,), told, (errors[0],)) for half in (first, ~first)]
    parts = [*halves, whole(1, errors[1]), whole(2, errors[2])]
    found = surprise(solution, parts, solution.samples, WHITE, VARIANCE)
    j = np.concatenate([solution.jacobian[i] for i in range(3)])
    size = np.linalg.norm(j, axis=0)
    wanted = sum(gaussian(solution, i, errors[i], [0, 1, 2]) for i in (1, 2))
    for half in (first, ~first):
        own = solution.jacobian[0][half] / size
        known = (j / size).T @ (j / size) - own.T @ own + INSENSITIVE * np.eye(3)
        spread = VARIANCE * (np.eye(15) + own @ np.linalg.solve(known, own.T))
        density = stats.multivariate_normal(cov=spread).logpdf(errors[0][half])
        wanted += -2.0 * density - 15 * np.log(2.0 * np.pi * VARIANCE)
    assert found == pytest.approx(wanted, rel=1e-9)


def test_coloured_errors_are_whitened_first() -> None:
    rng = np.random.default_rng(8)
    solution, noise = solved(rng), Noise(0.3, 0.6)
    errors = [rng.standard_normal(n) for n in COUNTS]
    parts = [whole(i, e) for i, e in enumerate(errors)]
    found = surprise(solution, parts, solution.samples, noise, VARIANCE)
    white = [noise.innovations(np.asarray(j), 0.1) for j in solution.jacobian]
    same = Solution(
        (), np.zeros(3), solution.residuals, white, WHITE, 0.0, True, "", solution.samples
    )
    left = [whole(i, noise.innovations(e, 0.1)) for i, e in enumerate(errors)]
    assert found == pytest.approx(surprise(same, left, same.samples, WHITE, VARIANCE), rel=1e-9)
    square, count = mean_square(solution, solution.samples, noise)
    own = np.concatenate([noise.innovations(r, 0.1) for r in solution.residuals])
    assert (square, count) == (pytest.approx(np.mean(own**2)), sum(COUNTS))


def test_samples_without_weight_say_nothing() -> None:
    """As if they had not been recorded; noise is white, so none drives another."""
    rng = np.random.default_rng(9)
    there = solved(rng)
    keep = [np.arange(n) % 4 > 0 for n in COUNTS]
    samples = replace(there.samples, weight=tuple(k.astype(float) for k in keep))
    errors = [rng.standard_normal(n) for n in COUNTS]
    some = replace(there, jacobian=[j[k] for j, k in zip(there.jacobian, keep, strict=True)])
    ones = tuple(np.ones(int(k.sum())) for k in keep)
    fewer = replace(samples, weight=ones, counted=tuple(one > 0.0 for one in ones))
    parts = [whole(i, e) for i, e in enumerate(errors)]
    rest = [whole(i, e[k]) for i, (e, k) in enumerate(zip(errors, keep, strict=True))]
    assert surprise(there, parts, samples, WHITE, VARIANCE) == pytest.approx(
        surprise(some, rest, fewer, WHITE, VARIANCE)
    )


def test_a_parameter_that_moves_nothing_changes_nothing() -> None:
    rng = np.random.default_rng(10)
    there = solved(rng)
    errors = [rng.standard_normal(n) for n in COUNTS]
    parts = [whole(i, e) for i, e in enumerate(errors)]
    usual = surprise(there, parts, there.samples, WHITE, VARIANCE)
    wide = [np.column_stack([j, np.zeros(len(j))]) for j in there.jacobian]
    more = [whole(i, e, (True,) * 4) for i, e in enumerate(errors)]
    still = replace(there, jacobian=wide)
    assert surprise(still, more, there.samples, WHITE, VARIANCE) == pytest.approx(usual)
