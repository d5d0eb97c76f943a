"""Long-run variances of scores (Newey & West 1987) against closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from by_hand import Array
from coulomb_problems import STEP_S, autoregressive
from jbf.estimation.long_run import (
    between_runs,
    long_run_variance,
    score_inflation,
    score_square,
    sure_inflation,
)
from scipy import stats


def coloured(seed: int, correlation: float, n: int) -> Array:
    """First-order autoregression of unit variance."""
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
    np.testing.assert_allclose(long_run_variance(scores, step_s), wanted)


@pytest.mark.parametrize("correlation", [0.0, 0.5, 0.9])
def test_long_run_variance_of_an_autoregression_is_the_sum_of_autocovariances(
    correlation: float,
) -> None:
    n = 20000
    found = [
        float(long_run_variance(coloured(s, correlation, n)[:, None], STEP_S)[0, 0])
        for s in range(8)
    ]
    wanted = (1.0 + correlation) / (1.0 - correlation)
    assert np.mean(found) / n == pytest.approx(wanted, rel=0.15)


def test_score_statistic_uses_the_larger_of_long_run_and_white_noise_variance() -> None:
    """A level c and an alternating part a in 16 samples: 16 c^2 over the larger of a^2 and one."""
    swings = np.where(np.arange(16) % 2, 1.0, -1.0)
    direction = np.full((16, 1), 0.25)
    for a, variance in ((10.0, 100.0), (2.0, 4.0), (0.5, 1.0)):
        found = score_square(direction, 0.7 + a * swings, 3.0)
        assert found == pytest.approx(16.0 * 0.49 / variance)


@pytest.mark.parametrize("correlation", [0.0, 0.9])
def test_score_statistic_in_correlated_noise_follows_chi_square(correlation: float) -> None:
    n = 10000
    t = np.arange(n) * STEP_S
    x = np.linalg.qr(np.stack([np.ones(n), np.sin(0.1 * t), t - t.mean()], axis=1))[0]
    found = [score_square(x, coloured(s, correlation, n), STEP_S) for s in range(100)]
    # The plain squares of correlated noise are nineteen times as large.
    assert np.mean(found) == pytest.approx(3.0, rel=0.3)
    assert stats.chi2.sf(np.quantile(found, 0.95), 3) > 0.01


@pytest.mark.parametrize("scale", [1e-200, 1.0, 1e200])
def test_inflation_is_the_score_variance_over_that_of_white_noise(scale: float) -> None:
    """With windows of one sample: squares of the direction times the other innovations."""
    random = np.random.default_rng(2)
    d = [random.standard_normal(n) for n in (30, 20)]
    e = [4.0 * np.abs(x) * random.standard_normal(len(x)) for x in d]
    e[1][3] = 0.0
    square = sum(float(x @ x) for x in d)
    along = sum(float(a @ b) for a, b in zip(d, e, strict=True)) / square
    score = sum(float(np.sum((a * (b - along * a)) ** 2)) for a, b in zip(d, e, strict=True))
    # Innovations of zero are samples that do not count.
    white = sum(float(x @ x) for x in e) / 49.0
    wanted = score / (square * white)
    assert wanted > 1.2
    scaled = [scale * x for x in d]
    assert score_inflation(scaled, e, (3.0, 3.0)) == pytest.approx(wanted)
    assert score_inflation(d, [1e-3 * x for x in e], (3.0, 3.0)) == pytest.approx(wanted)


def test_inflation_is_one_for_alternating_or_degenerate_scores() -> None:
    swings = [np.where(np.arange(n) % 2, 1.0, -1.0) for n in (30, 20)]
    assert score_inflation([np.ones(30), np.ones(20)], swings, (0.1, 0.1)) == 1.0
    for inflation in (score_inflation, sure_inflation):
        assert inflation([np.zeros(50)], [np.ones(50)], (STEP_S,)) == 1.0
        assert inflation([np.ones(50)], [np.zeros(50)], (STEP_S,)) == 1.0
        assert inflation([np.full(30, np.inf)], [np.ones(30)], (STEP_S,)) == 1.0
    assert score_inflation([], [], ()) == 1.0


@pytest.mark.parametrize(("ratio", "sure"), [(1.4, False), (2.6, True)])
def test_inflation_from_few_windows_is_used_only_if_significant_at_one_percent(
    ratio: float, sure: bool
) -> None:
    """With 20 windows, chi-square over its degrees of freedom is 1.88 at 1 %."""
    direction = np.zeros(400)
    direction[::20] = 1.0
    e = np.where(np.arange(400) % 2, 1.0, -1.0)
    size = np.sqrt(ratio * 380.0 / (400.0 - 20.0 * ratio))
    e[::20] = size * np.where(np.arange(20) % 2, 1.0, -1.0)
    assert score_inflation([direction], [e], (3.0,)) == pytest.approx(ratio)
    for scale in (1.0, 1e150):
        found = sure_inflation([scale * direction], [e], (3.0,))
        assert found == (pytest.approx(ratio) if sure else 1.0)


@pytest.mark.parametrize(("inflation", "kept"), [(1.02, False), (0.98, True)])
def test_scatter_between_runs_counts_only_if_significant_at_one_percent(
    inflation: float, kept: bool
) -> None:
    """Three runs have two degrees of freedom: exp(-q / 2) is 1 % at q = 9.21."""
    pull, size = np.array([3.0, -3.0, 3.0]), np.array([1.0, 1.0, 4.0])
    d = [np.array([np.sqrt(s), 0.0, 0.0]) for s in size]
    e = [np.array([p / np.sqrt(s), 2.0, -2.0]) for p, s in zip(pull, size, strict=True)]
    white = np.mean(np.concatenate(e) ** 2)
    limit = float(np.sum(pull**2 / size)) / white / (2.0 * np.log(100.0))
    found = between_runs(d, e, inflation * limit)
    # Sum of squared pulls over that of white noise, times n / (n - 1).
    assert found == (pytest.approx(27.0 / (white * 6.0) * 1.5) if kept else 0.0)
    # A run that does not depend on the direction is not counted.
    more = between_runs([*d, np.zeros(3)], [*e, np.zeros(3)], inflation * limit)
    assert (more > 0.0) == kept
    assert between_runs(d[:2], e[:2], 1e-9) == 0.0
    assert between_runs(d, [np.zeros(3)] * 3, 1e-9) == 0.0


def test_inflation_between_runs_is_the_variance_of_run_sums_over_that_of_white_noise() -> None:
    ones = [np.ones(400) for _ in range(6)]
    e = [coloured(i, 0.0, 400) for i in range(6)]
    assert between_runs(ones, e, 1.0) == 0.0
    moved = [x + z for x, z in zip(e, (0.5, -0.3, 0.1, -0.6, 0.4, -0.1), strict=True)]
    sums = np.array([np.sum(x) for x in moved])
    wanted = np.sum(sums**2) * 6.0 / 5.0 / (np.mean(np.concatenate(moved) ** 2) * 2400.0)
    assert between_runs(ones, moved, 1.0) == pytest.approx(wanted)
    assert wanted > 20.0
    assert between_runs(ones, moved, 1000.0) == 0.0
