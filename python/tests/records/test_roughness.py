"""Noise of a signal, steps of an encoder, and contradictions between path and speed."""

from typing import Any

import numpy as np
import pytest
from jbf.records.lagrange import weights_at_zero
from jbf.records.motion.agreement import contradiction_of
from jbf.records.motion.first_stroke import begins_with_oscillation
from jbf.records.motion.roughness import encoder_step, local_noise, noise_of, quantum_of, step_of
from known_motions import path_of, places, quantised, white

STEP_S = 0.01
TIME_S: Any = STEP_S * np.arange(400)
ALTERNATING: Any = np.where(np.arange(1000) % 2, -1.0, 1.0)
NOISE_OF_ALTERNATING = 8.0 / 0.6745 / np.sqrt(20.0)
"""Its third differences are 8; in unit white noise they have a variance of 20."""


def test_lagrange_weights_of_four_samples_reproduce_a_cubic() -> None:
    even = weights_at_zero(np.array([-2.0, -1.0, 1.0, 2.0]))
    np.testing.assert_allclose(even, np.array([-1.0, 4.0, 4.0, -1.0]) / 6.0)
    t = np.array([[-3.0, -2.0], [-1.0, -0.5], [0.5, 1.0], [4.0, 7.0]])
    value = 2.0 - 3.0 * t + 0.5 * t**2 + 4.0 * t**3
    np.testing.assert_allclose(np.sum(weights_at_zero(t) * value, axis=0), 2.0)


def test_noise_estimate_is_the_deviation_of_white_noise_on_a_smooth_signal() -> None:
    assert noise_of(TIME_S**2) < 1e-12
    assert noise_of(ALTERNATING) == pytest.approx(NOISE_OF_ALTERNATING)
    assert noise_of(ALTERNATING[:8]) > 0.0
    assert noise_of(ALTERNATING[:7]) == 0.0
    time_s = np.arange(0.0, 60.0, 0.02)
    signal = 10.0 * np.tanh(20.0 * np.sin(time_s)) + white(len(time_s), 1, 0.3)
    assert noise_of(signal) == pytest.approx(0.3, rel=0.15)


def test_noise_estimate_is_local_if_a_part_is_three_times_as_noisy_as_the_rest() -> None:
    loud = (np.arange(1000) > 400) & (np.arange(1000) < 700)
    assert not isinstance(local_noise(np.where(loud, 2.9, 1.0) * ALTERNATING), np.ndarray)
    noise: Any = local_noise(np.where(loud, 3.1, 1.0) * ALTERNATING)
    assert noise[[100, 550]] == pytest.approx(NOISE_OF_ALTERNATING * np.array([1.0, 3.1]))


def test_encoder_step_is_the_smallest_change_above_rounding_and_noise() -> None:
    assert step_of(np.array([0.0, 0.3, 0.3, 0.2, 0.2 + 1e-13])) == pytest.approx(0.1)
    assert step_of(np.ones(5)) == step_of(np.array([1.0])) == 0.0
    path = path_of(TIME_S)
    assert encoder_step(quantised(path, 1e-4)) == pytest.approx(1e-4)
    assert encoder_step(path + white(400, 3, 1e-4)) == 0.0


@pytest.mark.parametrize("step", [1e-4, 1e-3])
def test_quantisation_step_of_a_rounded_path_is_recovered_at_any_speed(step: float) -> None:
    for turns in (0.01, 1.0, 20.0):
        path = quantised(turns * path_of(TIME_S), step)
        expected = step if np.ptp(path) > 15.0 * step else 0.0
        assert quantum_of(path) == pytest.approx(expected)
        assert quantum_of(np.round(path + 7.0, 9)) == pytest.approx(expected)


