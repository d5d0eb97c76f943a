"""Samples that count, their weights, parts, innovations and blocks, and random effects of runs.

The mixed model (Laird & Ware 1982) and the estimate of its spread (DerSimonian & Laird 1986) are
compared with closed forms.
"""

from dataclasses import replace

import numpy as np
import pytest
from by_hand import Array
from coulomb_problems import STEP_S, arma_innovations, samples_of
from jbf import Rig, Run
from jbf.estimation.campaign import Campaign
from jbf.estimation.noise import WHITE, Noise
from jbf.estimation.random_effects import RandomEffects, spread_between
from jbf.estimation.samples import Samples
from jbf.estimation.variance import blocks_of
from scipy import linalg, stats

COUNTED = (np.array([True, True, False, True]), np.array([True, False, True]))
WEIGHT = (np.array([1.0, 0.5, 0.0, 1.0]), np.array([1.0, 0.25, 1.0]))
SAMPLES = Samples(("a", "b"), (0.02, 0.1), COUNTED, WEIGHT)
VALUES = [np.array([1.0, 2.0, 3.0, 4.0]), np.array([5.0, 6.0, 7.0])]
COLOURED = Noise(0.1, 0.5)


def lists(arrays: tuple[Array, ...] | None) -> list[list[float]]:
    return [a.tolist() for a in arrays]


def test_samples_count_if_the_sign_of_motion_is_known_and_the_reading_is_usable() -> None:
    t = np.arange(0.0, 10.0, 0.01)
    v = 0.1 * np.sin(t - 0.015)
    run = Run.from_arrays(t, v, 5.0 * np.sign(v) + 2.0, position_m=-0.1 * np.cos(t - 0.015))
    campaign = Campaign.prepare(Rig(), [run])
    (p,), (counted,) = campaign.prepared, campaign.samples.counted
    np.testing.assert_array_equal(counted, p.motion.sign_known & p.examined.usable)
    np.testing.assert_array_equal(campaign.samples.weight[0], counted.astype(float))
    assert 0 < np.count_nonzero(~counted) < 30
    # A run that reverses at its start begins with a sample of unknown sign.
    assert not counted[0]
    assert Campaign.prepare(Rig(), [run.select(t > 0.5)]).samples.counted[0][0]


def test_rms_is_over_counted_samples_and_sum_of_squares_over_weighted_samples() -> None:
    assert SAMPLES.count == 5
    assert SAMPLES.flat(VALUES).tolist() == [1.0, 2.0, 4.0, 5.0, 7.0]
    assert SAMPLES.rms(VALUES) == pytest.approx(np.sqrt((1 + 4 + 16 + 25 + 49) / 5.0))
    # The weights multiply the residuals: 1 + 1 + 16 + 25 + 2.25 + 49.
    assert SAMPLES.square(VALUES) == pytest.approx(94.25)
    empty = SAMPLES.within([np.zeros(4, dtype=bool), np.zeros(3, dtype=bool)])
    assert (empty.count, empty.rms(VALUES), empty.square(VALUES)) == (0, 0.0, 0.0)
    assert empty.cost(VALUES, WHITE) == 0.0


def test_selection_of_runs_keeps_all_properties_of_their_samples() -> None:
    level = tuple(0.5 * np.ones(len(w)) for w in WEIGHT)
    between = RandomEffects(("zero",), (np.ones((4, 1)), 2.0 * np.ones((3, 1))), 0.7)
    one = replace(SAMPLES, level=level, between=between).only([1])
    assert (one.runs, one.steps_s) == (("b",), (0.1,))
    assert one.counted[0] is COUNTED[1]
    assert one.weight[0] is WEIGHT[1]
    assert one.level[0] is level[1]
    assert one.between.directions == (between.directions[1],)
    assert SAMPLES.only([1, 0]).runs == ("b", "a")
    assert SAMPLES.only([0]).between is None


def test_further_weights_are_multiplied_and_the_noise_level_is_accumulated() -> None:
    level, robust = [np.full(4, 0.5), np.full(3, 0.8)], [np.full(4, 0.1), np.ones(3)]
    once = SAMPLES.with_factors(level, of_level=True).with_factors(robust, of_level=False)
    np.testing.assert_allclose(once.weight[0], [0.05, 0.025, 0.0, 0.05])
    np.testing.assert_allclose(once.weight[1], [0.8, 0.2, 0.8])
    # Robust weights do not change the noise level.
    assert lists(once.level) == [[0.5] * 4, [0.8] * 3]
    twice = once.with_factors(level, of_level=True).with_factors(robust, of_level=False)
    np.testing.assert_allclose(twice.level[1], 0.64)
    np.testing.assert_allclose(twice.weight[0][0], 0.0025)


