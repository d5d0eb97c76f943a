"""Spectral lines in innovations: significance, frequency, amplitude and share in closed form."""

import re
from collections.abc import Sequence
from functools import cache

import numpy as np
import pytest
from jbf.diagnosis import Remainder
from jbf.diagnosis.policy import DEFAULT
from jbf.diagnosis.residual_structure.periodic import find_tones
from slides import STEP_S, Array, Mask, steady_slides, white_noise

SMALLEST_SHARE = 1e-12

campaign_of = cache(steady_slides)


def tones_in(
    *signals: Array,
    residuals: Sequence[Array] | None = None,
    share: float = SMALLEST_SHARE,
    counted: list[Mask] | None = None,
) -> list[Remainder]:
    """Tones detected in the given innovations and, by default, equal residuals."""
    campaign = campaign_of(*(len(s) for s in signals))
    samples = campaign.samples if counted is None else campaign.samples.within(counted)
    policy = DEFAULT.with_values({"tones.min_share": share})
    return find_tones(campaign.prepared, samples, signals, residuals or signals, policy)


def pairs_in(tone: Remainder) -> list[tuple[float, float]]:
    """Frequency (Hz) and amplitude (N) of each tone in a description."""
    return [(float(f), float(a)) for f, a in re.findall(r"([\d.]+) Hz.*?([\d.]+) N", tone.where)]


