"""Gains in twice the log likelihood, score tests, and effective numbers of correlated samples."""

from __future__ import annotations

import numpy as np
import pytest
from by_hand import Array, coulomb, four_runs
from coulomb_problems import coulomb_problem, samples_of, solution_at, solution_of, values_of
from jbf.estimation.likelihood import (
    effective_share,
    gain_of_most,
    independent_share,
    least_squares,
    likelihood_gain,
    next_step_gain,
    promised_gain,
    score_gain,
    share_of_gain,
    spanned,
    unexplained,
    unexplained_square,
)
from jbf.estimation.robust import clipped_square, robust_size


def white(seed: int, n: int) -> Array:
    return np.random.default_rng(seed).standard_normal(n)


def test_likelihood_gain_is_n_times_the_log_ratio_of_squares() -> None:
    """Residuals of 6 N that become 3 N in 100 samples: 100 log 4."""
    samples = samples_of([np.ones(60), np.ones(40)])
    before = solution_of([np.full(60, 6.0), np.full(40, -6.0)], samples)
    after = solution_of([np.full(60, 3.0), np.full(40, 3.0)], samples)
    assert likelihood_gain(after, before) == pytest.approx(100.0 * np.log(4.0))
    assert likelihood_gain(before, after) == pytest.approx(-100.0 * np.log(4.0))


def test_likelihood_gain_uses_the_smaller_of_two_weights_of_a_sample() -> None:
    """Samples that the richer model excludes do not contribute to its gain."""
    whole, part = np.ones(100), np.concatenate((np.zeros(40), np.ones(60)))
    before = solution_of([np.full(100, 2.0)], samples_of([whole]))
    after = solution_of([np.concatenate((np.full(40, 9.0), np.ones(60)))], samples_of([part]))
    assert likelihood_gain(after, before) == pytest.approx(60.0 * np.log(4.0))


def test_clipped_gain_from_one_outlier_is_bounded() -> None:
    """A sample at 100 standard deviations, against half a standard deviation in all samples."""
    drawn = white(4, 1000)
    samples = samples_of([np.ones(600), np.ones(400)])
    off = drawn.copy()
    off[700] += 100.0
    followed = solution_of([drawn[:600], drawn[600:]], samples)
    missed = solution_of([off[:600], off[600:]], samples)
    assert likelihood_gain(followed, missed) > 2000.0
    assert 0.0 < gain_of_most(followed, missed) < 1.1 * 3.5**2
    level = solution_of([drawn[:600] + 0.5, drawn[600:] + 0.5], samples)
    assert gain_of_most(followed, level) == pytest.approx(250.0, rel=0.15)
    assert gain_of_most(level, followed) < -180.0
    halves = [solution_of([0.5 * r for r in s.residuals], samples) for s in (followed, missed)]
    assert gain_of_most(*halves) == pytest.approx(gain_of_most(followed, missed))


def test_robust_size_is_the_median_absolute_value_over_0_6745() -> None:
    assert robust_size(np.array([1.0, -2.0, 30.0])) == pytest.approx(2.0 / 0.6745)
    assert robust_size(np.zeros(0)) == 0.0
    assert robust_size(white(1, 20000)) == pytest.approx(1.0, abs=0.02)


def test_squares_are_clipped_at_three_and_a_half_standard_deviations() -> None:
    errors = np.array([0.5, -1.0, 3.4, -7.0, 1e9])
    assert clipped_square(errors, 2.0) == pytest.approx(0.25 + 1.0 + 3.4**2 + 7.0**2 + 7.0**2)


def test_expected_gain_is_that_of_one_gauss_newton_step() -> None:
    """A step along the first axis takes (3, 4) to (0, 4): 25 becomes 16."""
    r, j = np.array([3.0, 4.0]), np.array([[1.0], [0.0]])
    assert promised_gain(r, j, 10) == pytest.approx(10.0 * np.log(25.0 / 16.0))
    assert promised_gain(r, np.zeros((2, 1)), 10) == 0.0
    samples = samples_of([np.ones(2)])
    assert next_step_gain(solution_of([r], samples, [j])) == pytest.approx(
        2.0 * np.log(25.0 / 16.0)
    )
    converged = solution_of([np.array([0.0, 4.0])], samples, [j])
    assert next_step_gain(converged) == pytest.approx(0.0, abs=1e-12)


def test_score_gain_of_a_linear_effect_is_the_gain_of_its_fit() -> None:
    runs = four_runs(lambda t, v, a: coulomb(t, v, a) + 0.2, noise_n=0.1)
    bare, offset = coulomb_problem(runs), coulomb_problem(runs, ["sensor_offset"])
    near = solution_at(bare, values_of(bare))
    at_null = values_of(offset, **{"sensor_offset.b_n": 0.0})
    v = np.concatenate([p.motion.velocity_m_s for p in bare.campaign.prepared])
    r = np.concatenate(near.residuals)
    x = np.column_stack([np.sign(v), v, np.ones(len(v))])
    left = r - x @ np.linalg.lstsq(x, r, rcond=None)[0]
    wanted = len(r) * np.log(float(r @ r) / float(left @ left))
    assert wanted > 1000.0
    assert score_gain(offset, at_null, near) == pytest.approx(wanted, rel=1e-6)


