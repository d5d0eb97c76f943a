"""Motions that a rig can make: each by its own formula, within limits that are given or read."""

from __future__ import annotations

from collections.abc import Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from jbf import InputError
from jbf.diagnosis.excitations import Excitation, Limits, excitations

Array = npt.NDArray[np.float64]
STEP_S = 0.02
TOP, SHARP = 0.1, 0.2


def made(
    top: float = TOP, sharp: float = SHARP, duration_s: float = 60.0, **more: Any
) -> dict[str, Excitation]:
    found = list(excitations(Limits(top, sharp, duration_s, **more), STEP_S))
    by_words = {x.words: x for x in found}
    assert len(by_words) == len(found)
    return by_words


def time_s(duration_s: float = 60.0) -> Array:
    return np.arange(0.0, duration_s, STEP_S)


def sine(speed: float, rate: float) -> str:
    return f"a two-way sine of {speed:g} m/s at {rate:g} rad/s"


def stops(speed: float) -> str:
    return f"stop and go to {speed:g} m/s, both ways, with rests of 8 s"


# ---- the motions -------------------------------------------------------------------------------


def test_sines_are_those_that_turn_twice_and_are_not_too_sharp() -> None:
    """In 60 s a rate of 0.25 rad/s makes two turns, one of 0.1 does not; an amplitude times its
    rate is within 0.2 m/s^2."""
    found = made()
    allowed = {
        0.1: (0.25, 0.5, 1.0, 2.0),
        0.03: (0.25, 0.5, 1.0, 2.0, 4.0),
        0.01: (0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0),
        0.002: (0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0),
    }
    wanted = [sine(speed, w) for speed, rates in allowed.items() for w in rates]
    assert [words for words in found if words.startswith("a two-way")] == wanted
    for speed, rates in allowed.items():
        for w in rates:
            assert found[sine(speed, w)].velocity_m_s == pytest.approx(speed * np.sin(w * time_s()))
    # Longer runs have slower ones.
    assert sine(0.1, 0.1) in made(duration_s=130.0)
    assert sine(0.1, 0.05) not in made(duration_s=250.0)
    assert sine(0.1, 0.05) in made(duration_s=253.0)


@pytest.mark.parametrize(("sharp", "there"), [(0.1975, False), (0.1985, True)])
def test_a_hundredth_more_than_the_acceleration_is_within_it(sharp: float, there: bool) -> None:
    """0.2 m/s^2 is 1.01 times 0.198."""
    assert (sine(0.1, 2.0) in made(sharp=sharp)) == there


def test_one_way_sines_and_constant_runs_start_at_half_the_acceleration() -> None:
    """From rest to 0.1 m/s in one second."""
    found, t = made(), time_s()
    start = np.minimum(t, 1.0)
    for w in (0.25, 0.5, 1.0):
        way = found[f"a one-way sine from 0.01 to 0.1 m/s at {w:g} rad/s"].velocity_m_s
        assert way == pytest.approx(0.1 * start * (0.55 + 0.45 * np.sin(w * t)))
    one_way = [words for words in found if words.startswith("a one-way")]
    assert one_way[0].endswith("at 0.25 rad/s")
    assert not any(words.endswith(" 16 rad/s") for words in one_way)
    for speed in (0.1, 0.03):
        steady = found[f"a run at a constant {speed:g} m/s"].velocity_m_s
        assert steady == pytest.approx(speed * start)


