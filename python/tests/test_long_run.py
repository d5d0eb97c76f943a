"""Long-run variances against noise whose variance is known in closed form."""

from __future__ import annotations

import numpy as np
import pytest
from jbf.estimation.long_run import (
    BY_CHANCE,
    long_run_variance,
    score_inflation,
    score_square,
    sure_inflation,
)
from scipy import signal, stats

N, STEP_S = 20000, 0.02


def coloured(seed: int, keep: float, n: int = N) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    """First-order autoregression of unit variance."""
    e = np.sqrt(1.0 - keep**2) * np.random.default_rng(seed).standard_normal(n + 500)
    return np.asarray(signal.lfilter([1.0], [1.0, -keep], e)[500:])


@pytest.mark.parametrize("keep", [0.0, 0.5, 0.9])
def test_of_an_autoregression(keep: float) -> None:
    found = [float(long_run_variance(coloured(s, keep)[:, None], STEP_S)[0, 0]) for s in range(20)]
    # Sum of all autocovariances; Bartlett's windows of 150 samples miss a little of it.
    assert np.mean(found) / N == pytest.approx((1.0 + keep) / (1.0 - keep), rel=0.15)


@pytest.mark.parametrize("keep", [0.0, 0.9])
def test_a_score_in_noise_that_remembers_is_chi_square(keep: float) -> None:
    t = np.arange(N) * STEP_S
    x = np.linalg.qr(np.stack([np.ones(N), np.sin(0.1 * t), t - t.mean()], axis=1))[0]
    found = [score_square(x, coloured(s, keep), STEP_S) for s in range(150)]
    assert np.mean(found) == pytest.approx(3.0, rel=0.25)
    # Plain squares are nineteen times as large where nine tenths are remembered.
    assert stats.chi2.sf(np.quantile(found, 0.95), 3) > 0.01


def test_a_signal_is_not_taken_for_its_noise() -> None:
    x = np.full((N, 1), 1.0 / np.sqrt(N))
    assert score_square(x, coloured(1, 0.0) + 0.5, STEP_S) == pytest.approx(0.25 * N, rel=0.1)


def test_a_score_that_comes_and_goes_is_worth_less() -> None:
    random = np.random.default_rng(3)
    ways = [np.sin(0.05 * np.arange(5000)), np.cos(0.03 * np.arange(3000))]
    noise = [random.standard_normal(len(w)) for w in ways]
    assert score_inflation(ways, noise, (STEP_S, STEP_S)) == pytest.approx(1.0, abs=0.4)
    # What fits one run and misfits the other is no noise that averages out.
    against = [n + s * w for n, w, s in zip(noise, ways, (0.5, -0.7), strict=True)]
    assert score_inflation(ways, against, (STEP_S, STEP_S)) > 5.0
    slow = [coloured(i, 0.98, len(w)) for i, w in enumerate(ways)]
    assert score_inflation(ways, slow, (STEP_S, STEP_S)) > 10.0


def breakaways(count: int) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    """A direction of pulses of five samples, a few seconds apart."""
    way = np.zeros(400 * count)
    for k in range(count):
        way[400 * k + 200 : 400 * k + 205] = 1.0
    return way


@pytest.mark.parametrize("count", [2, 4, 40])
def test_chance_in_a_few_windows_is_no_inflation(count: int) -> None:
    random = np.random.default_rng(5)
    way = breakaways(count)
    found, sure = [], []
    for _ in range(1000):
        noise = random.standard_normal(len(way))
        found.append(score_inflation([way], [noise], (STEP_S,)))
        sure.append(sure_inflation([way], [noise], (STEP_S,)))
    # What a few squares make by chance is a third of twice as much, and more.
    assert count == 40 or np.quantile(found, 0.95) > 1.7
    assert np.mean(np.array(sure) > 1.0) < 2.0 * BY_CHANCE


@pytest.mark.parametrize("scale", [1e-120, 1.0, 1e120])
def test_more_than_chance_stays_however_few_the_windows(scale: float) -> None:
    way = breakaways(4)
    noise = np.random.default_rng(6).standard_normal(len(way))
    loud = noise + 8.0 * way * np.repeat([1.0, -1.0, 1.0, -1.0], 400)
    for ways, noises in (([way], [loud]), ([way[:800], way[800:]], [loud[:800], loud[800:]])):
        steps = (STEP_S,) * len(ways)
        whole = score_inflation(ways, noises, steps)
        found = sure_inflation([scale * w for w in ways], noises, steps)
        assert found == pytest.approx(whole)
        assert whole > 10.0
    slow = coloured(2, 0.98, 8000)
    ways = [np.sin(0.05 * np.arange(8000))]
    assert sure_inflation(ways, [slow], (STEP_S,)) == score_inflation(ways, [slow], (STEP_S,))


@pytest.mark.parametrize("scale", [1e-250, 1e-3, 1e3, 1e250])
def test_how_long_a_direction_is_does_not_matter(scale: float) -> None:
    random = np.random.default_rng(8)
    way, noise = np.sin(0.01 * np.arange(4000)), np.cumsum(random.standard_normal(4000)) / 30.0
    for inflation in (score_inflation, sure_inflation):
        usual = inflation([way], [noise], (STEP_S,))
        assert usual > 2.0
        assert inflation([scale * way], [noise], (STEP_S,)) == pytest.approx(usual, rel=1e-9)


def test_nothing_to_tell() -> None:
    assert sure_inflation([np.zeros(50)], [np.ones(50)], (STEP_S,)) == 1.0
    assert score_inflation([np.zeros(50)], [np.ones(50)], (STEP_S,)) == 1.0
    assert score_inflation([np.ones(50)], [np.zeros(50)], (STEP_S,)) == 1.0


def test_of_no_sample_nothing_is_known() -> None:
    assert np.array_equal(long_run_variance(np.zeros((0, 2)), 0.01), np.zeros((2, 2)))
