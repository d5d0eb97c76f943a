"""What is found in the records of a motion, and what the motion is taken from then."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest
from jbf import Run
from jbf.records.findings.finding import Finding
from jbf.records.motion.imposed import ImposedMotion, impose
from scipy.signal import butter, sosfilt

Array = npt.NDArray[np.float64]
RADIUS_M = 0.0127
COUNT_RAD = 2.0 * np.pi / 15000.0
TACHOMETER_M_S = 1e-4
STEP_S = 0.02
TIME = STEP_S * np.arange(3000)
MOTIONS = ("slow", "usual", "fast", "triangle", "stops")


def true(motion: str = "usual", time: Array = TIME) -> tuple[Array, Array]:
    """Speed, m/s, and path, m, of a motion."""
    if motion in ("slow", "usual", "fast"):
        omega = {"slow": 0.05, "usual": 0.4, "fast": 4.0}[motion]
        return 0.1 * np.sin(omega * time + 0.3), -0.1 / omega * np.cos(omega * time + 0.3)
    fine = np.arange(0.0, 62.0, 1e-4)
    phase = np.mod(fine, 8.0)
    up = 1.0 - np.abs(phase / 4.0 - 1.0)
    v = 0.1 * (2.0 * up - 1.0)
    if motion == "stops":
        way = np.where(np.mod(fine, 16.0) < 8.0, 1.0, -1.0)
        v = 0.08 * way * np.clip(np.minimum(phase - 1.003, 6.007 - phase), 0.0, 1.0)
    x = np.concatenate(([0.0], np.cumsum(0.5 * (v[1:] + v[:-1]) * 1e-4)))
    return np.interp(time, fine, v), np.interp(time, fine, x)


def counted(path: Array, count_rad: float = COUNT_RAD) -> Array:
    return np.round(path / RADIUS_M / count_rad) * count_rad


def measured(speed: Array, seed: int = 0, sd: float = TACHOMETER_M_S) -> Array:
    noise = sd * np.random.default_rng(seed).standard_normal(len(speed))
    return np.where(speed == 0.0, 0.0, speed + noise)


def imposed(speed: Array, angle: Array | None, time: Array = TIME) -> ImposedMotion:
    return impose(Run.from_arrays(time, speed, angle_rad=angle), RADIUS_M)


def only(m: ImposedMotion) -> Finding:
    """The one finding."""
    assert len(m.findings) == 1, m.findings
    return m.findings[0]


def error(m: ImposedMotion, speed: Array) -> float:
    """RMS of the speed's error, m/s."""
    return float(np.sqrt(np.mean((m.velocity_m_s - speed)[10:-10] ** 2)))


# ---- nothing to be found -------------------------------------------------------------------------


@pytest.mark.parametrize("motion", MOTIONS)
@pytest.mark.parametrize("sd", [0.0, 1e-5, TACHOMETER_M_S, 2e-3])
@pytest.mark.parametrize("count_rad", [1e-9, COUNT_RAD, 10.0 * COUNT_RAD])
def test_nothing_in_a_clean_motion(motion: str, sd: float, count_rad: float) -> None:
    v, x = true(motion)
    assert imposed(measured(v, 1, sd), counted(x, count_rad)).findings == ()


@pytest.mark.parametrize("motion", MOTIONS)
@pytest.mark.parametrize("sd", [0.0, 1e-5, 2e-3])
def test_nothing_where_rows_are_missing(motion: str, sd: float) -> None:
    v, x = true(motion)
    there = np.random.default_rng(8).permutation(len(TIME))[: int(0.9 * len(TIME))]
    there.sort()
    m = imposed(measured(v, 1, sd)[there], counted(x)[there], TIME[there])
    assert "glitches" not in {f.kind for f in m.findings}


@pytest.mark.parametrize("motion", MOTIONS)
@pytest.mark.parametrize("sd", [0.0, 1e-5, 2e-3])
def test_nothing_in_a_speed_alone(motion: str, sd: float) -> None:
    assert imposed(measured(true(motion)[0], 2, sd), None).findings == ()


@pytest.mark.parametrize("motion", ["usual", "stops"])
def test_nothing_in_a_noisy_path(motion: str) -> None:
    v, x = true(motion)
    noisy = x / RADIUS_M + 3e-4 * np.random.default_rng(3).standard_normal(len(x))
    assert imposed(measured(v), noisy).findings == ()


# ---- glitches ------------------------------------------------------------------------------------