@pytest.mark.parametrize("digits", [7, 9])
def test_quantisation_step_is_recovered_from_a_file_with_few_digits(digits: int) -> None:
    """The digits round positions of several turns by up to a fiftieth of the encoder's step."""
    step = 2.0 * np.pi / 4096.0
    time_s = np.arange(0.0, 20.0, STEP_S)
    angle = quantised(10.0 + 40.0 * np.sin(0.7 * time_s) + 5.0 * np.sin(3.1 * time_s), step)
    written = np.array([float(f"{value:.{digits}g}") for value in angle])
    assert quantum_of(written) == pytest.approx(step, rel=1e-4)


def test_digits_of_a_fine_path_are_its_quantisation_step() -> None:
    time_s = np.arange(0.0, 16.0, 0.004)
    path = 0.05 * np.sin(2.0 * time_s) + 0.02 * np.sin(7.3 * time_s)
    assert quantum_of(np.round(path, 8)) == pytest.approx(1e-8)


def test_no_quantisation_step_is_estimated_from_noise_two_levels_or_exact_ramps() -> None:
    assert quantum_of(path_of(TIME_S)) == 0.0
    assert quantum_of(white(400, 3, 1.0)) == 0.0
    assert quantum_of(np.where(np.arange(400) % 50 < 25, 0.1, -0.1)) == 0.0
    ramps = 0.01 * np.abs(np.mod(np.arange(400), 80) - 40)
    assert quantum_of(ramps) == 0.0
    assert quantum_of(np.cumsum(ramps)) == 0.0


@pytest.mark.parametrize("power", [0, 1, 2])
def test_noise_at_uneven_instants_is_unaffected_by_a_polynomial_trend(power: int) -> None:
    random = np.random.default_rng(4)
    time_s = np.cumsum(random.uniform(0.2, 1.8, 4000))
    signal = white(4000, 6, 0.3) + 5.0 * time_s**power
    assert noise_of(signal, time_s) == pytest.approx(0.3, rel=0.05)
    even = white(4000, 7, 0.3)
    assert noise_of(even, np.arange(4000.0)) == pytest.approx(noise_of(even))


def contradictions(jumps: dict[int, float], sd_path: float = 0.0, sd_speed: float = 0.0) -> Any:
    """Contradictions of a shaft at rest: a path alternating by 1 um with jumps (sample to size)."""
    path: Any = 1e-6 * (np.arange(400) % 2)
    for sample, size in jumps.items():
        path[sample + 1 :] += size
    return contradiction_of(TIME_S, path, np.zeros(400), sd_path, sd_speed)


def test_path_jump_contradicts_the_speed_at_three_samples_on_each_side() -> None:
    single = contradictions({100: 1e-3})
    assert places(single) == [98, 99, 100, 101, 102, 103]
    assert single[100] == pytest.approx(1e-3 / STEP_S, rel=2e-3)
    both = contradictions({100: 1e-3, 103: -3e-3})
    assert places(both) == list(range(98, 107))
    assert both[[99, 102]] == pytest.approx([0.1, 0.3], rel=2e-3)
    assert not contradictions({}).any()


@pytest.mark.parametrize(("n", "found"), [(9.6, False), (10.4, True)])
def test_path_jump_over_ten_times_gap_or_noise_contradicts_speed(n: float, found: bool) -> None:
    usual, sd = 1e-6, 1e-5
    of_usual = contradictions({100: n * usual / 0.6745 - usual})
    of_path = contradictions({100: n * np.sqrt(2.0) * sd - usual}, sd_path=sd)
    of_speed = contradictions({100: n * sd - usual}, sd_speed=sd / np.sqrt(0.5) / STEP_S)
    assert [values.any() for values in (of_usual, of_path, of_speed)] == [found] * 3


@pytest.mark.parametrize(
    ("first", "hum"),
    [([0.5], True), ([5.0], False), ([0.0], False), ([0.4] * 3, True), ([0.6] * 3, False)],
)
def test_first_stroke_below_a_thousandth_of_the_longest_is_a_rest(first: Any, hum: bool) -> None:
    speed = np.array([*first, *([-1.0] * 1001)])
    assert begins_with_oscillation(np.arange(float(len(speed))), speed) == hum
