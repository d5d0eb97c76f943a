"""Path and speed over the same windows: factors, units, lateness and jitter that are known."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from jbf.records.motion.compared import (
    COMMON,
    HALF_WIDTHS,
    LEAST,
    LONG,
    SHARE,
    WHOLE,
    WIDE,
    Compared,
    compared,
)
from jbf.records.motion.jitter import shaken_path, uneven_stamps
from jbf.records.motion.lateness import _lateness, earlier, late_speed
from jbf.records.motion.position import Position
from jbf.records.motion.ratio import factor_between, slope_near, way_per_unit
from jbf.records.motion.units import wrong_unit
from jbf.records.quantities import LINEAR, OF_BEARING, ROTARY

DT = 0.01
TIME: Any = DT * np.arange(600)


def path_of(time: Any) -> Any:
    """Two sines that never come again together."""
    return -0.2 / 1.7 * np.cos(1.7 * time + 0.4) - 0.1 / 4.3 * np.cos(4.3 * time)


def speed_of(time: Any) -> Any:
    return 0.2 * np.sin(1.7 * time + 0.4) + 0.1 * np.sin(4.3 * time)


PATH, SPEED = path_of(TIME), speed_of(TIME)


def test_windows_of_a_parabola_show_its_speed_and_its_acceleration() -> None:
    """Whatever their width; what a count makes of a speed falls with it."""
    time: Any = 0.1 * np.arange(200)
    path = 0.5 * 3.0 * time**2
    found = list(compared(time, path, 2.0 * 3.0 * time))
    assert len(found) == len(HALF_WIDTHS) == 3
    for half, c in zip(HALF_WIDTHS, found, strict=True):
        inner = time[2 * half : -2 * half]
        np.testing.assert_allclose(c.by_path, 3.0 * inner)
        np.testing.assert_allclose(c.by_speed, 6.0 * inner, rtol=1e-9)
        np.testing.assert_allclose(c.acceleration, 3.0, rtol=1e-9)
        smallest = float(path[1] - path[0])
        assert c.count == pytest.approx(smallest / (2 * half * 0.1))
    assert WIDE == (2, 4, 8, 16, 32, 64)


def test_windows_with_a_gap_in_them_tell_nothing() -> None:
    """Those that reach over it are left out; a record in which too few are left has none."""
    time: Any = np.concatenate((0.1 * np.arange(100), 50.0 + 0.1 * np.arange(100)))
    (two, four, eight) = compared(time, time, 0.0 * time + 1.0)
    assert [len(c.by_path) for c in (two, four, eight)] == [200 - 16, 200 - 32, 200 - 64]
    for c in (two, four, eight):
        np.testing.assert_allclose(c.by_path, 1.0)
    for samples, widths in ((67, 0), (68, 1), (75, 1), (76, 2), (92, 3)):
        clock: Any = 0.1 * np.arange(samples)
        assert len(list(compared(clock, clock, 0.0 * clock))) == widths
    assert LEAST == 60


@pytest.mark.parametrize("gap_s", [0.5, 1.1, 2.0])
def test_rows_that_are_missing_make_no_factor(gap_s: float) -> None:
    """A second is little of a wide window, and in it a fast motion goes to and fro; of a motion
    that is logged at 50 Hz, with three gaps."""
    time: Any = 0.02 * np.arange(900)
    for begin in (3.1, 8.4, 13.3):
        time = time[(time < begin) | (time > begin + gap_s)]
    rate = 2.0 * np.pi * 1.7
    path = -0.2 / rate * np.cos(rate * time) + 0.02 * time
    speed = 0.2 * np.sin(rate * time) + 0.02
    for c in compared(time, path, speed, WIDE):
        np.testing.assert_allclose(c.by_path, c.by_speed, atol=2e-3)
    assert factor_between(time, path, speed) is None
    assert factor_between(time, 1.386 * path, speed) == pytest.approx(1.386, rel=0.02)


@pytest.mark.parametrize(("half", "steps"), [(2, 2.5), (8, 2.5), (16, 3.2), (64, 12.8)])
@pytest.mark.parametrize("more", [-0.01, 0.01])
def test_a_step_is_a_gap_by_its_share_of_the_window(half: int, steps: float, more: float) -> None:
    """Or where it is as long as two and a half of what nine tenths of the steps are at most."""
    assert (LONG, SHARE, COMMON) == (2.5, 0.05, 0.9)
    apart = np.full(1000, 0.1)
    apart[500] = 0.1 * (steps + more)
    time: Any = np.concatenate(([0.0], np.cumsum(apart)))
    (c,) = compared(time, time, 0.0 * time + 1.0, (half,))
    reaches = more > 0.0 or 4 * half + steps - 1.0 >= WHOLE * 4 * half
    assert len(c.by_path) == 1001 - 4 * half - (4 * half if reaches else 0)


def test_uneven_stamps_are_no_gaps() -> None:
    """Instants by chance, as of a logger that is busy: two windows in three tell something."""
    random = np.random.default_rng(7)
    time: Any = np.cumsum(random.exponential(0.01, 4000))
    for c in compared(time, time, 0.0 * time + 1.0, WIDE):
        assert len(c.by_path) > 2400


@pytest.mark.parametrize("factor", [1.25, -1.0, 57.3, 1e-3, 0.75])
def test_a_factor_between_path_and_speed_is_found(factor: float) -> None:
    """How many times as fast the path changes; and its inverse, a unit's way."""
    found = factor_between(TIME, factor * PATH, SPEED)
    assert found == pytest.approx(factor, rel=5e-3)
    assert slope_near(TIME, factor * PATH, SPEED, factor) == pytest.approx(factor, rel=2e-3)
    way = way_per_unit(TIME, factor * PATH, SPEED)
    if factor < 0.0:
        assert way is None
    else:
        assert way == pytest.approx(1.0 / factor, rel=2e-3)