def test_stacked_rows_are_innovations_of_weighted_residuals_and_derivatives() -> None:
    slopes = [np.stack([v, v**2], axis=1) for v in VALUES]
    r, j = SAMPLES.stacked(VALUES, slopes, COLOURED)
    rows, columns = [], []
    for v, w, step, slope in zip(VALUES, WEIGHT, SAMPLES.steps_s, slopes, strict=True):
        keep = w > 0.0
        rows.append(arma_innovations(v * w, step, COLOURED)[keep])
        columns.append(arma_innovations(slope * w[:, None], step, COLOURED)[keep])
    np.testing.assert_allclose(r, np.concatenate(rows))
    np.testing.assert_allclose(j, np.concatenate(columns))
    second, _ = SAMPLES.stacked(VALUES, slopes, COLOURED, [1])
    np.testing.assert_allclose(second, rows[1])
    assert len(r) == 6
    wanted = 6.0 * np.log(float(r @ r) / 6.0)
    assert SAMPLES.cost(VALUES, COLOURED) == pytest.approx(wanted)


def test_innovations_are_zero_at_excluded_samples() -> None:
    level = (np.full(4, 0.5), np.full(3, 0.25))
    samples = replace(SAMPLES, level=level)
    has_weight = [w > 0.0 for w in WEIGHT]
    for found, weights, masks in (
        (samples.innovations(VALUES, COLOURED), WEIGHT, COUNTED),
        (samples.plain_innovations(VALUES, COLOURED), level, COUNTED),
    ):
        for e, v, w, c, step in zip(found, VALUES, weights, masks, samples.steps_s, strict=True):
            np.testing.assert_allclose(e, arma_innovations(v * c * w, step, COLOURED) * c)
    weighted = samples.weighted_innovations(VALUES, COLOURED)
    for e, v, w, c, step in zip(weighted, VALUES, WEIGHT, has_weight, SAMPLES.steps_s, strict=True):
        np.testing.assert_allclose(e, arma_innovations(v * w, step, COLOURED) * c)
    plain = SAMPLES.plain_innovations(VALUES, WHITE)
    assert [e.tolist() for e in plain] == [[1.0, 2.0, 0.0, 4.0], [5.0, 0.0, 7.0]]


def test_predicted_deviation_of_a_run_is_removed_with_shrinkage() -> None:
    """Offset with a deviation of 2 N: three readings of 3 N in noise of 1 N predict 36/13 N."""
    every = np.ones(3, dtype=bool)
    between = RandomEffects(("zero",), (np.full((3, 1), 2.0),), 1.0)
    samples = Samples(("a",), (0.02,), (every,), (np.ones(3),), between)
    (left,) = samples.without_deviations([np.full(3, 3.0)], WHITE)
    np.testing.assert_allclose(left, 3.0 - 36.0 / 13.0)
    (e,) = samples.innovations([np.full(3, 3.0)], WHITE)
    np.testing.assert_allclose(e, left)
    # The variance along its only direction is 1 + 12.
    r, _ = samples.stacked([np.full(3, 3.0)], [np.zeros((3, 0))], WHITE)
    np.testing.assert_allclose(r, 3.0 / np.sqrt(13.0))
    assert samples.cost([np.full(3, 3.0)], WHITE) == pytest.approx(3.0 * np.log(9.0 / 13.0))
    assert SAMPLES.without_deviations(VALUES, WHITE) == VALUES


def test_blocks_last_a_second_or_four_memories_and_do_not_span_runs() -> None:
    samples = samples_of([np.ones(120), np.concatenate((np.zeros(30), np.ones(70)))])
    assert samples.steps_s == (STEP_S, STEP_S)
    assert blocks_of(samples, 1.0).tolist() == [0, 50, 100, 120, 170]
    # An independent share of a fiftieth: the memory is 25 samples on either side.
    assert blocks_of(samples, 0.02).tolist() == [0, 100, 120]
    sparse = samples_of([np.ones(3), np.ones(2)], step_s=5.0)
    assert blocks_of(sparse, 1.0).tolist() == [0, 2, 3]
    assert blocks_of(sparse, 10.0).tolist() == [0, 1, 2, 3, 4]


N = 120
SIGMA_N = 0.3
SLOW_NOISE = Noise(memory_s=0.2, colour=0.4)
NOISES = pytest.mark.parametrize("noise", [WHITE, SLOW_NOISE], ids=["white", "coloured"])


