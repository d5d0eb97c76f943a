"""Gains in twice the log likelihood, score tests, and effective numbers of correlated samples.

Long-run variances of scores (Newey & West 1987) are compared with closed forms.
"""

from dataclasses import replace

import numpy as np
import pytest
from by_hand import Array, coulomb, four_runs
from coulomb_problems import (
    STEP_S,
    arma_innovations,
    autoregressive,
    coulomb_problem,
    samples_of,
    solution_at,
    solution_of,
    values_of,
)
from jbf.estimation import least_squares, likelihood, variance
from jbf.estimation.noise import Noise
from jbf.estimation.random_effects import RandomEffects
from jbf.estimation.variance import clipped_square, robust_size
from scipy import linalg, stats


def white(seed: int, n: int) -> Array:
    return np.random.default_rng(seed).standard_normal(n)


def test_likelihood_gain_is_n_times_the_log_ratio_of_squares() -> None:
    """Residuals of 6 N that decrease to 3 N in 100 samples have a gain of 100 log 4."""
    samples = samples_of([np.ones(60), np.ones(40)])
    before = solution_of([np.full(60, 6.0), np.full(40, -6.0)], samples)
    after = solution_of([np.full(60, 3.0), np.full(40, 3.0)], samples)
    assert likelihood.likelihood_gain(after, before) == pytest.approx(100.0 * np.log(4.0))
    assert likelihood.likelihood_gain(before, after) == pytest.approx(-100.0 * np.log(4.0))


def test_likelihood_gain_does_not_contain_the_difference_of_the_noise_models() -> None:
    """The gain is that of the innovations in the coloured noise of one solution."""
    samples, noise = samples_of([np.ones(4000)]), Noise(20.0 * STEP_S, 1.0)
    drawn = autoregressive(5, noise.memory_s, 1.0, 4000)
    with_slope = drawn + np.linspace(-0.5, 0.5, 4000)
    coloured = solution_of([drawn], samples, noise=noise)
    assert likelihood.likelihood_gain(coloured, solution_of([drawn], samples)) == 0.0
    squares = [np.sum(arma_innovations(r, STEP_S, noise) ** 2) for r in (with_slope, drawn)]
    gain = likelihood.likelihood_gain(coloured, solution_of([with_slope], samples))
    assert gain == pytest.approx(4000.0 * np.log(squares[0] / squares[1]), rel=1e-6)


def test_log_likelihood_is_that_of_a_normal_vector_with_weights_and_random_effects() -> None:
    """Two runs with unequal noise and a random offset, against the density of the whole vector."""
    residuals = [white(1, 30) + 1.5, white(2, 20) - 0.5]
    weights = [np.linspace(0.3, 1.0, 30), np.full(20, 0.8)]
    offset = RandomEffects(("offset",), tuple(np.full((len(r), 1), 0.7) for r in residuals), 1.2)
    samples = replace(samples_of(weights), between=offset)
    found = likelihood.log_likelihood(solution_of(residuals, samples))
    # In units of the noise of a sample with full weight: w^2 (I + u u') of each run.
    blocks = [np.diag(1.0 / w**2) + (0.7 / 1.2) ** 2 * np.ones((len(w), len(w))) for w in weights]
    covariance, y = linalg.block_diag(*blocks), np.concatenate(residuals)
    variance = y @ np.linalg.solve(covariance, y) / len(y)
    expected = stats.multivariate_normal.logpdf(y, cov=variance * covariance)
    assert found == pytest.approx(expected, rel=1e-9)


def test_likelihood_gain_uses_the_smaller_of_two_weights_of_a_sample() -> None:
    whole, part = np.ones(100), np.concatenate((np.zeros(40), np.ones(60)))
    before = solution_of([np.full(100, 2.0)], samples_of([whole]))
    after = solution_of([np.concatenate((np.full(40, 9.0), np.ones(60)))], samples_of([part]))
    assert likelihood.likelihood_gain(after, before) == pytest.approx(60.0 * np.log(4.0))