def test_path_and_speed_that_agree_or_are_no_multiples_have_no_factor() -> None:
    """Within a fifth they agree; a way for a unit that is nearly one is one."""
    for factor, there in ((1.0, False), (1.18, False), (1.22, True), (0.82, False), (0.78, True)):
        assert (factor_between(TIME, factor * PATH, SPEED) is not None) == there
    random = np.random.default_rng(1)
    assert factor_between(TIME, PATH, random.standard_normal(600)) is None
    assert way_per_unit(TIME, PATH, random.standard_normal(600)) is None
    assert way_per_unit(TIME, 1.01 * PATH, SPEED) == 1.0
    assert way_per_unit(TIME, 1.03 * PATH, SPEED) == pytest.approx(1.0 / 1.03, rel=2e-3)
    assert factor_between(TIME[:60], 3.0 * PATH[:60], SPEED[:60]) is None
    assert slope_near(TIME, PATH, SPEED, 7.0) == 7.0


def test_a_factor_that_changes_is_none() -> None:
    """A ratio that grows has a middle half; a narrow one is a factor all the same."""
    speed = 0.0 * TIME + 0.1
    for grows, there in ((8.0, False), (0.5, True)):
        path = 0.1 * (2.0 * TIME + 0.5 * grows * TIME**2 / TIME[-1])
        assert (factor_between(TIME, path, speed) is not None) == there
        assert (way_per_unit(TIME, path, speed) is not None) == there


def mismatch(column: str, factor: float, arm: float = 1.0, said: Any = OF_BEARING) -> Any:
    """What is said of a path that changes so many times as fast as the speed says."""
    unit = "rad" if column == "angle_rad" else "m"
    return wrong_unit("a", TIME, Position(factor * PATH, column, unit, arm), SPEED, said)


TURN = 2.0 * np.pi


@pytest.mark.parametrize(
    ("column", "factor", "arm", "said", "channel", "hint"),
    [
        ("angle_rad", 360.0 / TURN, 0.3, OF_BEARING, "angle_rad", "is angle_rad in degrees?"),
        ("angle_rad", 1.0 / TURN, 0.3, OF_BEARING, "angle_rad", "is angle_rad in turns?"),
        ("angle_rad", 0.3, 0.3, OF_BEARING, "velocity_m_s", "is velocity_m_s in rad/s?"),
        ("angle_rad", 0.3 * TURN / 360.0, 0.3, OF_BEARING, "velocity_m_s",
         "is velocity_m_s in degrees a second?"),
        ("angle_rad", 0.3 * TURN / 60.0, 0.3, OF_BEARING, "velocity_m_s",
         "is velocity_m_s in turns a minute?"),
        ("angle_rad", 0.3 * TURN, 0.3, OF_BEARING, "velocity_m_s",
         "is velocity_m_s in turns a second?"),
        ("angle_rad", TURN / 60.0, 1.0, ROTARY, "velocity_m_s",
         "is velocity_rad_s in turns a minute?"),
        ("position_m", 1e3, 1.0, LINEAR, "position_m", "is position_m in mm?"),
        ("position_m", 1e2, 1.0, LINEAR, "position_m", "is position_m in cm?"),
        ("position_m", 1e6, 1.0, LINEAR, "position_m", "is position_m in um?"),
        ("position_m", 1e-3, 1.0, LINEAR, "velocity_m_s", "is velocity_m_s in mm/s?"),
        ("position_m", 1e-2, 1.0, LINEAR, "velocity_m_s", "is velocity_m_s in cm/s?"),
        ("position_m", 1e-6, 1.0, LINEAR, "velocity_m_s", "is velocity_m_s in um/s?"),
        ("position_m", 1.0 / 60.0, 1.0, LINEAR, "velocity_m_s", "is velocity_m_s in m/min?"),
    ],
)  # fmt: skip
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_unit_is_known_by_its_factor(
    column: str, factor: float, arm: float, said: Any, channel: str, hint: str, sign: float
) -> None:
    """Which column it is of, what it might be, and what is done about it."""
    found = mismatch(column, sign * factor, arm, said)
    finding = found.finding
    assert (finding.kind, finding.channel, finding.unit) == ("units", channel, "1")
    assert finding.size == pytest.approx(sign * factor, rel=5e-3)
    assert found.factor == pytest.approx(sign * factor, rel=1e-12)
    assert found.of_speed == (channel == "velocity_m_s")
    turned = ", and the other way" if sign < 0.0 else ""
    called = said.speed_column
    assert finding.words == (
        f"{column} changes {abs(finding.size):.4g} times as fast as {called} says{turned}: {hint}"
    )
    by = f"{sign * factor:.4g}"
    assert finding.done == (
        f"multiplied by {by}, to agree with the path" if found.of_speed
        else f"divided by {by}, to agree with the speed"
    )  # fmt: skip


