"""Interpolated samples: a slow channel that was interpolated linearly, and single samples."""

from collections.abc import Iterable
from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np
import pytest
from jbf import Rig, Run
from jbf.estimation.campaign import Campaign
from jbf.estimation.prepared import Prepared
from jbf.records.findings.interpolated import find_native, find_native_of, is_smooth
from jbf.records.findings.interpolated_samples import find_interpolated_samples
from jbf.records.findings.polygon import polygon, polygon_rms
from known_motions import Array, quantised, reading_instants, reversing_force, white
from scipy.signal import butter, filtfilt, lfilter

TIME_S: Any = 0.02 * np.arange(3000)
SPEED_M_S: Any = 0.1 * np.sin(0.3 * TIME_S)
SHORT_S: Any = 0.02 * np.arange(600)
PERIOD_S, PHASE_S = 0.057, 0.013
CORNERS_S: Any = PHASE_S + PERIOD_S * np.arange(-1, 215)
READ: Any = 3.0 + 5.0 * np.sin(0.9 * CORNERS_S) + white(len(CORNERS_S), 1, 0.4)
DRAWN: Any = np.interp(SHORT_S, CORNERS_S, READ)


def extended(values: Iterable[Any]) -> list[Any]:
    """Parameters of tests in the extended suite."""
    sets = [value if isinstance(value, tuple) else (value,) for value in values]
    return [pytest.param(*values, marks=pytest.mark.extended) for values in sets]


def slow_run(drawn: Array) -> Run:
    return Run.from_arrays(TIME_S, SPEED_M_S, drawn, name="slow")


def least_squares_residual(period_s: float, phase_s: float) -> float:
    """RMS residual per degree of freedom of the best polygon, by dense least squares."""
    place = (SHORT_S - SHORT_S[0] - phase_s) / period_s
    low = np.floor(place).astype(int)
    share = place - low
    low -= low[0]
    design = np.zeros((len(SHORT_S), low[-1] + 2))
    design[np.arange(len(SHORT_S)), low] = 1.0 - share
    design[np.arange(len(SHORT_S)), low + 1] += share
    design = design[:, (design > 1e-3).any(axis=0)]
    solution, *_ = np.linalg.lstsq(design, DRAWN, rcond=None)
    residual = DRAWN - design @ solution
    return float(np.sqrt(np.sum(residual**2) / (len(SHORT_S) - design.shape[1])))


def test_polygon_residual_equals_that_of_dense_least_squares_for_any_period() -> None:
    guesses = [(0.057, 0.03), (0.08, 0.0), (0.11, 0.05), (1.3, 0.4)]
    expected = [least_squares_residual(*guess) for guess in guesses]
    residuals = [polygon(SHORT_S, DRAWN, *guess)[0] for guess in guesses]
    np.testing.assert_allclose(residuals, expected, rtol=1e-4)
    of_many = polygon_rms(SHORT_S, DRAWN, *np.array(guesses * 20).T)
    np.testing.assert_allclose(of_many, expected * 20, rtol=1e-4)


def test_polygon_with_the_true_period_and_phase_recovers_the_readings() -> None:
    residual, knots, corners = polygon(SHORT_S, DRAWN, PERIOD_S, PHASE_S)
    assert residual < 1e-6
    np.testing.assert_allclose(np.diff(knots), PERIOD_S)
    assert knots[0] <= SHORT_S[0] < SHORT_S[-1] <= knots[-1]
    inside = (knots > SHORT_S[0]) & (knots < SHORT_S[-1])
    expected = np.interp(knots[inside], CORNERS_S, READ)
    np.testing.assert_allclose(corners[inside], expected, atol=1e-5)
    np.testing.assert_allclose(polygon(SHORT_S + 100.0, DRAWN, PERIOD_S, PHASE_S)[1], knots + 100.0)