@pytest.mark.parametrize("motion", MOTIONS)
@pytest.mark.parametrize("off_rad", [0.01, 0.1, 1.0])
def test_a_glitch_of_the_path_is_left_out(motion: str, off_rad: float) -> None:
    v, x = true(motion)
    speed, angle = measured(v, 4), counted(x)
    before = imposed(speed, angle)
    spoilt = angle.copy()
    at = [333, 1500, 1620, 2222]
    spoilt[at] += off_rad * np.array([1.0, -1.0, -1.0, 1.0])
    m = imposed(speed, spoilt)
    found = only(m)
    assert (found.kind, found.channel, found.unit) == ("glitches", "angle_rad", "rad")
    assert found.size == pytest.approx(off_rad, abs=3.0 * COUNT_RAD)
    assert found.words.startswith("4 single samples")
    assert "6.66 s" in found.words
    assert error(m, v) < 1.1 * error(before, v) + 1e-6
    assert np.count_nonzero(np.diff(np.sign(m.velocity_m_s[m.sign_known]))) == np.count_nonzero(
        np.diff(np.sign(before.velocity_m_s[before.sign_known]))
    )


@pytest.mark.parametrize("motion", MOTIONS)
def test_of_two_glitches_side_by_side_both_are_left_out(motion: str) -> None:
    """Seen from a larger one the smaller is single; where both are alike neither stands alone."""
    v, x = true(motion)
    speed, angle = measured(v, 4), counted(x)
    before = imposed(speed, angle)
    angle = angle.copy()
    angle[[700, 701, 2001, 2002]] += [0.5, -0.2, 0.2, -0.5]
    m = imposed(speed, angle)
    found = only(m)
    assert found.kind == "glitches"
    assert found.words.startswith("4 single samples")
    assert error(m, v) < 1.1 * error(before, v) + 1e-6


@pytest.mark.parametrize("motion", MOTIONS)
@pytest.mark.parametrize("at", [999, 1002])
@pytest.mark.parametrize("missing", [1, 2])
def test_a_glitch_beside_missing_rows_is_left_out(motion: str, at: int, missing: int) -> None:
    there = np.delete(np.arange(len(TIME)), np.arange(1000, 1000 + missing))
    time, at = TIME[there], at if at < 1000 else 1000
    v, x = true(motion)
    speed, angle = measured(v, 4)[there], counted(x)[there]
    before = imposed(speed, angle, time)
    spoilt = angle.copy()
    spoilt[at] -= 0.9
    m = imposed(speed, spoilt, time)
    (found,) = (f for f in m.findings if f.kind == "glitches")
    assert found.words.startswith("1 single sample of")
    assert f"{time[at]:.2f} s" in found.words
    assert error(m, v[there]) < 1.1 * error(before, v[there]) + 1e-6


@pytest.mark.parametrize("with_path", [True, False])
@pytest.mark.parametrize("off", [0.01, 0.1])
def test_a_glitch_of_the_speed_is_left_out(with_path: bool, off: float) -> None:
    v, x = true()
    speed = measured(v, 5)
    speed[[800, 2100]] += [off, -off]
    m = imposed(speed, counted(x) if with_path else None)
    found = only(m)
    assert (found.kind, found.channel) == ("glitches", "velocity_m_s")
    assert found.size == pytest.approx(off, rel=0.1)
    assert abs(m.velocity_m_s[800] - v[800]) < 3e-4


@pytest.mark.parametrize("with_path", [True, False])
def test_many_glitches_of_a_speed_are_believed_where_a_path_denies_them(with_path: bool) -> None:
    """One sample in a hundred: alone that many may be the motion's own."""
    v, x = true()
    speed = measured(v, 5)
    speed[50 : len(v) - 50 : 100] += 0.05
    found = imposed(speed, counted(x) if with_path else None).findings
    assert ("glitches" in {f.kind for f in found}) == with_path


def test_a_slip_that_the_path_confirms_is_no_glitch() -> None:
    v, _ = true()
    v = v.copy()
    v[[800, 1900]] += 0.05
    x = np.concatenate(([0.0], np.cumsum(0.5 * (v[1:] + v[:-1]) * STEP_S)))
    assert imposed(measured(v, 6), counted(x)).findings == ()


@pytest.mark.parametrize("motion", ["usual", "fast"])
@pytest.mark.parametrize("sd", [1e-5, TACHOMETER_M_S])
def test_a_speed_that_the_path_denies_is_not_believed_there(motion: str, sd: float) -> None:
    """Too long for a glitch: a tenth of a second at half the speed, or beside it."""
    v, x = true(motion)
    for spoilt in (0.5 * v[1000:1006], v[1000:1006] + 0.05):
        speed = measured(v, 6, sd)
        speed[1000:1006] = spoilt
        m = imposed(speed, counted(x))
        assert np.max(np.abs(m.velocity_m_s - v)[990:1016]) < 5e-4


# ---- a speed that is late ------------------------------------------------------------------------