def test_a_factor_of_no_unit_is_the_paths() -> None:
    """Divided by what least squares say; a journal's radius may be the reason."""
    found = mismatch("angle_rad", 5.0, 0.3)
    assert found.finding.channel == "angle_rad"
    assert found.factor == pytest.approx(5.0, rel=2e-3)
    assert found.finding.words.endswith("says: is the radius of the journal right?")
    assert found.finding.done.startswith("divided by 5")
    plain = mismatch("position_m", 5.0)
    assert plain.finding.words.endswith("times as fast as velocity_m_s says")
    # A unit is near by a twentieth, and not by a tenth.
    assert "mm" in mismatch("position_m", 1.05e3).finding.words
    assert "mm" not in mismatch("position_m", 1.1e3).finding.words


def test_a_sign_that_is_turned_is_no_unit() -> None:
    """Nor is anything said where both agree."""
    for said in (OF_BEARING, ROTARY):
        found = mismatch("angle_rad", -1.0, 0.3, said)
        assert (found.finding.kind, found.factor, found.of_speed) == ("sign", -1, False)
        assert found.finding.words == (
            f"angle_rad falls where {said.speed_column} says that it rises: one has its sign turned"
        )
        assert found.finding.done == "angle_rad is turned to the speed's sign"
    assert mismatch("angle_rad", -1.15, 0.3).finding.kind == "sign"
    assert mismatch("angle_rad", -1.3, 0.3).finding.kind == "units"
    assert mismatch("position_m", 1.0) is None


def test_a_speed_that_lags_is_late_by_its_lag() -> None:
    """Shifted where it is less than four tenths of a sample, else left aside."""
    for late_s, kind, done in (
        (0.2 * DT, "late_speed", "shifted"),
        (0.39 * DT, "late_speed", "shifted"),
        (0.45 * DT, "filtered_speed", "left aside; the path alone tells the motion"),
        (3.0 * DT, "filtered_speed", "left aside; the path alone tells the motion"),
    ):
        found = late_speed("a", TIME, PATH, speed_of(TIME - late_s))
        assert found is not None
        assert (found.kind, found.done, found.unit) == (kind, done, "s")
        assert (found.channel, found.run) == ("velocity_m_s", "a")
        assert found.size == pytest.approx(late_s, rel=0.03)
        assert found.words == (
            f"the speed is {1e3 * found.size:.3g} ms later than the path: filtered, or looking back"
        )


def test_a_speed_in_time_or_early_or_of_a_short_record_is_not_late() -> None:
    """Less than a tenth of a sample does not show, nor what noise hides."""
    for late_s, there in ((0.0, False), (-1.0 * DT, False), (0.08 * DT, False), (0.13 * DT, True)):
        found = late_speed("a", TIME, PATH, speed_of(TIME - late_s))
        assert (found is not None) == there
    assert late_speed("a", TIME[:67], PATH[:67], speed_of(TIME[:67] - DT)) is None
    noise = np.random.default_rng(2).standard_normal(600)
    assert late_speed("a", TIME, PATH, speed_of(TIME - 0.2 * DT) + 0.05 * noise) is None


