"""What a converter's steps make of a mean reading, against sums and integrals over its steps."""

from __future__ import annotations

import numpy as np
import pytest
from by_hand import Array
from jbf.estimation.converter import MOST_NOISE, bias_n, curve_rms_n, noise_before, origin_n
from scipy import integrate, stats

STEPS = np.arange(-60, 61)


def mean_reading(step: float, noise: float, force: Array) -> Array:
    """Of readings to the nearest step: each step by its probability."""
    upper = stats.norm.cdf((step * (STEPS + 0.5) - force[:, None]) / noise)
    lower = stats.norm.cdf((step * (STEPS - 0.5) - force[:, None]) / noise)
    found: Array = (upper - lower) @ (step * STEPS)
    return found


@pytest.mark.parametrize("step", [1e-3, 1.0, 40.0])
@pytest.mark.parametrize("noise", [0.15, 0.3, 0.5])
def test_the_bias_is_what_the_mean_reading_is_off(step: float, noise: float) -> None:
    force = step * np.linspace(-2.3, 2.1, 97)
    wanted = mean_reading(step, noise * step, force) - force
    assert bias_n(step, noise * step, force) == pytest.approx(wanted, abs=2e-3 * step)
    assert np.max(np.abs(wanted)) > 1e-3 * step or noise > 0.4


@pytest.mark.parametrize("step", [1e-3, 40.0])
def test_the_curve_has_the_size_of_its_first_harmonic(step: float) -> None:
    force = step * np.linspace(0.0, 1.0, 1000, endpoint=False)
    for noise in (0.3, 0.4):
        size = np.sqrt(np.mean(bias_n(step, noise * step, force) ** 2))
        assert curve_rms_n(step, noise * step) == pytest.approx(size, rel=1e-2)
    # Without noise the first harmonic of a saw tooth: its amplitude is a step over pi.
    assert curve_rms_n(step, 0.0) == pytest.approx(step / (np.pi * np.sqrt(2.0)))


@pytest.mark.parametrize("step", [1e-3, 2.5, 40.0])
@pytest.mark.parametrize("off", [-0.4, 0.0, 0.25])
def test_readings_lie_off_whole_steps_by_their_origin(step: float, off: float) -> None:
    readings = step * (np.array([-3.0, 0.0, 1.0, 7.0, np.nan]) + off)
    assert origin_n(step, readings) == pytest.approx(off * step, abs=1e-9 * step)


def test_the_origin_of_readings_with_noise_is_the_middle_of_their_circle() -> None:
    """Each counts alike, however large it is."""
    readings = np.array([-40.1, 0.1, 3.1, 7.9, 50.0, 2e3 - 0.1, 2e3 + 0.1])
    assert origin_n(1.0, readings) == pytest.approx(0.0, abs=1e-9)
    assert origin_n(1.0, readings + 0.2) == pytest.approx(0.2)


@pytest.mark.parametrize("noise", [0.0, 0.05])
def test_three_harmonics_of_the_saw_tooth_are_counted(noise: float) -> None:
    """Each as high as a step over pi and its number, and sunk by the noise as a Gaussian."""
    force = np.arange(64) / 64.0
    waves = np.fft.rfft(bias_n(1.0, noise, force)).imag / -32.0
    k = np.arange(1, 4)
    sunk = np.exp(-2.0 * (np.pi * k * noise) ** 2)
    assert waves[1:4] == pytest.approx((-1.0) ** k / (np.pi * k) * sunk)
    assert np.delete(waves, [1, 2, 3]) == pytest.approx(np.zeros(30), abs=1e-12)


def same(noise: float) -> float:
    """How often two readings of one force are one, by the chance of their distance in steps."""
    apart = np.sqrt(2.0) * noise
    whole, _ = integrate.quad(lambda d: (1.0 - d) * 2.0 * stats.norm.pdf(d, 0.0, apart), 0.0, 1.0)
    return float(whole)


@pytest.mark.parametrize("step", [1e-3, 40.0])
@pytest.mark.parametrize("noise", [0.05, 0.3, 1.0])
def test_the_noise_before_is_told_by_how_often_a_reading_stays(step: float, noise: float) -> None:
    n = 100_000
    stays = round(same(noise) * n)
    moves = step * np.concatenate((np.zeros(stays), np.ones(n - stays)))
    assert noise_before(step, moves) == pytest.approx(noise * step, rel=2e-3)
    # Less than half a step is none.
    nearly = step * np.concatenate((np.full(stays, 0.49), np.full(n - stays, -0.51)))
    assert noise_before(step, nearly) == pytest.approx(noise * step, rel=2e-3)


def test_readings_that_always_or_never_stay_tell_the_ends() -> None:
    assert noise_before(2.0, np.zeros(100)) == 0.0
    assert noise_before(2.0, np.zeros(0)) == 0.0
    assert MOST_NOISE == 3.0
    assert noise_before(2.0, np.full(100, 2.0)) == 6.0