def test_clipped_gain_from_one_outlier_is_bounded() -> None:
    drawn = white(4, 1000)
    samples = samples_of([np.ones(600), np.ones(400)])
    off = drawn.copy()
    off[700] += 100.0
    followed = solution_of([drawn[:600], drawn[600:]], samples)
    missed = solution_of([off[:600], off[600:]], samples)
    assert likelihood.likelihood_gain(followed, missed) > 2000.0
    assert 0.0 < likelihood.robust_gain(followed, missed) < 1.1 * 3.5**2
    level = solution_of([drawn[:600] + 0.5, drawn[600:] + 0.5], samples)
    assert likelihood.robust_gain(followed, level) == pytest.approx(250.0, rel=0.15)
    assert likelihood.robust_gain(level, followed) < -180.0
    halves = [solution_of([0.5 * r for r in s.residuals], samples) for s in (followed, missed)]
    whole = likelihood.robust_gain(followed, missed)
    assert likelihood.robust_gain(*halves) == pytest.approx(whole)


def test_robust_size_is_the_median_absolute_value_over_0_6745() -> None:
    assert robust_size(np.array([1.0, -2.0, 30.0])) == pytest.approx(2.0 / 0.6745)
    assert robust_size(np.zeros(0)) == 0.0
    assert robust_size(white(1, 20000)) == pytest.approx(1.0, abs=0.02)


def test_squared_errors_are_clipped_at_three_and_a_half_standard_deviations() -> None:
    errors = np.array([0.5, -1.0, 3.4, -7.0, 1e9])
    assert clipped_square(errors, 2.0, 3.5) == pytest.approx(0.25 + 1.0 + 3.4**2 + 7.0**2 + 7.0**2)


def test_expected_gain_is_that_of_one_gauss_newton_step() -> None:
    """A step along the first axis changes (3, 4) to (0, 4): the square decreases from 25 to 16."""
    r, j = np.array([3.0, 4.0]), np.array([[1.0], [0.0]])
    assert likelihood.promised_gain(r, j, 10) == pytest.approx(10.0 * np.log(25.0 / 16.0))
    assert likelihood.promised_gain(r, np.zeros((2, 1)), 10) == 0.0
    samples = samples_of([np.ones(2)])
    found = likelihood.next_step_gain(solution_of([r], samples, [j]))
    assert found == pytest.approx(2.0 * np.log(25.0 / 16.0))
    converged = solution_of([np.array([0.0, 4.0])], samples, [j])
    assert likelihood.next_step_gain(converged) == pytest.approx(0.0, abs=1e-12)


def test_score_gain_of_a_linear_effect_is_the_gain_of_its_fit() -> None:
    runs = four_runs(lambda t, v, a: coulomb(t, v, a) + 0.2, noise_rms=0.1)
    bare, offset = coulomb_problem(runs), coulomb_problem(runs, ["sensor_offset"])
    near = solution_at(bare, values_of(bare))
    at_null = values_of(offset, **{"sensor_offset.b": 0.0})
    v = np.concatenate([p.motion.velocity for p in bare.campaign.prepared])
    r = np.concatenate(near.residuals)
    x = np.column_stack([np.sign(v), v, np.ones(len(v))])
    left = r - x @ np.linalg.lstsq(x, r, rcond=None)[0]
    wanted = len(r) * np.log(float(r @ r) / float(left @ left))
    assert wanted > 1000.0
    assert likelihood.score_gain(offset, at_null, near) == pytest.approx(wanted, rel=1e-6)