def test_lateness_is_the_part_of_the_acceleration() -> None:
    """Regression on speed and acceleration; of a motion that dies out late is but smaller."""
    a = np.cos(5.0 * TIME)
    v = np.sin(3.0 * TIME)
    known = Compared(v, 0.97 * v - 0.02 * a, a, 0.0)
    late, error = _lateness(known)
    assert late == pytest.approx(0.02)
    assert error == pytest.approx(1e-12, abs=1e-12)
    noise = 0.1 * np.random.default_rng(3).standard_normal(600)
    late, error = _lateness(replace(known, by_speed=known.by_speed + noise))
    assert error == pytest.approx(0.1 / np.sqrt(np.sum(a**2)), rel=0.6)
    assert abs(late - 0.02) < 4.0 * error
    assert _lateness(Compared(v, v, 0.99 * v, 0.0)) == (0.0, np.inf)
    assert _lateness(Compared(v, v, -0.99 * v, 0.0)) == (0.0, np.inf)


def test_a_late_speed_is_shifted_and_its_zeros_stay() -> None:
    """On straight lines; a rest is known by them."""
    speed = np.array([0.0, 0.0, 1.0, 2.0, 0.0, 0.0])
    shifted = earlier(np.arange(6.0), speed, 0.25)
    assert shifted.tolist() == [0.0, 0.0, 1.25, 1.5, 0.0, 0.0]


def jittered(size: float, samples: int = 400) -> Any:
    """Stamps so much off an even clock, RMS, s."""
    random = np.random.default_rng(5)
    return DT * np.arange(samples) + size * random.standard_normal(samples)


def test_stamps_off_an_even_clock_are_told_by_their_size() -> None:
    """From a hundredth of a step on, of a record with a rate and long enough."""
    found = uneven_stamps("a", jittered(1e-3, 6000))
    assert found is not None
    assert (found.kind, found.channel, found.run, found.unit) == ("jitter", "time_s", "a", "s")
    assert found.size == pytest.approx(1e-3, rel=0.05)
    assert found.words == (f"the stamps are off an even clock by {1e3 * found.size:.3g} ms RMS")
    assert found.done == "taken as they are"
    for size, there in ((0.8e-4, False), (1.3e-4, True)):
        assert (uneven_stamps("a", jittered(size)) is not None) == there
    assert uneven_stamps("a", jittered(1e-3)[:60]) is None
    assert uneven_stamps("a", jittered(1e-3)[:61]) is not None
    # A rate that changes smoothly is no jitter, and one sample in eight that lacks is no rate.
    assert uneven_stamps("a", TIME + 0.2 * TIME**2) is None
    clock = jittered(1e-3)
    assert uneven_stamps("a", np.delete(clock, np.arange(0, 400, 8))) is None
    assert uneven_stamps("a", np.delete(clock, np.arange(0, 400, 20))) is not None


def shaken(size: float, *, coarse: float = 0.0, samples: int = 4000, ripple: bool = False) -> Any:
    """A path that an encoder read so much off the stamps, RMS, s."""
    time: Any = DT * np.arange(samples)
    off = size * np.random.default_rng(6).standard_normal(samples)
    if ripple:
        off = size * np.sin(2.0 * np.pi / 6.0 * np.arange(samples))
    path = path_of(0.2 * (time + off)) / 0.2
    if coarse:
        path = coarse * np.round(path / coarse)
    return shaken_path("a", time, path, speed_of(0.2 * time))


def test_a_path_whose_noise_grows_with_the_speed_was_read_off_its_stamps() -> None:
    """By as much time as its noise is over the speed; nothing can be done about it."""
    found = shaken(1e-3)
    assert found is not None
    assert (found.kind, found.channel, found.unit, found.done) == ("jitter", "time_s", "s", "none")
    assert found.size == pytest.approx(1e-3, rel=0.25)
    assert found.words == (
        f"the path is as noisy as if it was read {1e3 * found.size:.3g} ms RMS off the stamps: its "
        "noise grows with the speed"
    )


def test_a_path_that_is_as_noisy_at_any_speed_was_not_shaken() -> None:
    """Nor one in whose counts it does not show, one that has a ripple, or one of uneven stamps."""
    assert shaken(0.5e-4) is None
    assert shaken(1e-3, coarse=1e-3) is None
    assert shaken(1e-2, ripple=True) is None
    assert shaken(1e-3, samples=200) is None
    time: Any = DT * np.arange(4000)
    noise = 1e-4 * np.random.default_rng(7).standard_normal(4000)
    even = path_of(0.2 * time) / 0.2 + noise
    assert shaken_path("a", time, even, speed_of(0.2 * time)) is None
    uneven = time + 2e-3 * np.random.default_rng(8).uniform(-1.0, 1.0, 4000)
    assert shaken_path("a", uneven, even, speed_of(0.2 * time)) is None