@pytest.mark.parametrize("motion", ["usual", "fast", "triangle", "stops"])
@pytest.mark.parametrize("cut_hz", [12.0, 5.0, 2.5])
def test_a_filtered_speed_is_left_aside(motion: str, cut_hz: float) -> None:
    fine = np.arange(0.0, TIME[-1] + 1e-3, 1e-3)
    v, x = true(motion)
    sections = butter(2, cut_hz, fs=1000.0, output="sos")
    late = np.interp(TIME, fine, sosfilt(sections, true(motion, fine)[0]))
    m = imposed(late, counted(x))
    found = only(m)
    assert (found.kind, found.unit) == ("filtered_speed", "s")
    # A second-order Butterworth filter is late by the root of two over its angular frequency.
    assert found.size == pytest.approx(np.sqrt(2.0) / (2.0 * np.pi * cut_hz), rel=0.15)
    assert error(m, v) < 0.5 * float(np.sqrt(np.mean((late - v) ** 2)))


@pytest.mark.parametrize("share", [0.3, 1.0, 3.0])
def test_a_late_speed_is_as_late_as_it_is(share: float) -> None:
    late_s = share * STEP_S
    m = imposed(measured(true("usual", TIME - late_s)[0], 7, 1e-5), counted(true()[1]))
    assert only(m).size == pytest.approx(late_s, rel=0.15)
    # One that is late by less than a sample has lost nothing else.
    assert only(m).kind == ("late_speed" if share < 0.4 else "filtered_speed")
    assert error(m, true()[0]) < (5e-5 if share < 0.4 else 2e-4)


# ---- a speed made of the path --------------------------------------------------------------------


@pytest.mark.parametrize("counts", [36000, 10000, 4000])
@pytest.mark.parametrize(("before", "after"), [(1, 0), (3, 0), (3, 2), (2, 2), (5, 4)])
def test_a_difference_of_counts_is_left_aside(counts: int, before: int, after: int) -> None:
    v, x = true("fast")
    angle = counted(x, 2.0 * np.pi / counts)
    at = np.arange(len(angle))
    low, high = np.maximum(at - before, 0), np.minimum(at + after, len(angle) - 1)
    high = np.maximum(high, low + 1)
    speed = (angle[high] - angle[low]) * RADIUS_M / (TIME[high] - TIME[low])
    m = imposed(speed, angle)
    found = only(m)
    assert found.kind == "coarse_speed"
    assert found.size == before + after
    late_s = 0.5 * (before - after) * STEP_S
    assert ("late" in found.words) == (late_s > 0.0)
    assert error(m, v) < 0.6 * float(np.sqrt(np.mean((speed - v)[10:-10] ** 2)))


# ---- units and signs -----------------------------------------------------------------------------


@pytest.mark.parametrize("motion", ["slow", "usual", "stops"])
@pytest.mark.parametrize(
    ("factor", "said"),
    [(1e3, "in mm"), (1e2, "in cm"), (-1e3, "the other way"), (7.7, "times as fast")],
)
def test_a_position_in_another_unit_is_converted(motion: str, factor: float, said: str) -> None:
    v, x = true(motion)
    m = impose(Run.from_arrays(TIME, measured(v), position_m=factor * np.round(x, 6)), None)
    found = only(m)
    assert (found.kind, found.channel) == ("units", "position_m")
    assert found.size == pytest.approx(factor, rel=0.02)
    assert said in found.words
    assert found.done.startswith("divided by ")
    # Once converted it tells as much as one in metres.
    assert error(m, v) < 0.5 * TACHOMETER_M_S


@pytest.mark.parametrize(("factor", "unit"), [(180.0 / np.pi, "degrees"), (0.5 / np.pi, "turns")])
def test_an_angle_in_another_unit_is_converted(factor: float, unit: str) -> None:
    v, x = true()
    # Slow enough for degrees not to jump by half a turn of radians between samples.
    v, x = 0.1 * v, 0.1 * x
    found = only(imposed(measured(v, 8, 1e-5), factor * counted(x)))
    assert (found.kind, found.channel) == ("units", "angle_rad")
    assert unit in found.words


@pytest.mark.parametrize(
    ("factor", "unit"),
    [
        (1e3, "mm/s"),
        (60.0, "m/min"),
        (1.0 / RADIUS_M, "rad/s"),
        (30.0 / np.pi / RADIUS_M, "minute"),
    ],
)
def test_a_speed_in_another_unit_is_converted(factor: float, unit: str) -> None:
    v, x = true()
    m = imposed(factor * measured(v), counted(x))
    found = only(m)
    assert (found.kind, found.channel) == ("units", "velocity_m_s")
    assert unit in found.words
    assert error(m, v) < 1e-3


def test_a_path_with_its_sign_turned_is_turned() -> None:
    v, x = true("triangle")
    m = imposed(measured(v), -counted(x))
    assert only(m).kind == "sign"
    assert error(m, v) < 2.0 * TACHOMETER_M_S
    assert m.angle_rad[-1] * RADIUS_M == pytest.approx(x[-1] - x[0], abs=1e-4)