DESIGN = np.array([[1.0, 0.0, 1.0], [0.0, 2.0, 2.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
"""Three columns, of which the third is the sum of the others."""
TARGET = np.array([3.0, 8.0, -1.0, 2.0])


@pytest.mark.parametrize("scale", [1e-200, 1.0, 1e200])
def test_regression_residual_does_not_depend_on_the_scale_of_the_columns(scale: float) -> None:
    design = DESIGN * [1.0, scale, 1.0] if scale == 1e200 else scale * DESIGN
    design[:, 2] = design[:, 0] + design[:, 1]
    np.testing.assert_allclose(unexplained(design, TARGET), [0.0, 0.0, -1.0, 2.0], atol=1e-12)
    assert unexplained_square(design, TARGET) == pytest.approx(5.0)
    span = spanned(scale * DESIGN)
    assert span.shape == (4, 2)
    np.testing.assert_allclose(span.T @ span, np.eye(2), atol=1e-12)
    np.testing.assert_allclose(span @ (span.T @ TARGET), [3.0, 8.0, 0.0, 0.0], atol=1e-12)


def test_least_squares_solution_has_minimum_norm_in_columns_of_unit_length() -> None:
    np.testing.assert_allclose(least_squares(DESIGN[:, :2], TARGET), [3.0, 4.0])
    twice = np.column_stack([DESIGN[:, 0], DESIGN[:, 0], np.zeros(4)])
    np.testing.assert_allclose(least_squares(twice, TARGET), [1.5, 1.5, 0.0], atol=1e-12)
    np.testing.assert_allclose(least_squares(1e-2 * DESIGN[:, :2], TARGET), [300.0, 400.0])


def bartlett_share(runs: list[Array], step_s: float) -> float:
    """`1 / (1 + 2 sum rho_k)` (Bartlett 1946) to 2/sqrt(n) or the longest memory of the model."""
    centred = [e - np.mean(np.concatenate(runs)) for e in runs]
    count, whole = sum(map(len, runs)), sum(float(e @ e) for e in centred)
    total = 0.0
    for k in range(1, int(0.6 / step_s) + 2):
        rho = sum(float(e[k:] @ e[:-k]) for e in centred) / whole
        if rho < 2.0 / np.sqrt(count):
            break
        total += rho
    return 1.0 / (1.0 + 2.0 * total)


@pytest.mark.parametrize("step_s", [0.02, 0.25])
@pytest.mark.parametrize("length", [1, 4, 12])
def test_independent_share_of_correlated_samples_follows_bartletts_formula(
    length: int, step_s: float
) -> None:
    """Moving averages in two runs of different length about a level."""
    runs = [2.0 + np.convolve(white(length + n, n), np.ones(length), "valid") for n in (400, 250)]
    found = independent_share(runs, (step_s, step_s))
    assert found == pytest.approx(bartlett_share(runs, step_s), rel=1e-9)
    assert found == pytest.approx(1.0 / length, rel=0.5) or step_s > 0.1


def test_autocorrelations_are_summed_up_to_the_longest_memory_of_the_noise_model() -> None:
    ramp = np.linspace(-1.0, 1.0, 4000)
    for step_s, lags in ((0.02, 31), (0.125, 5), (1.0, 1)):
        found = independent_share([ramp], (step_s,))
        assert found == pytest.approx(1.0 / (1 + 2 * lags), rel=0.03)
    # The finest step determines the number of lags.
    assert independent_share([ramp, ramp], (0.125, 0.02)) == pytest.approx(1.0 / 63.0, rel=0.03)
    assert independent_share([np.zeros(50)], (0.02,)) == 1.0


def test_gain_counts_less_if_residuals_are_correlated() -> None:
    samples = samples_of([np.ones(2000)])
    wave = np.sin(0.01 * np.arange(2000))
    slow = np.repeat(white(5, 200), 10)
    for noise, low, high in ((white(4, 2000), 0.8, 1.0), (slow, 0.03, 0.25)):
        after, before = solution_of([noise], samples), solution_of([noise + wave], samples)
        assert low <= share_of_gain(after, before) <= high
        assert share_of_gain(after, before) <= effective_share(after)


def test_gain_counts_less_if_it_comes_from_samples_with_larger_noise() -> None:
    """White noise, ten times larger in those samples in which the two models differ."""
    here = np.arange(4000) % 10 == 0
    noise = white(5, 4000) * np.where(here, 10.0, 1.0)
    samples = samples_of([np.ones(4000)])
    after = solution_of([noise], samples)
    sides = np.where(np.arange(4000) % 2, 1.0, -1.0)
    local, even = (
        share_of_gain(after, solution_of([noise + 0.1 * d], samples)) for d in (here, sides)
    )
    assert effective_share(after) > 0.9
    assert local == pytest.approx(float(np.mean(noise**2)) / 100.0, rel=0.35)
    assert even > 0.75
