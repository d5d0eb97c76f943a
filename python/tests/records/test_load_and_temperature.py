"""Noise of a constant load; thermometers that are slow, coarsely quantised or noisy."""

from typing import Any

import numpy as np
import pytest
from jbf import Run
from jbf.records.findings.noisy_load import find_noisy_load, only_noise, steady_load
from jbf.records.findings.slow_temperature import find_slow_temperature, recorded_temperature
from known_motions import white

LOAD_N: Any = 100.0 + white(500, 5, 2.0)
TIME_S: Any = 0.1 * np.arange(2000)


def test_noisy_constant_load_is_replaced_by_its_mean_and_reported() -> None:
    assert steady_load(LOAD_N).tolist() == [float(np.mean(LOAD_N))] * 500
    (finding,) = find_noisy_load("a", LOAD_N)
    assert (finding.kind, finding.channel, finding.unit) == ("noisy_load", "load_n", "N")
    assert finding.size == pytest.approx(np.std(LOAD_N))
    assert find_noisy_load("a", None) == find_noisy_load("a", np.full(500, 1.0)) == []


def test_load_that_changes_with_time_is_not_averaged() -> None:
    t = np.arange(500)
    for change in (2.0 * np.sin(0.3 * t), 0.01 * t, 4.0 * (t > 250), np.cumsum(LOAD_N - 100.0)):
        load = LOAD_N + change
        assert not only_noise(load)
        assert steady_load(load) is load


def load_with_periodogram(power: Any) -> Any:
    """A load of about 100 N with a given periodogram and random phases."""
    phases = np.random.default_rng(9).uniform(0.0, 2.0 * np.pi, len(power))
    lines = np.sqrt(power) * np.exp(1j * phases)
    wave = np.fft.irfft(np.concatenate(([0.0], lines, [0.0])), 2 * len(power) + 2)
    return 100.0 + wave / np.ptp(wave)


def test_load_is_not_noise_if_a_spectral_line_has_a_probability_below_1e_minus_4() -> None:
    """Fisher's test: a line with a share g of the power has the probability m (1 - g)^(m - 1)."""
    m = 249
    for probability, noise in ((1.03e-4, True), (0.97e-4, False)):
        g = 1.0 - (probability / m) ** (1.0 / (m - 1))
        power = np.where(np.arange(m) == m // 2, g * (m - 1) / (1.0 - g), 1.0)
        assert only_noise(load_with_periodogram(power)) == noise


@pytest.mark.parametrize("order", [1, -1])
def test_load_is_not_noise_if_its_colour_has_a_probability_below_1e_minus_4(order: int) -> None:
    """Bartlett's test: a deviation d of the cumulative periodogram has 2 exp(-2 m d^2)."""
    m = 300
    for probability, noise in ((1.1e-4, True), (0.9e-4, False)):
        d = np.sqrt(np.log(2.0 / probability) / (2.0 * m))
        power = np.where(np.arange(m) < m // 2, 0.5 + d, 0.5 - d)[::order]
        assert only_noise(load_with_periodogram(power)) == noise


def with_temperature(celsius: Any) -> Run:
    time_s = TIME_S[: len(celsius)]
    return Run.from_arrays(time_s, np.ones(len(time_s)), temperature_c=celsius, name="a")


def test_held_temperature_is_interpolated_between_the_midpoints_of_its_steps() -> None:
    run = with_temperature(20.0 + 0.5 * np.floor(TIME_S / 4.0))
    (finding,) = find_slow_temperature(run)
    assert (finding.kind, finding.channel, finding.unit) == ("held_samples", "temperature_c", "s")
    assert finding.size == pytest.approx(4.0)
    celsius: Any = recorded_temperature(run)
    inside = (TIME_S > 4.0) & (TIME_S < 196.0)
    # Steps of 0.5 K at 4 s, 8 s, ...: a line of 0.125 K/s through 20.25 C at 3.95 s.
    expected = 20.25 + 0.125 * (TIME_S - 3.95)
    np.testing.assert_allclose(celsius[inside], expected[inside], atol=1e-9)


def test_temperature_noise_above_a_tenth_of_a_kelvin_is_reported_and_averaged() -> None:
    quiet, noisy = (with_temperature(20.0 + white(1000, 1, noise_k)) for noise_k in (0.08, 0.13))
    assert find_slow_temperature(quiet) == []
    assert np.std(np.asarray(recorded_temperature(quiet), float)) >= 0.04
    (finding,) = find_slow_temperature(noisy)
    assert (finding.kind, finding.size) == ("noisy_temperature", pytest.approx(0.13, rel=0.1))
    assert np.std(np.asarray(recorded_temperature(noisy), float)) < 0.065


def test_averaged_temperature_is_the_symmetric_mean_over_two_seconds() -> None:
    """The trapezoidal mean over 1 s on each side, narrower at the ends of the record."""
    celsius = 20.0 + 3.0 * TIME_S[:300] + white(300, 2, 0.5)
    averaged: Any = recorded_temperature(with_temperature(celsius))
    for i in (0, 4, 10, 150, 297, 299):
        half = min(10, i, 299 - i)
        window = slice(i - half, i + half + 1)
        mean = np.trapezoid(celsius[window], dx=0.1) / (0.2 * half) if half else celsius[i]
        assert averaged[i] == pytest.approx(mean), i


def test_noise_free_temperature_that_changes_at_every_sample_is_unchanged() -> None:
    run = with_temperature(20.0 + 0.01 * TIME_S)
    assert find_slow_temperature(run) == []
    np.testing.assert_array_equal(recorded_temperature(run), run.temperature_c)


def test_run_without_a_temperature_has_no_temperature_finding() -> None:
    run = Run.from_arrays(TIME_S, np.ones(2000))
    assert find_slow_temperature(run) == []
    assert recorded_temperature(run) is None