def test_signal_is_smooth_if_third_differences_are_small_relative_to_second() -> None:
    """The ratio of third to second differences of a sine is 2 sin(omega / 2)."""
    wave, ratio = np.sin(0.7 * np.arange(4000)), 2.0 * np.sin(0.35)
    assert is_smooth(wave, 1.04 * ratio)
    assert not is_smooth(wave, 0.96 * ratio)
    assert not is_smooth(white(400, 1))


@pytest.mark.parametrize(
    "rate_hz", [2.24, 6.8, 20.0, 31.7, 46.9, *extended([3.35, 10.0, 25.0, 41.5, 43.3])]
)
def test_readings_of_a_linearly_interpolated_force_are_recovered(rate_hz: float) -> None:
    """One reading in 22 samples to nearly one per sample; multiples of the rate would also fit."""
    ticks_s = reading_instants(rate_hz, TIME_S)
    read = reversing_force(ticks_s, 1)
    native: Any = find_native(TIME_S, np.interp(TIME_S, ticks_s, read))
    assert 1.0 / native.period_s == pytest.approx(rate_hz, rel=1e-5)
    which = np.round((native.time_s - ticks_s[0]) * rate_hz).astype(int)
    np.testing.assert_allclose(native.time_s, ticks_s[which], atol=1e-3 / rate_hz)
    # The first and the last reading may lie outside the record.
    np.testing.assert_allclose(native.values[1:-1], read[which][1:-1], atol=0.02)
    assert len(native.time_s) > 0.97 * rate_hz * TIME_S[-1]


@pytest.mark.parametrize(("step_n", "rate_hz"), [(0.5, 31.7), (1.5, 13.76), (0.0, 13.76)])
def test_quantisation_of_an_interpolated_force_is_recovered(step_n: float, rate_hz: float) -> None:
    ticks_s = reading_instants(rate_hz, TIME_S)
    read = 1.2 * reversing_force(ticks_s, 12)
    read = quantised(read, step_n) if step_n else read
    run = slow_run(np.round(np.interp(TIME_S, ticks_s, read), 4))
    findings = Prepared.of(Rig(), run).examined.findings
    steps = [f.size for f in findings if f.kind == "steps"]
    assert {f.kind for f in findings} - {"steps", "saturation"} == {"interpolated"}
    assert steps == ([pytest.approx(step_n, rel=1e-3)] if step_n else [])


def test_saturated_readings_of_a_linearly_interpolated_force_are_not_usable() -> None:
    ticks_s = np.arange(-0.01, TIME_S[-1] + 0.08, 1.0 / 25.35)
    read = np.clip(30.0 * np.sin(0.3 * ticks_s) + white(len(ticks_s), 12, 0.3), -28.0, 28.0)
    prepared = Prepared.of(Rig(), slow_run(np.round(np.interp(TIME_S, ticks_s, read), 4)))
    sizes = {f.kind: f.size for f in prepared.examined.findings}
    assert sizes == {"interpolated": pytest.approx(25.35, rel=1e-4), "saturation": 28.0}
    at_end = np.abs(prepared.friction) == 28.0
    assert np.mean(at_end) == pytest.approx(np.mean(np.abs(read) == 28.0), abs=0.005)
    assert not np.any(prepared.examined.usable[at_end])


@pytest.mark.parametrize("rate_hz", [9.2, *extended([30.4])])
def test_interpolated_readings_are_recovered_if_parts_of_the_force_are_held(rate_hz: float) -> None:
    fine_s = 0.005 * np.arange(4000)
    ticks_s = reading_instants(rate_hz, fine_s)
    read = reversing_force(ticks_s, 1)
    drawn = np.round(np.interp(fine_s, ticks_s, read), 4)
    for first, count in ((1000, 40), (2500, 113), (3400, 60)):
        drawn[first : first + count] = drawn[first]
    prepared = Prepared.of(Rig(), Run.from_arrays(fine_s, 0.1 * np.sin(0.3 * fine_s), drawn))
    sizes = {f.kind: f.size for f in prepared.examined.findings}
    assert {"interpolated", "held_samples"} <= set(sizes)
    assert sizes["interpolated"] == pytest.approx(rate_hz, rel=1e-5)
    at_s = prepared.run.time_s
    which = np.round((at_s - ticks_s[0]) * rate_hz).astype(int)
    np.testing.assert_allclose(at_s, ticks_s[which], atol=1e-3 / rate_hz)
    assert np.quantile(np.abs(prepared.friction - read[which]), 0.95) < 2e-3
    # A held segment contains no reading.
    assert not ((at_s > 12.5 + 1.0 / rate_hz) & (at_s < 13.06 - 1.0 / rate_hz)).any()