def deviations(runs: int = 2) -> RandomEffects:
    """Random effects: an offset of 0.5 N and a wave of 0.8 N whose frequency differs by run."""
    time = STEP_S * np.arange(N)
    waves = [0.8 * np.sin((i + 1.0) * time) for i in range(runs)]
    directions = (np.stack([np.full(N, 0.5), wave], axis=1) for wave in waves)
    return RandomEffects(("zero", "wave"), tuple(directions), SIGMA_N)


def correlated(between: RandomEffects, weight: Array) -> Samples:
    """Samples of two runs with random effects and the same weights."""
    return Samples(("a", "b"), (STEP_S,) * 2, (weight > 0.0,) * 2, (weight,) * 2, between)


def weights() -> Array:
    """Weights of samples: zero at four of them, 0.2 to 1 at the others."""
    weight = np.random.default_rng(1).uniform(0.2, 1.0, N)
    weight[[0, 17, 18, 90]] = 0.0
    return weight


def filtered(noise: Noise, values: Array, weight: Array) -> Array:
    """Innovations of weighted values at the samples with nonzero weight."""
    weighted = (values.T * weight).T
    return arma_innovations(weighted, STEP_S, noise)[weight > 0.0]


@NOISES
@pytest.mark.parametrize("run", [0, 1])
def test_whitening_with_random_effects_uses_the_inverse_covariance(noise: Noise, run: int) -> None:
    """Innovations divided by their standard deviation have the covariance I + Z Z'."""
    between, weight = deviations(), weights()
    values = np.random.default_rng(2).standard_normal((N, 4)) + np.eye(4)[0]
    e = filtered(noise, values, weight)
    z = filtered(noise, between.directions[run], weight) / SIGMA_N
    root = np.linalg.cholesky(np.eye(len(e)) + z @ z.T)
    wanted = linalg.solve_triangular(root, e, lower=True)
    vector, found = correlated(between, weight).stacked(
        [values[:, 1]] * 2, [values] * 2, noise, [run]
    )
    np.testing.assert_allclose(found.T @ found, wanted.T @ wanted, rtol=1e-10, atol=1e-10)
    np.testing.assert_allclose(vector, found[:, 1], rtol=1e-12)


@NOISES
def test_predicted_random_effect_is_a_ridge_regression_over_weighted_samples(noise: Noise) -> None:
    """Deviations of unit variance are penalised by their sum of squares (Henderson 1975)."""
    between, weight = deviations(), weights()
    residual = np.random.default_rng(5).standard_normal(N) + between.directions[1] @ [1.5, -0.7]
    z = filtered(noise, between.directions[1], weight)
    e = filtered(noise, residual, weight)
    rows = np.vstack([z, SIGMA_N * np.eye(2)])
    size, *_ = np.linalg.lstsq(rows, np.concatenate([e, np.zeros(2)]), rcond=None)
    spoilt = residual + 1e3 * (weight == 0.0)
    samples = correlated(between, weight)
    for recorded in (residual, spoilt):
        found = recorded - samples.without_deviations([recorded] * 2, noise)[1]
        np.testing.assert_allclose(found, between.directions[1] @ size, rtol=1e-9, atol=1e-9)


@NOISES
def test_cost_and_determinant_with_random_effects_are_those_of_a_correlated_normal(
    noise: Noise,
) -> None:
    between, weight = deviations(), weights()
    samples = correlated(between, weight)
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
    assert samples.log_determinant_between(noise) == pytest.approx(determinant)
    swapped = samples.only([1, 0]).cost(residuals[::-1], noise)
    assert swapped == pytest.approx(samples.cost(residuals, noise), rel=1e-12)


@pytest.mark.parametrize(
    ("estimates", "precisions", "square", "q"),
    [
        # With errors of one and a sample variance of 4 the excess is 3.
        ([5.0, 7.0, 9.0], [1.0] * 3, 3.0, 8.0),
        # Weighted mean 4, Q = 16 + 4 = 20 with one degree of freedom; 19 over 5 - 17/5.
        ([0.0, 5.0], [1.0, 4.0], 19.0 / 1.6, 20.0),
        # The differences are within the errors.
        ([-0.5, 0.5], [1.0] * 2, 0.0, 0.5),
        ([2.5] * 4, [1.0, 2.0, 3.0, 4.0], 0.0, 0.0),
        # One run contains all of the precision.
        ([1.0, 5.0], [3.0, 0.0], 0.0, 0.0),
    ],
)
def test_spread_between_runs_is_that_of_dersimonian_and_laird_or_zero_if_small(
    estimates: list[float], precisions: list[float], square: float, q: float
) -> None:
    found = spread_between(np.array(estimates), np.array(precisions))
    freedom = len(estimates) - 1
    assert found == pytest.approx((np.sqrt(square), stats.chi2.sf(q / 2.0, freedom), q / freedom))
