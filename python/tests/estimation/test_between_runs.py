"""Random effects between runs: the mixed model (Laird & Ware 1982) and the estimate of its spread
(DerSimonian & Laird 1986) against closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from by_hand import Array
from coulomb_problems import STEP_S, arma_innovations
from jbf.estimation.between_runs import BetweenRuns
from jbf.estimation.noise import WHITE, Noise
from jbf.estimation.random_effect import spread_between
from jbf.estimation.samples import Samples
from scipy import linalg, stats

N = 120
SIGMA_N = 0.3
COLOURED = Noise(memory_s=0.2, colour=0.4)
NOISES = pytest.mark.parametrize("noise", [WHITE, COLOURED], ids=["white", "coloured"])


def deviations(runs: int = 2) -> BetweenRuns:
    """Random effects: an offset of 0.5 N and a wave of 0.8 N whose frequency differs by run."""
    time = STEP_S * np.arange(N)
    directions = [
        np.stack([np.full(N, 0.5), 0.8 * np.sin((i + 1.0) * time)], axis=1) for i in range(runs)
    ]
    return BetweenRuns(("zero", "wave"), tuple(directions), SIGMA_N)


def weights() -> Array:
    """Weights of samples: zero for four of them, 0.2 to 1 for the others."""
    weight = np.random.default_rng(1).uniform(0.2, 1.0, N)
    weight[[0, 17, 18, 90]] = 0.0
    return weight


def filtered(noise: Noise, values: Array, weight: Array) -> Array:
    """Innovations of weighted values, at the samples with weight."""
    weighted = (values.T * weight).T
    return arma_innovations(weighted, STEP_S, noise)[weight > 0.0]


@NOISES
@pytest.mark.parametrize("run", [0, 1])
def test_whitened_rows_have_the_inner_products_of_the_inverse_covariance(
    noise: Noise, run: int
) -> None:
    """Innovations over their standard deviation have the covariance I + Z Z'."""
    between, weight = deviations(), weights()
    values = np.random.default_rng(2).standard_normal((N, 4)) + np.eye(4)[0]
    e = filtered(noise, values, weight)
    z = filtered(noise, between.directions[run], weight) / SIGMA_N
    root = np.linalg.cholesky(np.eye(len(e)) + z @ z.T)
    wanted = linalg.solve_triangular(root, e, lower=True)
    found, vector = between.whitened(run, [e, e[:, 1]], weight, STEP_S, noise)
    np.testing.assert_allclose(found.T @ found, wanted.T @ wanted, rtol=1e-10, atol=1e-10)
    np.testing.assert_allclose(vector, found[:, 1], rtol=1e-12)


@NOISES
def test_predicted_random_effect_is_a_ridge_regression_over_weighted_samples(noise: Noise) -> None:
    """Deviations of unit variance are penalised by their squares (Henderson 1975)."""
    between, weight = deviations(), weights()
    residual = np.random.default_rng(5).standard_normal(N) + between.directions[1] @ [1.5, -0.7]
    z = filtered(noise, between.directions[1], weight)
    e = filtered(noise, residual, weight)
    rows = np.vstack([z, SIGMA_N * np.eye(2)])
    size, *_ = np.linalg.lstsq(rows, np.concatenate([e, np.zeros(2)]), rcond=None)
    found = between.predicted(1, residual, weight, STEP_S, noise)
    np.testing.assert_allclose(found, between.directions[1] @ size, rtol=1e-9, atol=1e-12)
    # Samples without weight have no influence.
    spoilt = residual + 1e3 * (weight == 0.0)
    np.testing.assert_array_equal(between.predicted(1, spoilt, weight, STEP_S, noise), found)


@NOISES
def test_cost_and_log_determinant_are_those_of_a_correlated_normal_density(noise: Noise) -> None:
    between, weight = deviations(), weights()
    samples = Samples(("a", "b"), (STEP_S,) * 2, (weight > 0.0,) * 2, (weight,) * 2, between)
    residuals = list(np.random.default_rng(7).standard_normal((2, N)))
    square = count = determinant = 0.0
    for i in range(2):
        e = filtered(noise, residuals[i], weight)
        z = filtered(noise, between.directions[i], weight) / SIGMA_N
        covariance = np.eye(len(e)) + z @ z.T
        square += float(e @ np.linalg.solve(covariance, e))
        determinant += float(np.linalg.slogdet(covariance)[1])
        count += len(e)
    assert samples.cost(residuals, noise) == pytest.approx(count * np.log(square / count))
    found = between.log_determinant(samples.weight, samples.steps_s, noise)
    assert found == pytest.approx(determinant)
    swapped = samples.only([1, 0]).cost(residuals[::-1], noise)
    assert swapped == pytest.approx(samples.cost(residuals, noise), rel=1e-12)


def test_squared_spread_is_sample_variance_less_error_variance_if_precisions_are_equal() -> None:
    """Estimates of unit error with sample variance 4: Q = 8 with two degrees of freedom."""
    spread, chance, ratio = spread_between(np.array([5.0, 7.0, 9.0]), np.ones(3))
    assert spread == pytest.approx(np.sqrt(3.0))
    # Half of Q on a chi-square of two degrees of freedom.
    assert chance == pytest.approx(np.exp(-2.0))
    assert ratio == pytest.approx(4.0)


def test_spread_is_the_dersimonian_laird_estimate_if_precisions_differ() -> None:
    """Weighted mean 4, Q = 16 + 4 = 20 with one degree of freedom; 19 over 5 - 17/5."""
    spread, chance, ratio = spread_between(np.array([0.0, 5.0]), np.array([1.0, 4.0]))
    assert spread == pytest.approx(np.sqrt(19.0 / 1.6))
    assert chance == pytest.approx(stats.chi2.sf(10.0, 1))
    assert ratio == pytest.approx(20.0)


def test_spread_is_zero_if_estimates_differ_by_no_more_than_their_errors() -> None:
    assert spread_between(np.full(4, 2.5), np.array([1.0, 2.0, 3.0, 4.0])) == (0.0, 1.0, 0.0)
    spread, chance, ratio = spread_between(np.array([-0.5, 0.5]), np.ones(2))
    assert (spread, ratio) == (0.0, pytest.approx(0.5))
    assert chance == pytest.approx(stats.chi2.sf(0.25, 1))