@pytest.mark.parametrize("rate_hz", [*extended([9.2]), 17.0])
def test_reading_rate_is_recovered_if_the_force_is_mainly_constant(rate_hz: float) -> None:
    fine_s = 0.005 * np.arange(4000)
    ticks_s = reading_instants(rate_hz, fine_s)
    moving = (ticks_s > 4.0) & (ticks_s < 7.0)
    read = np.where(moving, 12.0 * np.sin(2.1 * ticks_s), 0.3) + white(len(ticks_s), 4, 0.2)
    drawn = np.round(np.interp(fine_s, ticks_s, quantised(read, 1.5)), 4)
    native: Any = find_native(fine_s, drawn)
    assert 1.0 / native.period_s == pytest.approx(rate_hz, rel=1e-5)


def test_interpolated_force_and_motion_are_taken_at_the_reading_instants() -> None:
    ticks_s = np.arange(0.0, TIME_S[-1] + 0.04, 0.04)
    run = slow_run(np.interp(TIME_S, ticks_s, reversing_force(ticks_s, 3)))
    prepared = Prepared.of(Rig(), run)
    (finding,) = prepared.examined.findings
    assert (finding.kind, finding.unit) == ("interpolated", "Hz")
    assert finding.size == pytest.approx(25.0, rel=1e-4)
    assert prepared.step_s == pytest.approx(0.04, rel=1e-4)
    assert len(prepared.friction) == len(prepared.motion.velocity) == len(prepared.run)
    expected = 0.1 * np.sin(0.3 * prepared.run.time_s)
    np.testing.assert_allclose(prepared.motion.velocity, expected, atol=1e-5)


def test_model_of_an_interpolated_force_is_driven_by_all_samples_of_the_motion() -> None:
    """The motion has a rate of 200 Hz, the force of 20 Hz."""
    time_s = np.arange(0.0, 20.0, 0.005)
    speed = np.where(time_s < 3.013, 0.0, 0.05 * np.sin(time_s - 3.013))
    slow_s = np.arange(0.0, 20.0, 0.05)
    read = 5.0 * np.sign(np.interp(slow_s, time_s, speed)) + reversing_force(slow_s, 3)
    run = Run.from_arrays(time_s, speed, np.interp(time_s, slow_s, read))
    core = Prepared.of(Rig(), run).core
    assert len(core.motion) > 0.9 * len(time_s)
    at_s, speed_at = (np.asarray(core.motion.columns[c]) for c in ("time_s", "velocity_m_s"))
    assert np.max(np.abs(np.interp(time_s, at_s, speed_at) - speed)) < 1e-3


def test_interpolated_readings_of_a_known_period_are_recovered() -> None:
    ticks_s = reading_instants(25.35, TIME_S)
    drawn = np.interp(TIME_S, ticks_s, reversing_force(ticks_s, 1))
    native: Any = find_native_of(TIME_S, drawn, 1.0 / 25.35)
    assert native.period_s == pytest.approx(1.0 / 25.35, rel=1e-5)


