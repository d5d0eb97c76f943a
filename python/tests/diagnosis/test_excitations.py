"""Candidate motions of a rig: formulas, and limits that are given or taken from records."""

import re
from functools import cache
from typing import Any

import numpy as np
import pytest
from by_hand import Array
from jbf import InputError, Rig
from jbf.diagnosis.experiment_design.excitations import Excitation, Limits, excitations
from jbf.estimation.campaign import Campaign
from linear_campaigns import coulomb_run

STEP_S = 0.02


def motions(
    top: float = 0.1, sharp: float = 0.2, duration_s: float = 60.0, **more: Any
) -> dict[str, Excitation]:
    """Candidate motions by their unique descriptions."""
    candidates = list(excitations(Limits(top, sharp, duration_s, **more), STEP_S))
    by_words = {x.words: x for x in candidates}
    assert len(by_words) == len(candidates)
    return by_words


def time_s(duration_s: float = 60.0) -> Array:
    return np.arange(0.0, duration_s, STEP_S)


def sine(speed: float, rate: float) -> str:
    return f"a two-way sine of {speed:g} m/s at {rate:g} rad/s"


def stops(speed: float) -> str:
    return f"stop and go to {speed:g} m/s, both directions, with rests of 8 s"


def test_proposed_sines_have_two_periods_and_respect_the_acceleration_limit() -> None:
    """A rate of 0.25 rad/s has two periods in 60 s; amplitude times rate is at most 0.2 m/s^2."""
    found = motions()
    allowed = {
        0.1: (0.25, 0.5, 1.0, 2.0),
        0.03: (0.25, 0.5, 1.0, 2.0, 4.0),
        0.01: (0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0),
        0.002: (0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0),
    }
    expected = [sine(speed, w) for speed, rates in allowed.items() for w in rates]
    assert [words for words in found if words.startswith("a two-way")] == expected
    for speed, rates in allowed.items():
        for w in rates:
            assert found[sine(speed, w)].velocity == pytest.approx(speed * np.sin(w * time_s()))


def test_sine_exceeds_the_acceleration_limit_by_at_most_one_percent() -> None:
    assert sine(0.1, 2.0) not in motions(sharp=0.1975)
    assert sine(0.1, 2.0) in motions(sharp=0.1985)


def test_unidirectional_motions_start_with_half_the_acceleration_limit() -> None:
    """The speed rises from rest to 0.1 m/s in one second."""
    found, t = motions(), time_s()
    start = np.minimum(t, 1.0)
    for w in (0.25, 0.5, 1.0):
        v = found[f"a one-way sine from 0.01 to 0.1 m/s at {w:g} rad/s"].velocity
        assert v == pytest.approx(0.1 * start * (0.55 + 0.45 * np.sin(w * t)))
    for speed in (0.1, 0.03):
        constant = found[f"a run at a constant {speed:g} m/s"]
        assert constant.velocity == pytest.approx(speed * start)


