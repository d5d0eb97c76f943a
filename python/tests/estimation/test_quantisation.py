"""Bias of the mean of quantised readings, and its removal by means of the model's force.

The mean of readings in steps q of a force f with Gaussian noise s has the error
`(q / pi) sum_k (-1)^k / k exp(-2 (k pi s / q)^2) sin(2 k pi f / q)` (Widrow 1956).
"""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from by_hand import LAW, Array, coulomb
from jbf import Rig, Run
from jbf.diagnosis.policy import DEFAULT
from jbf.diagnosis.terms.quantiser import without_bias
from jbf.estimation.campaign import Campaign
from jbf.estimation.noise import WHITE
from jbf.estimation.problem import Problem
from jbf.estimation.quantisation import (
    MOST_NOISE,
    bias_rms,
    noise_before_converter,
    quantisation_bias,
    zero_offset,
)
from jbf.estimation.solution import Solution
from scipy import integrate, stats

LEVELS = np.arange(-60, 61)
STEP_N, NOISE_N, ORIGIN_N = 0.5, 0.1, 0.13


def mean_reading(step: float, noise: float, force: Array) -> Array:
    """Readings rounded to the nearest step, each with its Gaussian probability."""
    upper = stats.norm.cdf((step * (LEVELS + 0.5) - force[:, None]) / noise)
    lower = stats.norm.cdf((step * (LEVELS - 0.5) - force[:, None]) / noise)
    return (upper - lower) @ (step * LEVELS)


@pytest.mark.parametrize("step", [1e-3, 1.0, 40.0])
@pytest.mark.parametrize("noise", [0.15, 0.3, 0.5])
def test_quantisation_bias_is_the_error_of_the_mean_reading(step: float, noise: float) -> None:
    force = step * np.linspace(-2.3, 2.1, 97)
    expected = mean_reading(step, noise * step, force) - force
    np.testing.assert_allclose(
        quantisation_bias(step, noise * step, force), expected, atol=2e-3 * step
    )


@pytest.mark.parametrize("noise", [0.0, 0.05])
def test_quantisation_bias_has_the_first_three_harmonics_of_a_saw_tooth(noise: float) -> None:
    force = np.arange(64) / 64.0
    sines = np.fft.rfft(quantisation_bias(1.0, noise, force)).imag / -32.0
    k = np.arange(1, 4)
    expected = (-1.0) ** k / (np.pi * k) * np.exp(-2.0 * (np.pi * k * noise) ** 2)
    np.testing.assert_allclose(sines[1:4], expected)
    np.testing.assert_allclose(np.delete(sines, [1, 2, 3]), 0.0, atol=1e-12)


@pytest.mark.parametrize("step", [1e-3, 40.0])
def test_rms_of_the_quantisation_bias_is_that_of_its_first_harmonic(step: float) -> None:
    force = step * np.linspace(0.0, 1.0, 1000, endpoint=False)
    for noise in (0.3, 0.4):
        rms = np.sqrt(np.mean(quantisation_bias(step, noise * step, force) ** 2))
        assert bias_rms(step, noise * step) == pytest.approx(rms, rel=1e-2)
    assert bias_rms(step, 0.0) == pytest.approx(step / (np.pi * np.sqrt(2.0)))


@pytest.mark.parametrize("step", [1e-3, 2.5, 40.0])
@pytest.mark.parametrize("origin", [-0.4, 0.0, 0.25])
def test_zero_offset_of_readings_is_that_from_integer_multiples_of_the_step(
    step: float, origin: float
) -> None:
    readings = step * (np.array([-3.0, 0.0, 1.0, 7.0, np.nan]) + origin)
    assert zero_offset(step, readings) == pytest.approx(origin * step, abs=1e-9 * step)


def test_zero_offset_of_noisy_readings_is_their_circular_mean() -> None:
    readings = np.array([-40.1, 0.1, 3.1, 7.9, 50.0, 2e3 - 0.1, 2e3 + 0.1])
    assert zero_offset(1.0, readings) == pytest.approx(0.0, abs=1e-9)
    assert zero_offset(1.0, readings + 0.2) == pytest.approx(0.2)


@pytest.mark.parametrize("step", [1e-3, 40.0])
@pytest.mark.parametrize("noise", [0.05, 0.3, 1.0])
def test_noise_before_conversion_is_estimated_from_repeated_readings(
    step: float, noise: float
) -> None:
    """The share of repetitions is `E max(0, 1 - |d|)`, d the difference of two noises in steps."""
    n, d = 100_000, stats.norm(0.0, np.sqrt(2.0) * noise)
    share, _ = integrate.quad(lambda x: (1.0 - x) * 2.0 * d.pdf(x), 0.0, 1.0)
    repeats = round(share * n)
    # A change below half a step counts as a repetition.
    moves = step * np.concatenate((np.full(repeats, 0.49), np.full(n - repeats, -0.51)))
    assert noise_before_converter(step, moves) == pytest.approx(noise * step, rel=2e-3)