def test_force_that_was_not_interpolated_has_no_readings_of_a_known_period() -> None:
    period_s = 1.0 / 25.35
    for own in (reversing_force(TIME_S, 2), 20.0 * np.sin(0.3 * TIME_S), np.ones(len(TIME_S))):
        assert find_native_of(TIME_S, own, period_s) is None
    assert find_native_of(TIME_S[:60], reversing_force(TIME_S[:60], 1), period_s) is None


def test_short_run_takes_the_reading_rate_of_a_longer_run() -> None:
    # Nearly every sample is a reading: 400 samples are insufficient for an estimate of the rate.
    period_s = 1.083 * 0.02
    ticks_s = 0.4 * 0.02 + period_s * np.arange(-1, 600)
    read = 3.0 + 5.0 * np.sin(0.9 * ticks_s) + white(601, 1, 0.4)
    t, force = TIME_S[:600], np.interp(TIME_S[:600], ticks_s, read)
    long = Run.from_arrays(t, 0.1 * np.sin(0.9 * t), force, name="long")
    runs = [long, replace(long.select(slice(400)), name="short")]
    assert Prepared.of(Rig(), runs[1]).drawn_at_hz == 0.0
    rates_hz = [run.drawn_at_hz for run in Campaign.prepare(Rig(), runs).prepared]
    assert rates_hz == pytest.approx([1.0 / period_s] * 2, rel=1e-4)


@pytest.mark.parametrize("memory", [0.0, 0.95, 1.0])
@pytest.mark.parametrize("seed", [0, *extended(range(1, 6))])
def test_force_with_coloured_noise_has_no_interpolated_readings(memory: float, seed: int) -> None:
    noise = lfilter([1.0], [1.0, -memory], white(len(TIME_S), seed, 0.1))
    assert find_native(TIME_S, noise) is None
    assert find_native(TIME_S, 20.0 * np.tanh(50.0 * np.sin(0.3 * TIME_S)) + noise) is None


@pytest.mark.parametrize(
    ("seed", "cut"), [(0, 0.25), *extended(product(range(1, 4), (0.15, 0.25, 0.4)))]
)
def test_low_pass_filtered_force_has_no_interpolated_readings(seed: int, cut: float) -> None:
    force = 20.0 * np.sign(np.sin(3.0 * TIME_S)) + white(len(TIME_S), seed, 0.3)
    filtered = filtfilt(*butter(4, cut), force)
    assert find_native(TIME_S, filtered) is None
    assert find_native(TIME_S, np.round(filtered, 4)) is None


@pytest.mark.parametrize("omega", [*extended([0.02, 0.3]), 3.0])
def test_smooth_linear_and_quantised_forces_have_no_interpolated_readings(omega: float) -> None:
    smooth = 20.0 * np.tanh(5.0 * np.sin(omega * TIME_S))
    noise = white(len(TIME_S), 4, 0.3)
    records = [smooth, TIME_S, *(quantised(smooth + noise, step) for step in (0.05, 2.0))]
    records += [quantised(smooth, step) for step in (0.05, 2.0)]
    assert [find_native(TIME_S, record) for record in records] == [None] * len(records)


@pytest.mark.parametrize("noise", [0.05, 3.0, *extended([0.2, 0.5, 1.0, 20.0])])
@pytest.mark.parametrize("rate_hz", [500.0, 1003.7, *extended([200.0, 2000.0, 5000.0])])
@pytest.mark.parametrize("stamps", ["microseconds", "uneven"])
def test_quantised_force_of_a_smooth_drive_has_no_interpolated_samples(
    noise: float, rate_hz: float, stamps: str
) -> None:
    """A converter produces equal readings and equal increments; time stamps are also rounded."""
    step_n, random = 0.1 / 7.0, np.random.default_rng(int(rate_hz))
    time_s: Any = np.arange(8000) / rate_hz
    if stamps == "uneven":
        time_s = time_s + 1e-3 / rate_hz * random.uniform(-1.0, 1.0, len(time_s))
    else:
        time_s = np.round(time_s, 6)
    speed = np.sin(4.0 * time_s) + 0.5 * np.sin(9.2 * time_s + 1.0)
    filtered = np.convolve(random.standard_normal(len(time_s)), np.full(4, 0.5), "same")
    force = 2.0 * np.tanh(speed / 0.01) + 1.1 * speed + noise * step_n * filtered
    read = np.round(quantised(force, step_n), 5)
    assert find_native(time_s, read) is None
    assert find_interpolated_samples(time_s, read) is None


