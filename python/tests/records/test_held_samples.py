"""Held samples: constant segments of the force, and repeated readings of a slow channel."""

from math import erf
from typing import Any

import numpy as np
import pytest
from jbf import Run
from jbf.records.findings.held_samples import find_held, held_mask
from jbf.records.findings.slow_channel import find_repeated
from known_motions import Array, places, quantised, reading_instants, reversing_force, white

SAMPLES = 2000
TIME_S: Any = 0.01 * np.arange(SAMPLES)
NOISE = white(SAMPLES, 1)
NOISY_SINE: Any = 10.0 * np.sin(0.7 * TIME_S) + 0.1 * NOISE
FAST_S: Any = 0.02 * np.arange(3000)


def repeating(values: Any, first: int, count: int) -> Array:
    """Values with `count` equal samples from `first` on."""
    changed: Array = np.array(values)
    changed[first + 1 : first + count] = changed[first]
    return changed


def test_five_equal_readings_in_noisy_data_are_held_samples_except_the_first() -> None:
    for count, expected in ((4, []), (5, [301, 302, 303, 304]), (9, list(range(301, 309)))):
        assert places(held_mask(repeating(NOISY_SINE, 300, count))) == expected


def test_equal_readings_are_held_samples_if_their_probability_is_below_1e_minus_6() -> None:
    """Half of the readings repeat: k equal ones have the probability 2000 / 2^(k-1) < 1e-6."""
    pairs = np.repeat(NOISE, np.where(np.arange(SAMPLES) % 2, 1, 2))[:SAMPLES]
    assert places(held_mask(repeating(pairs, 302, 30))) == []
    assert places(held_mask(repeating(pairs, 302, 31))) == list(range(303, 333))


def test_minimum_length_of_held_samples_depends_on_noise_and_quantisation() -> None:
    """Rounding to whole steps adds 1/12 to the variance of the noise. A reading in the middle of a
    step is repeated k times with probability p^k, which must be below 1e-6 in the record."""
    values = np.round(np.linspace(-50.0, 50.0, SAMPLES) + 0.5 * NOISE)
    noise = np.median(np.abs(np.diff(values, 3))) / 0.6745 / np.sqrt(20.0)
    p = erf(0.5 / np.sqrt(noise**2 - 1.0 / 12.0) / np.sqrt(2.0))
    longest = np.log(1e-6 / SAMPLES) / np.log(p)
    assert not held_mask(repeating(values, 300, int(longest) - 1)).any()
    assert held_mask(repeating(values, 300, int(longest) + 2)).any()


@pytest.mark.parametrize("over_noise", [1.5, 3.5, 6.0])
def test_equal_readings_of_a_coarsely_quantised_force_are_not_held(over_noise: float) -> None:
    force = quantised(reversing_force(TIME_S, 5), over_noise * 0.3)
    assert np.mean(np.diff(force) == 0.0) > 0.2
    assert not held_mask(force).any()
    assert not held_mask(1e-6 * force).any()


def test_held_samples_finding_has_the_longest_otherwise_unexplained_stretch() -> None:
    force = repeating(repeating(NOISY_SINE, 300, 6), 800, 21)
    run = Run.from_arrays(TIME_S, 0.1 + 0.0 * TIME_S, force, name="a")
    (finding,), mask = find_held(run, np.zeros(SAMPLES, dtype=bool))
    assert mask.sum() == 25
    assert finding.size == pytest.approx(0.2)
    assert (finding.kind, finding.channel, finding.unit) == ("held_samples", "friction_n", "s")
    (finding,), mask = find_held(run, np.arange(SAMPLES) > 500)
    assert (mask.sum(), finding.size) == (5, pytest.approx(0.05))
    no_findings, mask = find_held(run, np.ones(SAMPLES, dtype=bool))
    assert (no_findings, mask.any()) == ([], False)