DESIGN = np.array([[1.0, 0.0, 1.0], [0.0, 2.0, 2.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
"""Three columns, the third of which is the sum of the others."""
TARGET = np.array([3.0, 8.0, -1.0, 2.0])


@pytest.mark.parametrize("scale", [1e-200, 1.0, 1e200])
def test_regression_residual_does_not_depend_on_the_scale_of_the_columns(scale: float) -> None:
    design = DESIGN * [1.0, scale, 1.0] if scale == 1e200 else scale * DESIGN
    design[:, 2] = design[:, 0] + design[:, 1]
    left = least_squares.unexplained(design, TARGET)
    np.testing.assert_allclose(left, [0.0, 0.0, -1.0, 2.0], atol=1e-12)
    assert least_squares.unexplained_square(design, TARGET) == pytest.approx(5.0)
    span = least_squares.spanned(scale * DESIGN)
    assert span.shape == (4, 2)
    np.testing.assert_allclose(span.T @ span, np.eye(2), atol=1e-12)
    np.testing.assert_allclose(span @ (span.T @ TARGET), [3.0, 8.0, 0.0, 0.0], atol=1e-12)


def test_least_squares_solution_has_minimum_norm_in_columns_of_unit_length() -> None:
    np.testing.assert_allclose(least_squares.least_squares(DESIGN[:, :2], TARGET), [3.0, 4.0])
    twice = np.column_stack([DESIGN[:, 0], DESIGN[:, 0], np.zeros(4)])
    np.testing.assert_allclose(
        least_squares.least_squares(twice, TARGET), [1.5, 1.5, 0.0], atol=1e-12
    )
    shorter = least_squares.least_squares(1e-2 * DESIGN[:, :2], TARGET)
    np.testing.assert_allclose(shorter, [300.0, 400.0])


def bartlett_share(runs: list[Array], step_s: float) -> float:
    """`1 / (1 + 2 sum rho_k)` (Bartlett 1946) to 2/sqrt(n) or the longest memory of the model."""
    centred = [e - np.mean(np.concatenate(runs)) for e in runs]
    count, power = sum(map(len, runs)), sum(float(e @ e) for e in centred)
    total = 0.0
    for k in range(1, int(0.6 / step_s) + 2):
        rho = sum(float(e[k:] @ e[:-k]) for e in centred) / power
        if rho < 2.0 / np.sqrt(count):
            break
        total += rho
    return 1.0 / (1.0 + 2.0 * total)


@pytest.mark.parametrize("step_s", [0.02, 0.25])
@pytest.mark.parametrize("length", [1, 4, 12])
def test_independent_share_of_samples_follows_bartletts_formula(length: int, step_s: float) -> None:
    runs = [2.0 + np.convolve(white(length + n, n), np.ones(length), "valid") for n in (400, 250)]
    found = likelihood.independent_share(runs, (step_s, step_s))
    assert found == pytest.approx(bartlett_share(runs, step_s), rel=1e-9)
    assert found == pytest.approx(1.0 / length, rel=0.5) or step_s > 0.1


def test_autocorrelations_are_summed_up_to_the_longest_memory_of_the_noise_model() -> None:
    ramp = np.linspace(-1.0, 1.0, 4000)
    for step_s, lags in ((0.02, 31), (0.125, 5), (1.0, 1)):
        found = likelihood.independent_share([ramp], (step_s,))
        assert found == pytest.approx(1.0 / (1 + 2 * lags), rel=0.03)
    # The smallest step determines the number of lags.
    found = likelihood.independent_share([ramp, ramp], (0.125, 0.02))
    assert found == pytest.approx(1.0 / 63.0, rel=0.03)
    assert likelihood.independent_share([np.zeros(50)], (0.02,)) == 1.0


def test_counted_share_of_a_likelihood_gain_is_reduced_if_residuals_are_correlated() -> None:
    samples = samples_of([np.ones(2000)])
    wave = np.sin(0.01 * np.arange(2000))
    slow = np.repeat(white(5, 200), 10)
    for noise, low, high in ((white(4, 2000), 0.8, 1.0), (slow, 0.03, 0.25)):
        after, before = solution_of([noise], samples), solution_of([noise + wave], samples)
        share = likelihood.effective_share(after)
        assert low <= likelihood.share_of_gain(after, before, share) <= high
        assert likelihood.share_of_gain(after, before, share) <= share


def test_counted_share_of_a_likelihood_gain_is_reduced_at_samples_with_larger_noise() -> None:
    here = np.arange(4000) % 10 == 0
    noise = white(5, 4000) * np.where(here, 10.0, 1.0)
    samples = samples_of([np.ones(4000)])
    after = solution_of([noise], samples)
    sides = np.where(np.arange(4000) % 2, 1.0, -1.0)
    others = (solution_of([noise + 0.1 * d], samples) for d in (here, sides))
    local, even = (
        likelihood.share_of_gain(after, before, likelihood.effective_share(after))
        for before in others
    )
    assert likelihood.effective_share(after) > 0.9
    assert local == pytest.approx(float(np.mean(noise**2)) / 100.0, rel=0.35)
    assert even > 0.75


def coloured(seed: int, correlation: float, n: int) -> Array:
    if correlation == 0.0:
        return np.random.default_rng(seed).standard_normal(n)
    return autoregressive(seed, -STEP_S / np.log(correlation), 1.0, n)


@pytest.mark.parametrize(
    ("n", "step_s", "length"),
    [(40, 1.0, 3), (40, 0.5, 5), (40, 0.001, 5), (40, 2.0, 1), (40, 50.0, 1), (7, 0.5, 1)],
)
def test_long_run_variance_uses_windows_of_three_seconds_or_an_eighth_of_the_record(
    n: int, step_s: float, length: int
) -> None:
    scores = np.random.default_rng(n).standard_normal((n, 2))
    windows = [scores[k : k + length].sum(axis=0) for k in range(n - length + 1)]
    wanted = sum(np.outer(w, w) for w in windows) * n / (len(windows) * length)
    np.testing.assert_allclose(variance.long_run_variance(scores, step_s), wanted)


@pytest.mark.parametrize("correlation", [0.0, 0.5, 0.9])
def test_long_run_variance_of_autoregression_sums_its_autocovariances(correlation: float) -> None:
    n = 20000
    noises = (coloured(s, correlation, n)[:, None] for s in range(8))
    found = [float(variance.long_run_variance(noise, STEP_S)[0, 0]) for noise in noises]
    wanted = (1.0 + correlation) / (1.0 - correlation)
    assert np.mean(found) / n == pytest.approx(wanted, rel=0.15)


def test_score_statistic_uses_the_larger_of_long_run_and_white_noise_variance() -> None:
    """Innovations of mean c with an alternating part a: 16 c^2 over the larger of a^2 and one."""
    swings = np.where(np.arange(16) % 2, 1.0, -1.0)
    direction = np.full((16, 1), 0.25)
    for a, larger in ((10.0, 100.0), (2.0, 4.0), (0.5, 1.0)):
        found = variance.score_square(direction, 0.7 + a * swings, 3.0)
        assert found == pytest.approx(16.0 * 0.49 / larger)


@pytest.mark.parametrize("correlation", [0.0, 0.9])
def test_score_statistic_in_correlated_noise_follows_chi_square(correlation: float) -> None:
    n = 10000
    t = np.arange(n) * STEP_S
    x = np.linalg.qr(np.stack([np.ones(n), np.sin(0.1 * t), t - t.mean()], axis=1))[0]
    found = [variance.score_square(x, coloured(s, correlation, n), STEP_S) for s in range(100)]
    # Without the long-run variance the squares would be nineteen times as large.
    assert np.mean(found) == pytest.approx(3.0, rel=0.3)
    assert stats.chi2.sf(np.quantile(found, 0.95), 3) > 0.01


@pytest.mark.parametrize("scale", [1e-200, 1.0, 1e200])
def test_score_inflation_is_the_score_variance_over_that_of_white_noise(scale: float) -> None:
    """Windows of one sample: squares of the direction times the other innovations."""
    random = np.random.default_rng(2)
    d = [random.standard_normal(n) for n in (30, 20)]
    e = [4.0 * np.abs(x) * random.standard_normal(len(x)) for x in d]
    e[1][3] = 0.0
    square = sum(float(x @ x) for x in d)
    along = sum(float(a @ b) for a, b in zip(d, e, strict=True)) / square
    score = sum(float(np.sum((a * (b - along * a)) ** 2)) for a, b in zip(d, e, strict=True))
    # Innovations of zero mark samples that are not counted.
    white = sum(float(x @ x) for x in e) / 49.0
    wanted = score / (square * white)
    assert wanted > 1.2
    scaled = [scale * x for x in d]
    assert variance.score_inflation(scaled, e, (3.0, 3.0)) == pytest.approx(wanted)
    assert variance.score_inflation(d, [1e-3 * x for x in e], (3.0, 3.0)) == pytest.approx(wanted)


def test_score_inflation_is_one_for_alternating_or_degenerate_scores() -> None:
    swings = [np.where(np.arange(n) % 2, 1.0, -1.0) for n in (30, 20)]
    assert variance.score_inflation([np.ones(30), np.ones(20)], swings, (0.1, 0.1)) == 1.0
    for inflation in (variance.score_inflation, variance.significant_inflation):
        assert inflation([np.zeros(50)], [np.ones(50)], (STEP_S,)) == 1.0
        assert inflation([np.ones(50)], [np.zeros(50)], (STEP_S,)) == 1.0
        assert inflation([np.full(30, np.inf)], [np.ones(30)], (STEP_S,)) == 1.0
    assert variance.score_inflation([], [], ()) == 1.0


@pytest.mark.parametrize(("ratio", "sure"), [(1.4, False), (2.6, True)])
def test_inflation_from_few_windows_is_used_only_if_significant(ratio: float, sure: bool) -> None:
    """With 20 windows, chi-square over its degrees of freedom is 1.88 at 1 %."""
    direction = np.zeros(400)
    direction[::20] = 1.0
    e = np.where(np.arange(400) % 2, 1.0, -1.0)
    size = np.sqrt(ratio * 380.0 / (400.0 - 20.0 * ratio))
    e[::20] = size * np.where(np.arange(20) % 2, 1.0, -1.0)
    assert variance.score_inflation([direction], [e], (3.0,)) == pytest.approx(ratio)
    for scale in (1.0, 1e150):
        found = variance.significant_inflation([scale * direction], [e], (3.0,))
        assert found == (pytest.approx(ratio) if sure else 1.0)


@pytest.mark.parametrize(("inflation", "kept"), [(1.02, False), (0.98, True)])
def test_scatter_between_runs_counts_only_if_significant(inflation: float, kept: bool) -> None:
    """Three runs have two degrees of freedom: exp(-q / 2) is 1 % at q = 9.21."""
    pull, size = np.array([3.0, -3.0, 3.0]), np.array([1.0, 1.0, 4.0])
    d = [np.array([np.sqrt(s), 0.0, 0.0]) for s in size]
    e = [np.array([p / np.sqrt(s), 2.0, -2.0]) for p, s in zip(pull, size, strict=True)]
    white = np.mean(np.concatenate(e) ** 2)
    limit = float(np.sum(pull**2 / size)) / white / (2.0 * np.log(100.0))
    found = variance.cluster_inflation(d, e, inflation * limit)
    # Sum of squared run sums over that of white noise, times n / (n - 1).
    assert found == (pytest.approx(27.0 / (white * 6.0) * 1.5) if kept else 0.0)
    # A run that does not depend on the direction is not counted.
    more = variance.cluster_inflation([*d, np.zeros(3)], [*e, np.zeros(3)], inflation * limit)
    assert (more > 0.0) == kept
    assert variance.cluster_inflation(d[:2], e[:2], 1e-9) == 0.0
    assert variance.cluster_inflation(d, [np.zeros(3)] * 3, 1e-9) == 0.0


def test_inflation_between_runs_is_the_variance_of_run_sums_over_white_noise() -> None:
    ones = [np.ones(400) for _ in range(6)]
    e = [coloured(i, 0.0, 400) for i in range(6)]
    assert variance.cluster_inflation(ones, e, 1.0) == 0.0
    moved = [x + z for x, z in zip(e, (0.5, -0.3, 0.1, -0.6, 0.4, -0.1), strict=True)]
    sums = np.array([np.sum(x) for x in moved])
    wanted = np.sum(sums**2) * 6.0 / 5.0 / (np.mean(np.concatenate(moved) ** 2) * 2400.0)
    assert variance.cluster_inflation(ones, moved, 1.0) == pytest.approx(wanted)
    assert wanted > 20.0
    assert variance.cluster_inflation(ones, moved, 1000.0) == 0.0