@pytest.mark.parametrize("ratio", [5, 10])
@pytest.mark.parametrize("digits", [4, 15])
def test_force_read_at_uneven_instants_and_interpolated_has_samples_on_lines(
    ratio: int, digits: int
) -> None:
    random = np.random.default_rng(ratio)
    ticks_s = 0.02 * (np.cumsum(random.uniform(0.5, 1.5, 3000 // ratio + 200)) * ratio - 3 * ratio)
    drawn = np.interp(TIME_S, ticks_s, reversing_force(ticks_s, 3))
    native: Any = find_interpolated_samples(TIME_S, np.round(drawn, digits))
    # The samples on both sides of a reading are kept.
    assert len(native.time_s) == pytest.approx(2 * len(TIME_S) / ratio, rel=0.1)


@pytest.mark.parametrize("uneven", [False, True])
def test_single_interpolated_samples_are_removed_from_a_noisy_force(uneven: bool) -> None:
    random = np.random.default_rng(3)
    time_s = np.sort(random.uniform(0.0, 60.0, 3000)) if uneven else TIME_S
    lost = random.random(len(time_s)) < 0.05
    lost[[0, -1]] = False
    force = reversing_force(time_s, 3)
    native: Any = find_interpolated_samples(time_s, np.interp(time_s, time_s[~lost], force[~lost]))
    np.testing.assert_array_equal(native.time_s, time_s[~lost])
    np.testing.assert_array_equal(native.values, force[~lost])


def test_share_of_single_interpolated_samples_is_reported_in_percent() -> None:
    lost = np.arange(len(TIME_S)) % 5 == 2
    force = np.interp(TIME_S, TIME_S[~lost], reversing_force(TIME_S, 3)[~lost])
    prepared = Prepared.of(Rig(), slow_run(force))
    (finding,) = prepared.examined.findings
    assert (finding.kind, finding.unit, finding.size) == ("interpolated", "%", pytest.approx(20.0))
    assert len(prepared.friction) == 2400


@pytest.mark.parametrize("step_n", [0.0, 1e-4, 0.0137, 0.1, 0.31, 1.7])
def test_quantised_noise_has_no_single_interpolated_samples(step_n: float) -> None:
    for force in (reversing_force(TIME_S, 0), 0.3 * TIME_S + reversing_force(TIME_S, 0, 0.1)):
        for digits in (3, 4, 15):
            value = quantised(force, step_n) if step_n else force
            assert find_interpolated_samples(TIME_S, np.round(value, digits)) is None


@pytest.mark.parametrize("omega", [*extended([0.02, 0.3]), 3.0])
def test_smooth_linear_and_held_forces_have_no_single_interpolated_samples(omega: float) -> None:
    triangle = np.abs(np.mod(omega * TIME_S, 2.0) - 1.0)
    noise = white(len(TIME_S), 5, 0.3)
    smooth = 20.0 * np.tanh(5.0 * np.sin(omega * TIME_S))
    half = np.interp(TIME_S, TIME_S[::2], np.sin(omega * TIME_S[::2]))
    low = filtfilt(*butter(4, 0.2), 20.0 * np.sign(np.sin(omega * TIME_S)) + noise)
    records = [smooth, triangle, np.sign(triangle - 0.5), half, low, np.repeat(noise[::3], 3)]
    for record in (*records, np.zeros(len(TIME_S)), TIME_S):
        assert find_interpolated_samples(TIME_S, record) is None
        assert find_interpolated_samples(TIME_S, np.round(record, 4)) is None