@pytest.mark.parametrize(("sharp", "ramp_s"), [(0.2, 1.0), (0.05, 2.1)])
def test_stop_and_go_rests_eight_seconds_and_goes_three(sharp: float, ramp_s: float) -> None:
    """A ramp takes a second, or as long as the acceleration asks with a twentieth to spare."""
    t = time_s(80.0)
    found = made(sharp=sharp, duration_s=80.0)
    for speed, ramp in ((0.04, 1.0), (0.1, ramp_s)):
        cycle = 11.0 + 2.0 * ramp
        corners = np.array([0.0, 8.0, 8.0 + ramp, 11.0 + ramp, cycle])
        height = np.interp(np.mod(t, cycle), corners, [0.0, 0.0, 1.0, 1.0, 0.0])
        way = np.where((t // cycle) % 2 == 0, 1.0, -1.0)
        assert found[stops(speed)].velocity_m_s == pytest.approx(speed * way * height, abs=1e-9)


def test_mixed_motions_are_stop_and_go_a_fast_and_a_quick_sine() -> None:
    """After one stroke there and one back, 26 s: 17 s of the quickest full sine, 2 rad/s, in whole
    half-waves, ten of them; then the quickest that is less far."""
    found, t = made(), time_s()
    for share_speed in (0.04, 0.1):
        for speed, w in ((0.03, 4.0), (0.01, 16.0), (0.002, 16.0)):
            words = f"{stops(share_speed)}, then {sine(0.1, 2.0)}, then {sine(speed, w)}"
            velocity = found[words].velocity_m_s
            first = found[stops(share_speed)].velocity_m_s
            then_s = 26.0 + 10.0 * np.pi / 2.0
            middle = 0.1 * np.sin(2.0 * (t - 26.0))
            last = speed * np.sin(w * (t - then_s))
            wanted = np.where(t < 26.0, first, np.where(t < then_s, middle, last))
            assert velocity == pytest.approx(wanted, abs=1e-9)
    assert sum(", then " in words for words in found) == 6


@pytest.mark.parametrize(("duration_s", "there"), [(32.2, False), (32.4, True)])
def test_a_mixed_motion_has_room_for_two_half_waves(duration_s: float, there: bool) -> None:
    """After 26 s a whole wave of 2 rad/s, 3.14 s, and as much again for the last part."""
    found = made(duration_s=duration_s)
    assert any(", then " in words for words in found) == there


def test_where_no_full_sine_is_slow_enough_nothing_is_mixed() -> None:
    """0.1 m/s at the slowest rate, 0.05 rad/s, is 0.005 m/s^2."""
    assert not any(", then " in words for words in made(sharp=0.0045, duration_s=2000.0))
    assert any(", then " in words for words in made(sharp=0.0055, duration_s=2000.0))


def test_each_motion_begins_at_rest_and_keeps_to_its_limits() -> None:
    for x in made(0.3, 1.7, 90.0).values():
        assert x.velocity_m_s[0] == 0.0
        assert np.max(np.abs(x.velocity_m_s)) <= 0.3 * (1.0 + 1e-12)
        assert np.max(np.abs(np.diff(x.velocity_m_s))) <= 1.01 * 1.7 * STEP_S


def test_of_no_time_at_all_there_is_no_turn() -> None:
    assert not any("sine" in words for words in made(duration_s=0.01))


def test_words_have_the_units_of_the_rig() -> None:
    found = [x.words for x in excitations(Limits(TOP, SHARP), STEP_S, "rad/s")]
    assert any(words.startswith("a two-way sine of 0.1 rad/s at") for words in found)
    assert not any("m/s" in words for words in found)


def test_each_motion_comes_under_each_load_and_at_each_temperature() -> None:
    words = "a run at a constant 0.1 m/s"
    loads = made(load_n=(20.0, 104.25))
    assert loads[f"{words} under 20 N"].load_n == 20.0
    assert loads[f"{words} under 104.2 N"].load_n == 104.25
    assert words not in loads
    one = made(load_n=(20.0, 20.0))
    assert [w for w in one if w.startswith(words)] == [f"{words} under 20 N"]
    warm = made(temperature_c=(15.0, 60.25), load_n=(20.0, 20.0))
    for celsius in (15.0, 60.25):
        name = f"{words} under 20 N, the machine at {celsius:.3g} C all the time,"
        assert (warm[name].temperature_c, warm[name].load_n) == (celsius, 20.0)
    plain = made()[words]
    assert (plain.load_n, plain.temperature_c) == (None, None)


# ---- the limits --------------------------------------------------------------------------------


def campaign(
    *,
    loads: Sequence[Array | None] | None = None,
    has_loads: bool = True,
    celsius: tuple[float, float] | None = None,
) -> Any:
    """Two runs: to 0.2 m/s backwards, and to 0.15 m/s; accelerations of 0.3 m/s^2 but for one bad
    sample in ten thousand."""
    sharp = np.full(10_000, -0.3)
    sharp[5] = 50.0
    prepared = []
    for i, v in enumerate((-0.2, 0.15)):
        motion = SimpleNamespace(velocity_m_s=np.array([0.0, v]), acceleration_m_s2=sharp * (1 - i))
        run = SimpleNamespace(load_n=None if loads is None else loads[i])
        prepared.append(SimpleNamespace(motion=motion, run=run))
    span = None if celsius is None else celsius[1] - celsius[0]
    return SimpleNamespace(
        prepared=prepared,
        has_loads=has_loads,
        temperatures_k=span,
        temperature_range_c=celsius,
    )


def test_what_is_not_given_the_runs_tell() -> None:
    """A sine of the largest speed at 2 rad/s is taken to be possible: 0.4 m/s^2."""
    found = Limits().filled(campaign())
    assert found == Limits(0.2, 0.4, 60.0, None, None)
    given = Limits(0.05, 0.01, 7.0, (1.0, 2.0), (3.0, 4.0))
    assert given.filled(campaign(celsius=(10.0, 90.0))) == given
    # At half the speed what was seen is more.
    assert Limits(velocity_m_s=0.1).filled(campaign()).acceleration_m_s2 == pytest.approx(0.3)


def test_loads_are_those_on_record_where_they_differ() -> None:
    loads = [np.array([90.0, 100.0, 500.0]), np.array([40.0, 40.0, 1.0])]
    assert Limits().filled(campaign(loads=loads)).load_n == (40.0, 100.0)
    assert Limits().filled(campaign(loads=[loads[0], None])).load_n == (100.0, 100.0)
    assert Limits().filled(campaign(loads=loads, has_loads=False)).load_n is None
    assert Limits(load_n=(5.0, 6.0)).filled(campaign(loads=loads)).load_n == (5.0, 6.0)


@pytest.mark.parametrize(("high", "told"), [(21.9, False), (22.0, True), (60.0, True)])
def test_temperatures_are_those_on_record_where_they_differ_by_two_kelvin(
    high: float, told: bool
) -> None:
    found = Limits().filled(campaign(celsius=(20.0, high)))
    assert found.temperature_c == ((20.0, high) if told else None)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"velocity_m_s": 0.0}, "velocity_m_s = 0"),
        ({"velocity_m_s": np.nan}, "velocity_m_s = nan"),
        ({"velocity_m_s": 1.01e6}, "beyond what any machine does"),
        ({"acceleration_m_s2": -1.0}, "acceleration_m_s2 = -1"),
        ({"acceleration_m_s2": np.inf}, "acceleration_m_s2 = inf"),
        ({"duration_s": 0.0}, "duration_s = 0"),
        ({"duration_s": 86401.0}, "duration_s = 86401 is more than a day"),
        ({"load_n": (0.0, 5.0)}, "load_n = 0"),
        ({"load_n": (1.0, 2e6)}, "load_n = 2e.06 is beyond"),
        ({"load_n": (5.0, 4.0)}, "load_n = 5 to 4"),
        ({"temperature_c": (30.0, 20.0)}, "temperature_c = 30 to 20"),
        ({"temperature_c": (np.nan, 20.0)}, "temperature_c = nan to 20"),
    ],
)
def test_limits_that_are_none_are_refused(given: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError, match=said):
        Limits(**given)


def test_limits_at_their_ends_are_taken() -> None:
    ends = Limits(1e6, 1e6, 86400.0, (5.0, 5.0), (-30.0, -30.0))
    assert ends.load_n == (5.0, 5.0)
    assert Limits(temperature_c=(-40.0, 0.5)).temperature_c == (-40.0, 0.5)