@pytest.mark.parametrize(("sharp", "ramp_s"), [(0.2, 1.0), (0.05, 2.1)])
def test_stop_and_go_motion_rests_for_8_s_and_moves_for_3_s(sharp: float, ramp_s: float) -> None:
    """A ramp takes a second, or 5 % longer than the acceleration requires."""
    t = time_s(80.0)
    found = motions(sharp=sharp, duration_s=80.0)
    for speed, ramp in ((0.04, 1.0), (0.1, ramp_s)):
        cycle = 11.0 + 2.0 * ramp
        corners = np.array([0.0, 8.0, 8.0 + ramp, 11.0 + ramp, cycle])
        height = speed * np.interp(np.mod(t, cycle), corners, [0.0, 0.0, 1.0, 1.0, 0.0])
        expected = np.where((t // cycle) % 2 == 0, height, -height)
        assert found[stops(speed)].velocity == pytest.approx(expected, abs=1e-9)


def test_mixed_motion_is_stop_and_go_then_a_fast_and_a_short_sine() -> None:
    """Stop and go of 26 s, ten half-waves at 2 rad/s, then the fastest shorter sine."""
    found, t = motions(), time_s()
    for stop_speed in (0.04, 0.1):
        for speed, w in ((0.03, 4.0), (0.01, 16.0), (0.002, 16.0)):
            words = f"{stops(stop_speed)}, then {sine(0.1, 2.0)}, then {sine(speed, w)}"
            first = found[stops(stop_speed)].velocity
            last_s = 26.0 + 10.0 * np.pi / 2.0
            middle, last = 0.1 * np.sin(2.0 * (t - 26.0)), speed * np.sin(w * (t - last_s))
            expected = np.where(t < 26.0, first, np.where(t < last_s, middle, last))
            assert found[words].velocity == pytest.approx(expected, abs=1e-9)
    assert sum(", then " in words for words in found) == 6


def test_mixed_motion_requires_a_minimum_duration_and_acceleration() -> None:
    # The motion needs 26 s of stop and go, a period of 3.14 s, and the same time again.
    assert not any(", then " in words for words in motions(duration_s=32.2))
    assert any(", then " in words for words in motions(duration_s=32.4))
    # The slowest full sine needs 0.005 m/s^2.
    assert not any(", then " in words for words in motions(sharp=0.0045, duration_s=2000.0))
    assert any(", then " in words for words in motions(sharp=0.0055, duration_s=2000.0))


def test_proposed_motions_begin_at_rest_and_respect_limits_and_descriptions() -> None:
    for words, x in motions(0.3, 1.7, 90.0).items():
        fastest = max(float(speed) for speed in re.findall(r"(\S+) m/s", words))
        assert x.velocity[0] == 0.0
        assert np.max(np.abs(x.velocity)) == pytest.approx(fastest, rel=0.02)
        assert np.max(np.abs(x.velocity)) <= 0.3 * (1.0 + 1e-12)
        assert np.max(np.abs(np.diff(x.velocity))) <= 1.01 * 1.7 * STEP_S
        assert len(x.velocity) == round(90.0 / STEP_S)


def test_description_of_a_motion_has_the_velocity_unit_of_the_rig() -> None:
    found = "; ".join(x.words for x in excitations(Limits(0.1, 0.2), STEP_S, "rad/s"))
    assert "a two-way sine of 0.1 rad/s at" in found
    assert "m/s" not in found


def test_motions_are_proposed_under_each_load_and_at_each_temperature() -> None:
    count = len(motions())
    found = motions(load_n=(20.0, 104.25), temperature_c=(15.0, 60.25))
    conditions = sorted((x.load_n, x.temperature_c) for x in found.values())
    expected = [(load, celsius) for load in (20.0, 104.25) for celsius in (15.0, 60.25)]
    assert conditions == sorted(expected * count)
    for words, x in found.items():
        assert f"under {x.load_n:.4g} N" in words
        assert f"at {x.temperature_c:.3g} C" in words
    assert {x.load_n for x in motions(load_n=(20.0, 20.0)).values()} == {20.0}
    assert {(x.load_n, x.temperature_c) for x in motions().values()} == {(None, None)}


@cache
def recorded(
    rate: float, loads: tuple[float, ...] = (), celsius: tuple[float, ...] = ()
) -> Campaign:
    """Two slides with top speeds of 0.2 m/s and 0.1 m/s."""
    t = np.arange(0.0, 20.0, STEP_S)
    runs = []
    for k, top in enumerate((-0.2, 0.1)):
        more: dict[str, Any] = {"load_n": np.full(len(t), loads[k])} if loads else {}
        if celsius:
            more["temperature_c"] = np.full(len(t), celsius[k])
        runs.append(coulomb_run(t, top * np.sin(rate * t), seed=k, **more))
    return Campaign.prepare(Rig(), runs)


@pytest.mark.parametrize(("rate", "sharp"), [(1.0, 0.4), (3.0, 0.6)])
def test_missing_motion_limits_are_taken_from_the_records(rate: float, sharp: float) -> None:
    """The acceleration is at least that of a sine at 2 rad/s with the largest speed."""
    found = Limits().filled(recorded(rate))
    assert found.velocity == pytest.approx(0.2, rel=1e-3)
    assert found.acceleration == pytest.approx(sharp, rel=5e-3)
    assert (found.duration_s, found.load_n, found.temperature_c) == (60.0, None, None)


def test_given_motion_limits_are_not_changed_by_the_records() -> None:
    given = Limits(0.05, 0.01, 7.0, (1.0, 2.0), (3.0, 4.0), 0.02)
    assert given.filled(recorded(1.0, (40.0, 100.0), (10.0, 90.0))) == given
    # The default acceleration limit is that of the records.
    slower = Limits(velocity=0.05).filled(recorded(1.0))
    assert slower.acceleration == pytest.approx(0.2, rel=5e-3)


@pytest.mark.parametrize("position", [True, False])
def test_missing_travel_is_the_largest_of_a_recorded_run(position: bool) -> None:
    """Runs may have different origins: distances between positions of two runs do not count."""
    t = np.arange(0.0, 20.0, STEP_S)
    runs = []
    for k, amplitude in enumerate((0.03, 0.05)):
        place = {"position_m": 5.0 * k + amplitude * (1.0 - np.cos(t))} if position else {}
        runs.append(coulomb_run(t, amplitude * np.sin(t), seed=k, **place))
    assert Limits().filled(Campaign.prepare(Rig(), runs)).travel == pytest.approx(0.1, rel=1e-3)


@pytest.mark.parametrize("travel", [2e-3, 0.05, 0.3, 5.0])
@pytest.mark.parametrize("sharp", [0.05, 0.2, 20.0])
def test_motions_stay_within_the_travel_from_its_lower_end(travel: float, sharp: float) -> None:
    found = motions(sharp=sharp, travel=travel)
    for words, x in found.items():
        path = np.concatenate(([0.0], np.cumsum(x.velocity[1:] + x.velocity[:-1]))) * 0.5 * STEP_S
        assert np.ptp(path) <= travel, words
        assert np.min(path) >= -0.02 * travel, words
        assert np.max(np.abs(np.diff(x.velocity))) <= 1.01 * sharp * STEP_S, words
    # Slow and fast motions of both kinds remain, and most of the travel is used.
    kinds = [sum(words.startswith(kind) for words in found) for kind in ("a two-way", "stop")]
    assert min(kinds) > 0
    assert any("constant" in words for words in found)
    covered = [np.ptp(np.cumsum(x.velocity)) * STEP_S for x in found.values()]
    assert max(covered) > 0.9 * min(travel, 0.1 * 60.0)


def test_travel_that_no_motion_reaches_changes_no_motion() -> None:
    free, limited = motions(), motions(travel=100.0)
    assert list(free) == list(limited)
    for words, x in free.items():
        assert limited[words].velocity == pytest.approx(x.velocity)


def test_limits_of_load_and_temperature_are_those_of_records_that_differ() -> None:
    assert Limits().filled(recorded(1.0, (100.0, 40.0))).load_n == (40.0, 100.0)
    assert Limits().filled(recorded(1.0, (100.0, 100.0))).load_n is None
    # Temperatures count as different from 2 K on.
    assert Limits().filled(recorded(1.0, (), (20.0, 21.9))).temperature_c is None
    found = Limits().filled(recorded(1.0, (), (20.0, 22.0))).temperature_c
    assert found == pytest.approx((20.0, 22.0))


@pytest.mark.parametrize(
    ("given", "key"),
    [
        ({"velocity": 0.0}, "velocity = 0"),
        ({"velocity": np.nan}, "velocity = nan"),
        ({"velocity": 1.01e6}, "velocity"),
        ({"acceleration": -1.0}, "acceleration = -1"),
        ({"acceleration": np.inf}, "acceleration = inf"),
        ({"travel": 0.0}, "travel = 0"),
        ({"duration_s": 0.0}, "duration_s = 0"),
        ({"duration_s": 86401.0}, "duration_s = 86401"),
        ({"load_n": (0.0, 5.0)}, "load_n = 0"),
        ({"load_n": (1.0, 2e6)}, "load_n = 2e.06"),
        ({"load_n": (5.0, 4.0)}, "load_n = 5 to 4"),
        ({"temperature_c": (30.0, 20.0)}, "temperature_c = 30 to 20"),
        ({"temperature_c": (np.nan, 20.0)}, "temperature_c = nan to 20"),
    ],
)
def test_invalid_limit_is_reported_with_its_name_and_value(given: dict[str, Any], key: str) -> None:
    with pytest.raises(InputError, match=key):
        Limits(**given)


def test_motion_limits_at_the_ends_of_their_ranges_are_accepted() -> None:
    assert Limits(1e6, 1e6, 86400.0, (5.0, 5.0), (-30.0, -30.0)).load_n == (5.0, 5.0)
    assert Limits(temperature_c=(-40.0, 0.5)).temperature_c == (-40.0, 0.5)
