"""Deviations of runs: the whitening and the best linear prediction against numpy's closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from by_hand import Array
from jbf.estimation.between_runs import BetweenRuns
from jbf.estimation.noise import WHITE, Noise
from jbf.estimation.samples import Samples
from scipy import linalg

N = 120
STEP_S = 0.02
SIGMA_N = 0.3
COLOURED = Noise(memory_s=0.2, colour=0.4)
NOISES = pytest.mark.parametrize("noise", [WHITE, COLOURED], ids=["white", "coloured"])


def deviations(runs: int = 2) -> BetweenRuns:
    """A zero of 0.5 N and a slope of 0.8 N, with another slope in each run."""
    time = STEP_S * np.arange(N)
    directions = [
        np.stack([np.full(N, 0.5), 0.8 * np.sin((i + 1.0) * time)], axis=1) for i in range(runs)
    ]
    return BetweenRuns(("zero", "slope"), tuple(directions), SIGMA_N)


def weights() -> Array:
    """Some samples without weight, the others with weights of all sizes."""
    weight = np.random.default_rng(1).uniform(0.2, 1.0, N)
    weight[[0, 17, 18, 90]] = 0.0
    return weight


def filtered(noise: Noise, values: Array, weight: Array) -> Array:
    """Innovations by the difference equation, written out."""
    x = (values.T * weight).T
    e = np.zeros_like(x)
    phi = np.exp(-STEP_S / noise.memory_s) if noise.colour else 0.0
    for i in range(len(x)):
        e[i] = x[i]
        if i:
            e[i] += phi * ((1.0 - noise.colour) * e[i - 1] - x[i - 1])
    return e[weight > 0.0]


@NOISES
@pytest.mark.parametrize("run", [0, 1])
def test_whitened_is_as_by_the_covariance(noise: Noise, run: int) -> None:
    # Of innovations over their standard deviation the covariance is I + Z Z': Laird & Ware (1982).
    between, weight = deviations(), weights()
    values = np.random.default_rng(2).standard_normal((N, 4))
    values[:, 0] += 1.0
    e = filtered(noise, values, weight)
    z = filtered(noise, between.directions[run], weight) / SIGMA_N
    root = np.linalg.cholesky(np.eye(len(e)) + z @ z.T)
    wanted = linalg.solve_triangular(root, e, lower=True)
    (found,) = between.whitened(run, [e], weight, STEP_S, noise)
    assert found.shape == e.shape
    # Two roots of one matrix differ by a rotation: every inner product is the same.
    np.testing.assert_allclose(found.T @ found, wanted.T @ wanted, rtol=1e-10, atol=1e-10)
    assert np.sum(found**2) < 0.99 * np.sum(e**2)


def test_whitened_takes_vectors_and_tables_alike() -> None:
    between, weight = deviations(), weights()
    table = np.random.default_rng(3).standard_normal((int(np.sum(weight > 0.0)), 3))
    row, whole = between.whitened(0, [table[:, 1], table], weight, STEP_S, WHITE)
    np.testing.assert_allclose(row, whole[:, 1], rtol=1e-12)
    # What no deviation reaches is as it was.
    z = between.directions[0][weight > 0.0] * weight[weight > 0.0, None]
    free = table - z @ np.linalg.lstsq(z, table, rcond=None)[0]
    (same,) = between.whitened(0, [free], weight, STEP_S, WHITE)
    np.testing.assert_allclose(same, free, atol=1e-12)


def test_whitened_has_the_variance_of_noise_alone() -> None:
    between, weight = deviations(), np.ones(N)
    random = np.random.default_rng(4)
    kicks = random.standard_normal((2, 4000))
    records = between.directions[0] @ kicks + SIGMA_N * random.standard_normal((N, 4000))
    (left,) = between.whitened(0, [records], weight, STEP_S, WHITE)
    assert np.var(records) > 3.0 * SIGMA_N**2
    size = between.directions[0].T @ left / np.linalg.norm(between.directions[0], axis=0)[:, None]
    # Along the deviations, too: within a standard error of 2 % or so.
    np.testing.assert_allclose(np.var(size, axis=1), SIGMA_N**2, rtol=0.1)
    assert np.var(left) == pytest.approx(SIGMA_N**2, rel=0.02)


@NOISES
def test_the_prediction_is_ridge_regression(noise: Noise) -> None:
    # Henderson (1975): deviations of unit variance are penalised by their squares.
    between, weight = deviations(), weights()
    residual = np.random.default_rng(5).standard_normal(N) + between.directions[1] @ [1.5, -0.7]
    z = filtered(noise, between.directions[1], weight)
    e = filtered(noise, residual, weight)
    rows = np.vstack([z, SIGMA_N * np.eye(2)])
    size, *_ = np.linalg.lstsq(rows, np.concatenate([e, np.zeros(2)]), rcond=None)
    found = between.predicted(1, residual, weight, STEP_S, noise)
    np.testing.assert_allclose(found, between.directions[1] @ size, rtol=1e-9, atol=1e-12)
    # What has no weight says nothing.
    spoilt = residual + 1e3 * (weight == 0.0)
    np.testing.assert_array_equal(between.predicted(1, spoilt, weight, STEP_S, noise), found)


def test_a_zero_is_predicted_with_the_shrinkage_of_a_mean() -> None:
    # n samples of variance s^2 about a zero of variance t^2: t^2 / (t^2 + s^2 / n) of their mean.
    between = BetweenRuns(("zero",), (np.full((N, 1), 0.05),), SIGMA_N)
    residual = 0.1 + SIGMA_N * np.random.default_rng(6).standard_normal(N)
    kept = 0.05**2 / (0.05**2 + SIGMA_N**2 / N)
    assert 0.5 < kept < 0.9
    found = between.predicted(0, residual, np.ones(N), STEP_S, WHITE)
    np.testing.assert_allclose(found, kept * np.mean(residual), rtol=1e-12)


def test_only_some_of_the_runs() -> None:
    between = deviations(3)
    some = between.only([2, 0])
    assert (some.names, some.sigma_n) == (between.names, SIGMA_N)
    assert some.directions[0] is between.directions[2]
    assert some.directions[1] is between.directions[0]


@NOISES
def test_the_likelihood_is_of_the_correlated_normal_density(noise: Noise) -> None:
    between, weight = deviations(), weights()
    samples = Samples(("a", "b"), (STEP_S, STEP_S), (weight > 0.0,) * 2, (weight, weight), between)
    residuals = list(np.random.default_rng(7).standard_normal((2, N)))
    square = count = 0.0
    for i in range(2):
        e = filtered(noise, residuals[i], weight)
        z = filtered(noise, between.directions[i], weight) / SIGMA_N
        square += float(e @ np.linalg.solve(np.eye(len(e)) + z @ z.T, e))
        count += len(e)
    assert samples.cost(residuals, noise) == pytest.approx(count * np.log(square / count))
    swapped = samples.only([1, 0]).cost(residuals[::-1], noise)
    assert swapped == pytest.approx(samples.cost(residuals, noise), rel=1e-12)


def test_a_run_that_was_set_aside_whole_has_nothing_to_whiten() -> None:
    between = BetweenRuns(("zero",), (np.ones((5, 1)),), 0.1)
    nothing = [np.zeros(0), np.zeros((0, 2))]
    white = between.whitened(0, nothing, np.zeros(5), 0.02, WHITE)
    assert [w.shape for w in white] == [(0,), (0, 2)]