def test_saturated_command_is_usable_but_constant_samples_of_a_noisy_force_are_held() -> None:
    command = np.clip(12.0 * np.sin(3.0 * TIME_S), -8.0, 8.0)
    assert held_mask(command).any()
    motion = 0.1 + 0.0 * TIME_S
    assert (
        find_held(Run.from_arrays(TIME_S, motion, command), np.zeros(SAMPLES, dtype=bool))[0] == []
    )
    frozen = np.where((TIME_S > 3.2) & (TIME_S < 3.4), command[320], command)
    (finding,), _ = find_held(
        Run.from_arrays(TIME_S, motion, frozen), np.zeros(SAMPLES, dtype=bool)
    )
    assert finding.size == pytest.approx(0.2, abs=0.03)
    noisy = command + np.random.default_rng(3).normal(0.0, 0.3, SAMPLES)
    noisy[300:340] = np.max(noisy)
    (finding,), _ = find_held(Run.from_arrays(TIME_S, motion, noisy), np.zeros(SAMPLES, dtype=bool))
    assert finding.size == pytest.approx(0.39, abs=0.02)


def recovered(ticks_s: Array, read: Array) -> tuple[Any, Array]:
    """Readings recovered from a record that holds each until the next, and their numbers."""
    native: Any = find_repeated(FAST_S, read[np.searchsorted(ticks_s, FAST_S, side="right") - 1])
    which = np.round((native.time_s - ticks_s[0]) / (ticks_s[1] - ticks_s[0])).astype(int)
    np.testing.assert_array_equal(native.values, read[which])
    return native, which


@pytest.mark.parametrize("rate_hz", [9.3, 31.7, 46.0])
def test_readings_of_a_slow_channel_and_their_instants_are_recovered(rate_hz: float) -> None:
    ticks_s = reading_instants(rate_hz, FAST_S)
    native, which = recovered(ticks_s, reversing_force(ticks_s, 6))
    assert 1.0 / native.period_s == pytest.approx(rate_hz, rel=1e-4)
    np.testing.assert_allclose(native.time_s, ticks_s[which], atol=0.25 * 0.02)


@pytest.mark.parametrize(("rate_hz", "step_n"), [(6.3, 2.5), (17.0, 0.8), (23.0, 2.5)])
def test_quantised_readings_of_a_slow_channel_are_recovered(rate_hz: float, step_n: float) -> None:
    """Consecutive equal readings are separated by the period of the channel."""
    ticks_s = reading_instants(rate_hz, FAST_S)
    read = quantised(1.7 * reversing_force(ticks_s, 6, 0.4), step_n)
    assert np.mean(np.diff(read) == 0.0) > 0.1
    native, which = recovered(ticks_s, read)
    assert 1.0 / native.period_s == pytest.approx(rate_hz, rel=3e-4)
    np.testing.assert_array_equal(np.diff(which), 1)


@pytest.mark.parametrize("step_n", [0.0, 0.05, 0.5, 2.0])
@pytest.mark.parametrize("omega", [0.02, 3.0])
def test_quantised_force_has_no_readings_of_a_slow_channel(step_n: float, omega: float) -> None:
    noise = white(len(FAST_S), 7, 0.3)
    for force in (20.0 * np.tanh(5.0 * np.sin(omega * FAST_S)) + noise, 0.3 * FAST_S + noise):
        assert find_repeated(FAST_S, quantised(force, step_n) if step_n else force) is None


def rows_of_clock(period: float, rows: int, *, skip: int = 0) -> tuple[Array, Array]:
    """Time and values of a channel with `rows` readings, one for each period (in samples); every
    `skip`-th reading equals the one before."""
    begins = np.ceil(0.3 + period * np.arange(rows + 1)).astype(int)
    values = white(rows + 1, 2)
    if skip:
        values[skip::skip] = values[skip - 1 : -1 : skip][: len(values[skip::skip])]
    samples = np.repeat(values, np.diff(np.append(begins, begins[-1] + 2)))
    return 0.01 * np.arange(len(samples)), samples


@pytest.mark.parametrize(("rows", "found"), [(39, False), (40, True)])
def test_slow_channel_is_recognised_from_forty_readings_on(rows: int, found: bool) -> None:
    assert (find_repeated(*rows_of_clock(2.7, rows)) is not None) == found


def test_slow_channel_is_recognised_only_with_even_stamps_and_constant_rate() -> None:
    time_s, values = rows_of_clock(2.7, 200)
    for error_s, found in ((0.5e-5, True), (2e-5, False)):
        uneven = time_s.copy()
        uneven[100] += error_s
        assert (find_repeated(uneven, values) is not None) == found
    random_rows = np.repeat(NOISE, 1 + (NOISE > 0.3) + 2 * (NOISE > 1.0))
    assert find_repeated(0.01 * np.arange(len(random_rows)), random_rows) is None
