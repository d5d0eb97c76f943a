"""A slow channel drawn as straight lines onto fast samples is taken back to its readings."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest
from jbf import Run
from jbf.estimation.campaign import Campaign
from jbf.estimation.prepared import Prepared
from jbf.records.findings.interpolated import Native, find_native, find_native_of
from jbf.records.findings.slow_channel import find_repeated
from jbf.records.rig import Rig
from scipy.signal import butter, filtfilt, lfilter

Array = npt.NDArray[np.float64]
TIME = 0.02 * np.arange(3000)


def force(time: Array, seed: int, sd: float = 0.3) -> Array:
    """Friction to and fro with noise of its own at each instant, N."""
    noise = sd * np.random.default_rng(seed).standard_normal(len(time))
    return 20.0 * np.tanh(50.0 * np.sin(0.3 * time)) + noise


@pytest.mark.parametrize("rate_hz", [20.0, 25.0, 31.7, 40.0, 41.5, 43.3, 46.9])
@pytest.mark.parametrize("seed", [1, 2])
def test_readings_are_recovered(rate_hz: float, seed: int) -> None:
    ticks = np.arange(-0.3 / rate_hz, TIME[-1] + 2.0 / rate_hz, 1.0 / rate_hz)
    read = force(ticks, seed)
    native = find_native(TIME, np.interp(TIME, ticks, read))
    assert native is not None
    assert 1.0 / native.period_s == pytest.approx(rate_hz, rel=1e-5)
    place = (native.time_s - ticks[0]) * rate_hz
    which = np.round(place).astype(int)
    np.testing.assert_allclose(place, which, atol=1e-3)
    # The first and the last may lie outside the record, where nothing tells of them.
    np.testing.assert_allclose(native.values[1:-1], read[which][1:-1], atol=0.02)
    assert len(native.time_s) > 0.98 * rate_hz * TIME[-1]


@pytest.mark.parametrize("rate_hz", [9.3, 17.0, 31.7, 46.0])
def test_readings_that_were_repeated_are_recovered(rate_hz: float) -> None:
    ticks = np.arange(-0.3 / rate_hz, TIME[-1] + 2.0 / rate_hz, 1.0 / rate_hz)
    read = force(ticks, 6)
    last = np.searchsorted(ticks, TIME, side="right") - 1
    native = find_repeated(TIME, read[last])
    assert native is not None
    assert 1.0 / native.period_s == pytest.approx(rate_hz, rel=1e-4)
    place = (native.time_s - ticks[0]) * rate_hz
    which = np.round(place).astype(int)
    np.testing.assert_array_equal(native.values, read[which])
    np.testing.assert_allclose(native.time_s, ticks[which], atol=0.25 * 0.02)


@pytest.mark.parametrize("rate_hz", [9.3, 17.0, 23.0])
def test_repeated_readings_at_an_end_of_the_range_are_recovered(rate_hz: float) -> None:
    """One reading after another at the end: which is which, the clock of all the others tells."""
    ticks = np.arange(-0.3 / rate_hz, TIME[-1] + 2.0 / rate_hz, 1.0 / rate_hz)
    read = np.clip(1.5 * force(ticks, 6), -np.inf, 30.0)
    assert np.mean(read == 30.0) > 0.1
    native = find_repeated(TIME, read[np.searchsorted(ticks, TIME, side="right") - 1])
    assert native is not None
    assert native.period_s == pytest.approx(1.0 / rate_hz, rel=1e-4)
    np.testing.assert_array_equal(native.values, read[1:][: len(native.values)])


@pytest.mark.parametrize("rate_hz", [6.3, 9.7, 17.0, 23.0])
@pytest.mark.parametrize("step_n", [0.8, 2.5])
def test_repeated_readings_in_coarse_steps_are_recovered(step_n: float, rate_hz: float) -> None:
    """Of two equal readings nothing tells the second, but the clock of all the others."""
    ticks = np.arange(-0.3 / rate_hz, TIME[-1] + 2.0 / rate_hz, 1.0 / rate_hz)
    read = step_n * np.round(1.7 * force(ticks, 6, 0.4) / step_n)
    assert np.mean(np.diff(read) == 0.0) > 0.1
    last = np.searchsorted(ticks, TIME, side="right") - 1
    native = find_repeated(TIME, read[last])
    assert native is not None
    assert 1.0 / native.period_s == pytest.approx(rate_hz, rel=3e-4)
    which = np.round((native.time_s - ticks[0]) * rate_hz).astype(int)
    np.testing.assert_array_equal(np.diff(which), 1)
    np.testing.assert_array_equal(native.values, read[which])
    np.testing.assert_allclose(native.time_s, ticks[which], atol=0.5 * 0.02)


@pytest.mark.parametrize("step_n", [0.0, 0.05, 0.5, 2.0])
@pytest.mark.parametrize("omega", [0.02, 0.3, 3.0])
def test_equal_readings_of_a_converter_are_not_repeated_ones(step_n: float, omega: float) -> None:
    noise = 0.3 * np.random.default_rng(7).standard_normal(len(TIME))
    for y in (20.0 * np.tanh(5.0 * np.sin(omega * TIME)) + noise, 0.3 * TIME + noise):
        assert find_repeated(TIME, np.round(y / step_n) * step_n if step_n else y) is None


@pytest.mark.parametrize("samples", [3.0, 5.0, 7.35, 14.94, 22.3])
def test_readings_are_not_those_of_a_multiple_of_their_rate(samples: float) -> None:
    step_s = 0.02 * samples
    ticks = np.arange(-0.3 * step_s, TIME[-1] + 2.0 * step_s, step_s)
    native = find_native(TIME, np.interp(TIME, ticks, force(ticks, 8)))
    assert native is not None
    assert native.period_s == pytest.approx(step_s, rel=1e-4)


def test_a_run_is_compared_at_its_readings() -> None:
    ticks = np.arange(0.0, TIME[-1] + 0.04, 0.04)
    v = 0.1 * np.sin(0.3 * TIME)
    run = Run.from_arrays(TIME, v, np.interp(TIME, ticks, force(ticks, 3)), name="slow")
    prepared = Prepared.of(Rig(), run)
    assert [f.kind for f in prepared.examined.findings] == ["interpolated"]
    assert prepared.step_s == pytest.approx(0.04, rel=1e-4)
    assert len(prepared.friction_n) == len(prepared.motion.velocity_m_s) == len(prepared.run)
    at = prepared.run.time_s
    np.testing.assert_allclose(prepared.motion.velocity_m_s, 0.1 * np.sin(0.3 * at), atol=1e-5)


@pytest.mark.parametrize("rate_hz", [13.76, 31.7])
@pytest.mark.parametrize("step_n", [0.5, 1.5, 0.0])
def test_readings_behind_lines_come_in_steps(step_n: float, rate_hz: float) -> None:
    """Known to the digits of the file, their levels are no more exactly one."""
    ticks = np.arange(-0.3 / rate_hz, TIME[-1] + 2.0 / rate_hz, 1.0 / rate_hz)
    read = 1.2 * force(ticks, 12)
    if step_n:
        read = step_n * np.round(read / step_n)
    drawn = np.round(np.interp(TIME, ticks, read), 4)
    run = Run.from_arrays(TIME, 0.1 * np.sin(0.3 * TIME), drawn, name="slow")
    found = Prepared.of(Rig(), run).examined.findings
    assert [f.kind for f in found if f.kind != "saturation"] == (
        ["interpolated", "steps"] if step_n else ["interpolated"]
    )
    assert [f.size for f in found if f.kind == "steps"] == (
        [pytest.approx(step_n, rel=1e-3)] if step_n else []
    )


def slope(time: Array, seed: int) -> Array:
    """A force that is at its ends for moments only, N."""
    noise = 0.3 * np.random.default_rng(seed).standard_normal(len(time))
    return 30.0 * np.sin(0.3 * time) + noise


def test_lines_between_readings_at_an_end_of_the_range_are_at_that_end() -> None:
    """Rounded to the digits of the file, corners are known a little worse than that."""
    ticks = np.arange(-0.01, TIME[-1] + 0.08, 1.0 / 25.35)
    read = np.clip(slope(ticks, 12), -28.0, 28.0)
    drawn = np.round(np.interp(TIME, ticks, read), 4)
    run = Run.from_arrays(TIME, 0.1 * np.sin(0.3 * TIME), drawn, name="slow")
    prepared = Prepared.of(Rig(), run)
    found = {f.kind: f for f in prepared.examined.findings}
    assert set(found) == {"interpolated", "saturation"}
    assert found["saturation"].size == 28.0
    at_end = np.abs(prepared.friction_n) == 28.0
    assert np.mean(at_end) == pytest.approx(np.mean(np.abs(read) == 28.0), abs=0.005)
    assert not np.any(prepared.examined.usable[at_end])


def test_a_run_that_is_at_an_end_of_its_range_nearly_throughout_has_no_steps() -> None:
    ticks = np.arange(-0.01, TIME[-1] + 0.08, 1.0 / 25.35)
    read = np.clip(1.5 * force(ticks, 12), -30.0, 30.0)
    drawn = np.round(np.interp(TIME, ticks, read), 4)
    run = Run.from_arrays(TIME, 0.1 * np.sin(0.3 * TIME), drawn, name="slow")
    prepared = Prepared.of(Rig(), run)
    assert {f.kind for f in prepared.examined.findings} == {"interpolated", "saturation"}
    assert np.mean(prepared.examined.usable) < 0.01


@pytest.mark.parametrize("first", [23.4, 25.3512756])
def test_a_run_that_does_not_tell_its_rate_takes_that_of_the_others(
    first: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """One logger reads all runs; one that has another rate, or none, keeps its own samples."""
    rates = {"a": 25.3512756, "b": first, "c": 25.3512756, "own": 50.0}
    runs, read = [], {}
    for i, (name, rate) in enumerate(rates.items()):
        ticks = np.arange(-0.003 * (i + 1), TIME[-1] + 2.0 / rate, 1.0 / rate)
        read[name] = force(TIME if name == "own" else ticks, 20 + i)
        lines = read[name] if name == "own" else np.interp(TIME, ticks, read[name])
        v = 0.1 * np.sin((0.3 + 0.01 * i) * TIME)
        runs.append(Run.from_arrays(TIME, v, lines, name=name))

    def told(time: Array, values: Array) -> Native | None:
        return None if np.array_equal(values, runs[1].friction_n) else find_native(time, values)

    monkeypatch.setattr("jbf.records.findings.examine.find_native", told)
    prepared = Campaign.prepare(Rig(), runs).prepared
    same = first == rates["a"]
    assert [p.drawn_at_hz > 0.0 for p in prepared] == [True, same, True, False]
    assert len(prepared[3].friction_n) == len(TIME)
    if same:
        steps = [p.step_s for p in prepared[:3]]
        np.testing.assert_allclose(steps, 1.0 / rates["a"], rtol=1e-5)
        np.testing.assert_allclose(
            prepared[1].friction_n[1:-1],
            read["b"][2:-2][: len(prepared[1].friction_n) - 2],
            atol=0.02,
        )


@pytest.mark.parametrize("rate_hz", [9.2, 30.4])
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_lines_that_stood_still_in_between_are_lines(seed: int, rate_hz: float) -> None:
    """A logger that repeats its last sample for a while, of a force drawn as lines before."""
    fine = 0.005 * np.arange(8000)
    ticks = np.arange(-0.3 / rate_hz, fine[-1] + 2.0 / rate_hz, 1.0 / rate_hz)
    drawn = np.round(np.interp(fine, ticks, force(ticks, seed)), 4)
    for first, count in ((1000, 40), (2500, 113), (6100, 60)):
        drawn[first : first + count] = drawn[first]
    run = Run.from_arrays(fine, 0.1 * np.sin(0.3 * fine), drawn, name="slow")
    prepared = Prepared.of(Rig(), run)
    found = {f.kind: f for f in prepared.examined.findings}
    assert {"interpolated", "held_samples"} <= set(found)
    assert found["interpolated"].size == pytest.approx(rate_hz, rel=1e-5)
    at = prepared.run.time_s
    which = np.round((at - ticks[0]) * rate_hz).astype(int)
    np.testing.assert_allclose(at, ticks[which], atol=1e-3 / rate_hz)
    # Beside a stretch that stood still a corner is told by few samples; within it by none.
    off = np.abs(prepared.friction_n - force(ticks, seed)[which])
    assert np.quantile(off, 0.95) < 2e-3
    assert not ((at > 12.5 + 1.0 / rate_hz) & (at < 13.06 - 1.0 / rate_hz)).any()


@pytest.mark.parametrize("rate_hz", [9.2, 17.0])
def test_coarse_steps_that_lie_flat_for_long_are_seen_where_they_bend(rate_hz: float) -> None:
    """A shaft at rest for most of a run: three looks may all see a straight line."""
    fine = 0.005 * np.arange(4000)
    ticks = np.arange(-0.3 / rate_hz, fine[-1] + 2.0 / rate_hz, 1.0 / rate_hz)
    moving = (ticks > 4.0) & (ticks < 7.0)
    noise = 0.2 * np.random.default_rng(4).standard_normal(len(ticks))
    read = np.where(moving, 12.0 * np.sin(2.1 * ticks), 0.3) + noise
    drawn = np.round(np.interp(fine, ticks, 1.5 * np.round(read / 1.5)), 4)
    native = find_native(fine, drawn)
    assert native is not None
    assert 1.0 / native.period_s == pytest.approx(rate_hz, rel=1e-5)


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("keep", [0.0, 0.95, 1.0])
def test_noise_of_any_memory_is_no_polygon(seed: int, keep: float) -> None:
    kicks = 0.1 * np.random.default_rng(seed).standard_normal(len(TIME))
    noise = lfilter([1.0], [1.0, -keep], kicks)
    assert find_native(TIME, noise) is None
    assert find_native(TIME, 20.0 * np.tanh(50.0 * np.sin(0.3 * TIME)) + noise) is None


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("cut", [0.15, 0.25, 0.4])
def test_a_record_behind_a_low_pass_is_no_polygon(seed: int, cut: float) -> None:
    random = np.random.default_rng(seed)
    force = 20.0 * np.sign(np.sin(3.0 * TIME)) + 0.3 * random.standard_normal(len(TIME))
    low = filtfilt(*butter(4, cut), force)
    assert find_native(TIME, low) is None
    assert find_native(TIME, np.round(low, 4)) is None


@pytest.mark.parametrize("omega", [0.02, 0.3, 3.0])
def test_smooth_and_rounded_records_are_no_polygons(omega: float) -> None:
    smooth = 20.0 * np.tanh(5.0 * np.sin(omega * TIME))
    assert find_native(TIME, smooth) is None
    noise = 0.3 * np.random.default_rng(4).standard_normal(len(TIME))
    for step in (0.05, 0.5, 2.0):
        assert find_native(TIME, step * np.round((smooth + noise) / step)) is None
        assert find_native(TIME, step * np.round(smooth / step)) is None


def test_a_motion_and_a_run_at_other_instants() -> None:
    from jbf.records.motion.imposed import impose

    v = 0.1 * np.sin(0.3 * TIME) * (TIME > 5.0)
    load = 100.0 + TIME
    run = Run.from_arrays(TIME, v, force(TIME, 5), load_n=load, extra={"x": 2.0 * TIME})
    at = np.array([1.003, 4.0, 20.007, 33.33, 59.9])
    moved = run.at(at, np.arange(5.0))
    np.testing.assert_allclose(moved.load_n, 100.0 + at)
    np.testing.assert_allclose(moved.extra["x"], 2.0 * at)
    np.testing.assert_array_equal(moved.friction_n, np.arange(5.0))
    motion = impose(run, None)
    there = motion.at(TIME, at)
    np.testing.assert_array_equal(there.resting, [True, True, False, False, False])
    np.testing.assert_allclose(there.velocity_m_s[:2], 0.0)
    np.testing.assert_allclose(there.velocity_m_s[2:], 0.1 * np.sin(0.3 * at[2:]), atol=1e-6)
    np.testing.assert_allclose(there.acceleration_m_s2[2:], 0.03 * np.cos(0.3 * at[2:]), atol=1e-4)
    # Half way between two samples on either side of a reversal nobody knows the sign.
    turn = np.pi * 3 / 0.3
    assert not motion.at(TIME, np.array([turn])).sign_known[0]


def test_a_slow_force_is_compared_with_all_of_a_fast_motion() -> None:
    """Between two readings the shaft sets out: the core is told when."""
    t = np.arange(0.0, 20.0, 0.005)
    v = np.where(t < 3.013, 0.0, 0.05 * np.sin(t - 3.013))
    slow = np.arange(0.0, 20.0, 0.05)
    read = 5.0 * np.sign(np.interp(slow, t, v)) + force(slow, 3)
    drawn = np.interp(t, slow, read)
    prepared = Prepared.of(Rig(), Run.from_arrays(t, v, drawn, name="a"))
    assert len(prepared.run) < 0.15 * len(t)
    core = prepared.core
    assert core.kept is not None
    assert len(core.motion) > 0.9 * len(t)
    at = np.asarray(core.motion.columns["time_s"])
    np.testing.assert_allclose(at[core.kept], prepared.run.time_s, rtol=1e-12)
    speed = np.asarray(core.motion.columns["velocity_m_s"])
    assert np.max(np.abs(np.interp(t, at, speed) - v)) < 1e-3


def test_a_known_rate_makes_no_lines_of_noise_nor_of_curves() -> None:
    for seed in range(5):
        assert find_native_of(TIME, force(TIME, seed), 1.0 / 25.35) is None
    assert find_native_of(TIME, 20.0 * np.sin(0.3 * TIME), 1.0 / 25.35) is None
    assert find_native_of(TIME, np.ones(len(TIME)), 1.0 / 25.35) is None
    assert find_native_of(TIME[:60], force(TIME[:60], 1), 1.0 / 25.35) is None