@pytest.mark.parametrize("radius_m", [1.0, 0.31, RADIUS_M])
def test_an_angle_without_a_radius_tells_the_motion_by_its_speed(radius_m: float) -> None:
    """The way for a radian is what the speed says, and nothing is a contradiction."""
    v, x = true()
    angle = np.round(x / radius_m, 5)
    m = impose(Run.from_arrays(TIME, measured(v), angle_rad=angle), None)
    assert m.findings == ()
    assert error(m, v) < 0.5 * TACHOMETER_M_S
    assert np.max(np.abs(np.diff(m.angle_rad - angle))) < 1e-4
    # An angle that is another shaft's tells nothing of this one.
    other = impose(Run.from_arrays(TIME, measured(v), angle_rad=np.sin(3.0 * TIME)), None)
    assert other.angle_rad == pytest.approx(np.sin(3.0 * TIME))
    assert error(other, v) < 1.5 * TACHOMETER_M_S


# ---- a speed's zero ------------------------------------------------------------------------------


@pytest.mark.parametrize("zero", [-2e-3, 5e-4])
@pytest.mark.parametrize("count_m_s", [0.0, 4e-3])
def test_a_speed_off_its_zero_rests_where_the_position_does(zero: float, count_m_s: float) -> None:
    """A tachometer's offset; counts round zero and none on it, which never read zero."""
    v, x = true("stops")
    rest = v == 0.0
    speed = v + 1e-5 * np.random.default_rng(3).standard_normal(len(v))
    speed += zero
    if count_m_s:
        zero = float(np.copysign(0.5 * count_m_s, zero))
        speed = zero + count_m_s * np.round(v / count_m_s)
    m = imposed(speed, counted(x))
    found = only(m)
    assert (found.kind, found.done) == ("speed_zero", "taken off")
    assert found.size == pytest.approx(zero, abs=2e-5)
    assert m.resting[rest].mean() > 0.9
    assert not m.resting[np.abs(v) > 0.02].any()
    assert error(m, v) < max(1e-4, 0.3 * count_m_s)


@pytest.mark.parametrize("motion", MOTIONS)
def test_a_creep_is_no_zero(motion: str) -> None:
    """A slow drive goes on, and its position with it."""
    v, x = true(motion)
    creep = 5e-4
    m = imposed(measured(v + creep), counted(x + creep * TIME))
    assert [f for f in m.findings if f.kind == "speed_zero"] == []


# ---- clocks --------------------------------------------------------------------------------------


@pytest.mark.parametrize("jitter_s", [5e-4, 2e-3, 4e-3])
def test_stamps_off_an_even_clock_are_honest(jitter_s: float) -> None:
    t = np.sort(TIME + jitter_s * np.random.default_rng(9).standard_normal(len(TIME)))
    t = t[np.concatenate(([True], np.diff(t) > 1e-6))]
    v, x = true("usual", t)
    found = only(imposed(measured(v), counted(x), t))
    assert (found.kind, found.channel) == ("jitter", "time_s")
    assert found.size == pytest.approx(jitter_s, rel=0.25)


@pytest.mark.parametrize("motion", ["usual", "stops"])
@pytest.mark.parametrize("jitter_s", [1e-3, 3e-3])
def test_readings_off_their_stamps_are_seen_in_the_path(motion: str, jitter_s: float) -> None:
    t = TIME + jitter_s * np.random.default_rng(10).standard_normal(len(TIME))
    v, x = true(motion, t)
    found = only(imposed(measured(v), counted(x)))
    assert (found.kind, found.channel) == ("jitter", "time_s")
    assert found.size == pytest.approx(jitter_s, rel=0.2)


def test_rounded_stamps_and_changing_rates_are_no_jitter() -> None:
    v, x = true()
    assert imposed(measured(v), counted(x), np.round(TIME, 3)).findings == ()
    t = np.cumsum(STEP_S * (1.0 + 0.2 * np.sin(0.01 * np.arange(3000))))
    v, x = true("usual", t)
    assert imposed(measured(v), counted(x), t).findings == ()


@pytest.mark.parametrize("held", [4, 10, 18])
def test_held_readings_of_the_path_are_put_where_the_speed_says(held: int) -> None:
    v, x = true()
    angle = counted(x)
    for first in (500, 1700):
        angle[first + 1 : first + 1 + held] = angle[first]
    m = imposed(measured(v), angle)
    found = only(m)
    assert (found.kind, found.channel) == ("held_samples", "angle_rad")
    assert found.size == pytest.approx(held * STEP_S)
    assert error(m, v) < 2.0 * TACHOMETER_M_S
