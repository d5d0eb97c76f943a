"""Noise of a constant load, and thermometers that are slow, coarse or noisy."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from jbf import Run
from jbf.records.findings.noisy_load import find_noisy_load, only_noise, steady_load
from jbf.records.findings.slow_temperature import find_slow_temperature, recorded_temperature
from known_motions import white

LOAD_N: Any = 100.0 + white(500, 5, 2.0)


def test_noisy_constant_load_is_replaced_by_its_mean_and_reported() -> None:
    assert steady_load(LOAD_N).tolist() == [float(np.mean(LOAD_N))] * 500
    (finding,) = find_noisy_load("a", LOAD_N)
    assert (finding.kind, finding.channel, finding.unit) == ("noisy_load", "load_n", "N")
    assert finding.size == pytest.approx(np.std(LOAD_N))
    assert find_noisy_load("a", None) == find_noisy_load("a", np.full(500, 1.0)) == []


def test_load_that_changes_is_not_averaged() -> None:
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


@pytest.mark.parametrize(("probability", "noise"), [(1.03e-4, True), (0.97e-4, False)])
def test_load_with_a_significant_spectral_line_is_not_noise(
    probability: float, noise: bool
) -> None:
    """Fisher's test: a line with a share g of the power has probability m (1 - g)^(m - 1)."""
    m = 249
    g = 1.0 - (probability / m) ** (1.0 / (m - 1))
    power = np.ones(m)
    power[m // 2] = g * (m - 1) / (1.0 - g)
    assert only_noise(load_with_periodogram(power)) == noise


@pytest.mark.parametrize(("probability", "noise"), [(1.1e-4, True), (0.9e-4, False)])
@pytest.mark.parametrize("order", [1, -1])
def test_load_with_a_coloured_spectrum_is_not_noise(
    probability: float, noise: bool, order: int
) -> None:
    """Bartlett's test: a cumulative periodogram that deviates by d has 2 exp(-2 m d^2)."""
    m = 300
    d = np.sqrt(np.log(2.0 / probability) / (2.0 * m))
    power = np.where(np.arange(m) < m // 2, 0.5 + d, 0.5 - d)[::order]
    assert only_noise(load_with_periodogram(power)) == noise


def with_temperature(time_s: Any, celsius: Any) -> Run:
    return Run.from_arrays(time_s, np.ones(len(time_s)), temperature_c=celsius, name="a")


def test_held_temperature_is_interpolated_between_the_midpoints_of_its_steps() -> None:
    time_s: Any = 0.1 * np.arange(2000)
    run = with_temperature(time_s, 20.0 + 0.5 * np.floor(time_s / 4.0))
    (finding,) = find_slow_temperature(run)
    assert (finding.kind, finding.channel, finding.unit) == ("held_samples", "temperature_c", "s")
    assert finding.size == pytest.approx(4.0)
    found = recorded_temperature(run)
    assert found is not None
    inside = (time_s > 4.0) & (time_s < 196.0)
    # Steps of 0.5 K at 4 s, 8 s, ...: a line of 0.125 K/s through 20.25 C at 3.95 s.
    expected = 20.25 + 0.125 * (time_s - 3.95)
    np.testing.assert_allclose(found[inside], expected[inside], atol=1e-9)


@pytest.mark.parametrize(("noise_k", "found"), [(0.08, False), (0.13, True)])
def test_temperature_noise_above_a_tenth_of_a_kelvin_is_reported_and_averaged(
    noise_k: float, found: bool
) -> None:
    run = with_temperature(0.1 * np.arange(1000), 20.0 + white(1000, 1, noise_k))
    findings = find_slow_temperature(run)
    assert [f.kind for f in findings] == (["noisy_temperature"] if found else [])
    assert all(f.size == pytest.approx(noise_k, rel=0.1) for f in findings)
    steady = recorded_temperature(run)
    assert steady is not None
    assert (np.std(steady) < 0.5 * noise_k) == found


def test_averaged_temperature_is_the_symmetric_mean_over_two_seconds() -> None:
    """The trapezoidal mean over 1 s on each side, narrower at the ends of the record."""
    time_s: Any = 0.1 * np.arange(300)
    celsius = 20.0 + 3.0 * time_s + white(300, 2, 0.5)
    found = recorded_temperature(with_temperature(time_s, celsius))
    assert found is not None
    for i in (0, 4, 10, 150, 297, 299):
        half = min(10, i, 299 - i)
        window = slice(i - half, i + half + 1)
        mean = np.trapezoid(celsius[window], time_s[window]) / (0.2 * half) if half else celsius[i]
        assert found[i] == pytest.approx(mean), i


def test_noise_free_temperature_that_changes_at_every_sample_is_unchanged() -> None:
    time_s: Any = 0.1 * np.arange(2000)
    run = with_temperature(time_s, 20.0 + 0.01 * time_s)
    assert find_slow_temperature(run) == []
    np.testing.assert_array_equal(recorded_temperature(run), run.temperature_c)


def test_run_without_a_temperature_has_no_temperature_finding() -> None:
    time_s: Any = 0.1 * np.arange(2000)
    run = replace(with_temperature(time_s, 20.0 + 0.01 * time_s), temperature_c=None)
    assert find_slow_temperature(run) == []
    assert recorded_temperature(run) is None