def test_noise_before_conversion_is_limited_if_readings_always_or_never_repeat() -> None:
    assert noise_before_converter(2.0, np.zeros(100)) == 0.0
    assert noise_before_converter(2.0, np.zeros(0)) == 0.0
    assert noise_before_converter(2.0, np.full(100, 2.0)) == 2.0 * MOST_NOISE


@cache
def quantised() -> tuple[Problem, list[Array]]:
    """Two runs of Coulomb friction, the first of which is quantised, and the true forces."""
    random, runs, forces = np.random.default_rng(1), [], []
    t = np.arange(0.0, 60.0, 0.02)
    for i, rate in enumerate((0.4, 0.5)):
        v = 0.1 + 0.06 * np.sin(rate * t) + 0.02 * np.sin(0.618 * rate * t)
        force = coulomb(t, v, v)
        noisy = force + NOISE_N * random.standard_normal(len(t))
        steps = ORIGIN_N + STEP_N * np.round((noisy - ORIGIN_N) / STEP_N)
        runs.append(Run.from_arrays(t, v, steps if i == 0 else noisy, name="ab"[i]))
        forces.append(force)
    fixed = {"F_s": 6.0, "F_v": LAW["F_v"]}
    return Problem(Campaign.prepare(Rig(), runs), "coulomb", "journal", (), fixed), forces


def at_truth(problem: Problem) -> Solution:
    values = problem.starts({**LAW, "F_s": 6.0})[0]
    return problem.solution(values, problem.campaign.samples, WHITE)


def test_quantisation_bias_is_removed_if_the_model_is_the_true_one() -> None:
    """The bias depends on the noise before the converter, estimated from the readings."""
    problem, forces = quantised()
    assert problem.campaign.step_n == pytest.approx(STEP_N)
    corrected = without_bias(problem, at_truth(problem), DEFAULT)[0]
    coarse, fine = corrected.prepared
    removed = coarse.readings_n - coarse.friction
    expected = mean_reading(STEP_N, NOISE_N, forces[0] - ORIGIN_N) - (forces[0] - ORIGIN_N)
    assert np.std(expected) > 0.05 * STEP_N
    np.testing.assert_allclose(removed, expected, atol=0.015 * STEP_N)
    np.testing.assert_array_equal(fine.friction, fine.readings_n)
    # A share of the removed bias is assumed to remain.
    assert corrected.steps_rms(1.0) < 0.5 * problem.campaign.steps_rms(1.0)
    again = Problem(corrected, "coulomb", "journal", (), problem.fixed)
    assert without_bias(again, at_truth(again), DEFAULT) is None
    # A shift in time is applied to the uncorrected readings.
    np.testing.assert_array_equal(coarse.shifted(0.0, 0.0).friction, coarse.readings_n)


def test_quantisation_bias_is_removed_iteratively_if_the_model_is_fitted() -> None:
    """A fit to biased readings predicts another force and hence another bias; both are iterated."""
    problem, forces = quantised()
    free = Problem(problem.campaign, "coulomb", "journal", (), {"F_s": 6.0})
    start = free.starts({**LAW, "F_s": 6.0, "F_c": 5.1})[0]
    start_fit = free.solution(start, free.campaign.samples, WHITE)
    corrected = without_bias(free, start_fit, DEFAULT)[0]
    removed = corrected.prepared[0].readings_n - corrected.prepared[0].friction
    expected = mean_reading(STEP_N, NOISE_N, forces[0] - ORIGIN_N) - (forces[0] - ORIGIN_N)
    np.testing.assert_allclose(removed, expected, atol=0.03 * STEP_N)


def test_quantisation_bias_is_kept_if_its_correction_is_below_the_policy_limit() -> None:
    problem, _ = quantised()
    solution = at_truth(problem)
    corrected = without_bias(problem, solution, DEFAULT)[0]
    off = [p.readings_n - p.friction for p in corrected.prepared]
    moves = corrected.samples.rms(off) / problem.campaign.step_n
    for share, removed in ((0.95, True), (1.05, False)):
        policy = DEFAULT.with_values({"quantisation.min_bias_change": share * moves})
        assert (without_bias(problem, solution, policy) is not None) == removed


def test_quantisation_bias_is_kept_if_the_model_error_exceeds_a_step() -> None:
    problem, _ = quantised()
    right = at_truth(problem)
    wave = [3.0 * STEP_N * np.sin(0.01 * np.arange(len(r))) for r in right.residuals]
    wrong = replace(right, residuals=[r + w for r, w in zip(right.residuals, wave, strict=True)])
    policy = DEFAULT.with_values({"quantisation.min_bias_change": 0.35 * 0.1})
    assert without_bias(problem, right, policy) is not None
    assert without_bias(problem, wrong, policy) is None