def flat_spectrum(n: int, lines: dict[int, float], seed: int = 0) -> Array:
    """A signal of spectral power 1 except at the given lines (line to power)."""
    phases = np.random.default_rng(seed).uniform(0.0, 2.0 * np.pi, n // 2 + 1)
    size = np.ones(n // 2 + 1)
    size[0] = 0.0
    for k, power in lines.items():
        size[k] = np.sqrt(power)
    return np.fft.irfft(size * np.exp(1j * phases), n)


def sine(n: int, frequency_hz: float, amplitude: float = 1.0, phase: float = 0.0) -> Array:
    signal: Array = amplitude * np.sin(2.0 * np.pi * frequency_hz * STEP_S * np.arange(n) + phase)
    return signal


def test_no_tone_is_reported_in_white_noise() -> None:
    campaign = campaign_of(1500, 1500, 1500)
    assert all(tones_in(*white_noise(campaign, seed)) == [] for seed in range(20))


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
def test_tone_is_significant_above_a_quantile_of_exponential_power(unit: float) -> None:
    """Power of a spectral line of white noise: exponential with median log 2 (Fisher 1929)."""
    lines = 1024 // 2 - 8
    height = np.log(lines / DEFAULT.tones.chance) / np.log(2.0)
    for part, significant in ((0.98, False), (1.02, True)):
        assert bool(tones_in(unit * flat_spectrum(1024, {100: part * height}))) == significant


@pytest.mark.parametrize(("periods", "found"), [(7, False), (8, False), (9, True), (512, True)])
def test_tone_is_reported_only_above_eight_periods_in_a_run(periods: int, found: bool) -> None:
    assert bool(tones_in(flat_spectrum(1024, {periods: 1e3}))) == found


@pytest.mark.parametrize(("samples", "found"), [(63, False), (64, True)])
def test_tone_is_reported_only_in_runs_of_at_least_64_samples(samples: int, found: bool) -> None:
    short, other = flat_spectrum(samples, {20: 1e3}), flat_spectrum(1024, {100: 1e4})
    assert bool(tones_in(short)) == found
    (tone,) = tones_in(short, other)
    assert len(pairs_in(tone)) == 1 + found


def test_tone_is_attributed_only_to_its_runs_if_others_are_constant_or_quiet() -> None:
    loud = flat_spectrum(1024, {100: 1e4})
    (tone,) = tones_in(np.zeros(1024), loud, np.ones(512), flat_spectrum(1024, {}), loud)
    assert tone.where.endswith(" in b, e")


@pytest.mark.parametrize("off", [-0.4, 0.0, 0.2])
def test_frequency_and_amplitude_of_a_tone_are_exact_between_lines(off: float) -> None:
    n = 1000
    frequency = (100.0 + off) / (n * STEP_S)
    noise = 0.01 * np.random.default_rng(1).standard_normal(n)
    (tone,) = tones_in(sine(n, frequency, 2.5, 0.7) + noise)
    assert tone.axis == "frequency"
    ((found_hz, amplitude_n),) = pairs_in(tone)
    assert found_hz == pytest.approx(frequency, abs=0.006)
    assert amplitude_n == pytest.approx(2.5, rel=0.02)
    assert tone.share == pytest.approx(1.0, abs=0.01)


def test_share_of_tones_is_that_of_their_power_in_all_runs() -> None:
    n = 1000
    noise = white_noise(campaign_of(n, n, n), 2, 1.5)
    tones = [sine(n, 5.0, 2.0), sine(n, 9.0, 1.0, 0.5 * np.pi), np.zeros(n)]
    signals = [a + b for a, b in zip(tones, noise, strict=True)]
    (tone,) = tones_in(*signals)
    total = sum(float(x @ x) for x in signals)
    assert tone.share == pytest.approx(0.5 * (2.0**2 + 1.0**2) * n / total, rel=0.15)
    # Standard error of an amplitude: sigma sqrt(2 / n) = 0.067 N; two digits are printed.
    assert [a for _, a in pairs_in(tone)] == pytest.approx([2.0, 1.0], abs=0.25)
    assert tones_in(*signals, share=tone.share) != []
    assert tones_in(*signals, share=1.01 * tone.share) == []


def test_amplitude_of_a_tone_is_that_of_the_residual_at_fitted_samples() -> None:
    n = 1000
    innovations = sine(n, 5.0, 2.0)
    residual = np.where(np.arange(n) < 500, 3.0, 1.0) * innovations
    (tone,) = tones_in(innovations + 1e-3, residuals=[residual], counted=[np.arange(n) >= 500])
    assert pairs_in(tone)[0] == pytest.approx((5.0, 2.0), abs=0.01)
    assert tone.share == 1.0


@pytest.mark.parametrize(("apart_hz", "tones"), [(0.1, 1), (0.3, 2)])
def test_tones_within_two_percent_are_reported_as_one(apart_hz: float, tones: int) -> None:
    n = 2000
    signals = [
        sine(n, f, amplitude) + 1e-3 * flat_spectrum(n, {}, seed)
        for seed, (f, amplitude) in enumerate(((5.0, 1.0), (5.0 + apart_hz, 2.0)))
    ]
    (found,) = tones_in(*signals)
    expected = [(5.0 + 0.5 * apart_hz, 1.5)] if tones == 1 else [(5.0, 1.0), (5.0 + apart_hz, 2.0)]
    assert np.array(pairs_in(found)) == pytest.approx(np.array(expected), abs=0.006)


def test_tone_is_reported_below_the_nyquist_frequency_with_a_bounded_amplitude() -> None:
    n = 1500
    signal = flat_spectrum(n, {n // 2 - 1: 4000.0})
    (tone,) = tones_in(signal)
    ((frequency_hz, amplitude),) = pairs_in(tone)
    assert frequency_hz < 0.5 / STEP_S
    assert amplitude < 3.0 * np.max(np.abs(signal))


@pytest.mark.parametrize(
    ("factor", "reported"), [(0.6, False), (0.8, True), (1.3, True), (2.0, False)]
)
def test_tone_that_changes_with_less_smoothing_is_not_reported(
    factor: float, reported: bool
) -> None:
    """The amplitude must be the same within a factor of 1.5; other noise does not matter."""
    campaign = campaign_of(1500)
    noise, other = white_noise(campaign, 1)[0], white_noise(campaign, 2)[0]
    tone = sine(1500, 6.3)
    found = find_tones(
        campaign.prepared,
        campaign.samples,
        [noise + tone],
        [noise + tone],
        DEFAULT,
        lambda: [other + factor * tone],
    )
    assert bool(found) == reported
