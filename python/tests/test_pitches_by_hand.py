"""Pitches of waves that are put together by hand, and what of a force is known without them."""

from __future__ import annotations

import sys
from types import SimpleNamespace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from jbf import Rig
from jbf.estimation.pitches import (
    BINS_A_PITCH,
    KNOTS,
    LEAST_PERIODS,
    LINES,
    PADDING,
    _hats,
    _knots,
    _less_means,
    _pitches,
    _wave,
    _way_a_sample,
    _without_the_known,
    known_pitches,
    longest_pitch,
    pitches,
)
from made_of import record, samples_of

Array = npt.NDArray[np.float64]
module = sys.modules["jbf.estimation.pitches"]
FINE_M = 1e-3
PLACE: Array = np.array(FINE_M * (np.arange(4000) % 2000 + 0.5), dtype=np.float64)
"""There and back over 2 m, a sample each millimetre."""
SPEED = np.where(np.arange(4000) < 2000, 0.1, -0.1)


def told(
    monkeypatch: pytest.MonkeyPatch,
    rest: Array,
    *,
    along: bool = False,
    place: Array = PLACE,
    speed: Array = SPEED,
    way: float = FINE_M,
) -> tuple[float, ...]:
    monkeypatch.setattr(module, "_what_is_left", lambda campaign: (place, rest, speed))
    monkeypatch.setattr(module, "_way_a_sample", lambda campaign: way)
    campaign: Any = object()
    return _pitches(campaign, along)


def wave(pitch: float, size: float = 1.0, place: Array = PLACE) -> Array:
    found: Array = size * np.cos(2.0 * np.pi * place / pitch + 0.4)
    return found


# ---- pitches -----------------------------------------------------------------------------------


@pytest.mark.parametrize("unit", [1e-3, 1e3])
def test_three_waves_are_found_the_highest_first(
    unit: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    rest = unit * (wave(0.031, 2.0) + wave(0.17, 3.0) + wave(0.0083, 1.0) + wave(0.06, 0.5) + 9.0)
    found = told(monkeypatch, rest)
    assert LINES == 3
    # To a share of the width of a line, which is the pitch over the periods of the way.
    for pitch, wanted in zip(found, (0.17, 0.031, 0.0083), strict=True):
        assert abs(2.0 / pitch - 2.0 / wanted) < 0.1


def test_friction_turns_round_with_the_motion(monkeypatch: pytest.MonkeyPatch) -> None:
    rest = np.sign(SPEED) * wave(0.05)
    found = told(monkeypatch, rest, along=True)
    assert abs(2.0 / found[0] - 40.0) < 0.1
    # Of the force itself the two ways cancel.
    assert all(abs(2.0 / p - 40.0) > 1.0 for p in told(monkeypatch, rest))


@pytest.mark.parametrize(("periods", "there"), [(3.8, False), (4.2, True)])
def test_the_way_holds_a_pitch_four_times(
    periods: float, there: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert LEAST_PERIODS == 4.0
    found = told(monkeypatch, wave(2.0 / periods))
    assert (abs(2.0 / found[0] - periods) < 0.15) == there


@pytest.mark.parametrize(("bins", "there"), [(3.9, False), (4.1, True)])
def test_a_pitch_is_four_steps_of_the_way(
    bins: float, there: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert BINS_A_PITCH == 4.0
    found = told(monkeypatch, wave(bins * FINE_M))
    assert (abs(bins * FINE_M / found[0] - 1.0) < 1e-3) == there


def test_a_way_of_just_four_shortest_pitches_has_one(monkeypatch: pytest.MonkeyPatch) -> None:
    """Sixteen steps of the way, and a wave of four."""
    fine = 2.0**-10
    place = np.linspace(0.0, 16.0 * fine, 200)
    found = told(
        monkeypatch, wave(4.0 * fine, place=place), place=place, speed=np.ones(200), way=fine
    )
    assert found == (4.0 * fine,)
    less = np.nextafter(16.0 * fine, 0.0) / (16.0 * fine) * place
    assert (
        told(monkeypatch, wave(4.0 * fine, place=less), place=less, speed=np.ones(200), way=fine)
        == ()
    )


def test_each_line_is_of_what_the_higher_ones_leave(monkeypatch: pytest.MonkeyPatch) -> None:
    """A weak wave is lower than the slopes of either of two strong ones."""
    rest = wave(2.0 / 40.4, 3.0) + wave(2.0 / 90.4, 2.0) + wave(2.0 / 60.4, 0.03)
    found = told(monkeypatch, rest)
    assert [2.0 / pitch for pitch in found] == pytest.approx([40.4, 90.4, 60.4], abs=0.13)


@pytest.mark.parametrize("beside", [-2.5, 2.5])
def test_two_waves_are_two_where_they_are_two_lines_apart(
    beside: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    rest = wave(2.0 / 40.0) + wave(2.0 / (40.0 + beside), 0.4)
    found = told(monkeypatch, rest)
    assert 2.0 / found[0] == pytest.approx(40.0, abs=0.2)
    assert 2.0 / found[1] == pytest.approx(40.0 + beside, abs=0.4)


def test_a_pitch_is_told_by_steps_of_the_way_and_not_by_what_is_left_of_them(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A way of nearly 26 steps is taken for 25 of them."""
    fine = 2.0**-10
    place = np.linspace(0.0, 25.96 * fine, 400)
    rest = wave(5.0 * fine, place=place)
    found = told(monkeypatch, rest, place=place, speed=np.ones(400), way=fine)
    assert found[0] == pytest.approx(5.0 * fine, rel=0.01)


def test_without_a_way_no_pitch_is_too_long(monkeypatch: pytest.MonkeyPatch) -> None:
    run = record(0.02 * np.arange(10))
    campaign: Any = SimpleNamespace(prepared=[run], rig=Rig())
    for moving, longest in ((np.zeros(10, bool), np.inf), (np.arange(10) == 3, np.inf)):
        monkeypatch.setattr(module, "moving_samples", lambda campaign, at=moving: [at])
        assert longest_pitch(campaign) == longest


def test_beside_a_high_line_no_other_is_looked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    """A wave that grows along the way is a line with slopes: higher than another wave, and still
    one."""
    rest = PLACE * wave(0.05) + wave(0.011, 0.3)
    found = told(monkeypatch, rest)
    lines = [2.0 / pitch for pitch in found]
    assert lines[0] == pytest.approx(40.0, abs=0.2)
    assert lines[1] == pytest.approx(2.0 / 0.011, abs=0.2)
    assert all(abs(a - b) > 2.0 for i, a in enumerate(lines) for b in lines[:i])


def test_few_samples_or_a_short_way_have_no_pitch(monkeypatch: pytest.MonkeyPatch) -> None:
    few = PADDING * KNOTS
    assert few == 64
    for count, there in ((few - 1, False), (few, True)):
        place = FINE_M * np.arange(float(count))
        rest = wave(8.0 * FINE_M, place=place)
        assert bool(told(monkeypatch, rest, place=place, speed=np.ones(count))) == there
    for count, there in ((15, False), (17, True)):
        place = np.linspace(0.0, count * FINE_M, 200)
        rest = wave(4.05 * FINE_M, place=place)
        assert bool(told(monkeypatch, rest, place=place, speed=np.ones(200))) == there
    assert told(monkeypatch, np.zeros(4000)) == ()


def test_a_long_way_has_no_more_bins_than_are_held(monkeypatch: pytest.MonkeyPatch) -> None:
    """However short the way from sample to sample."""
    found = told(monkeypatch, wave(0.05), way=1e-9)
    assert abs(2.0 / found[0] - 40.0) < 0.1


def test_pitches_are_asked_once(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[bool] = []

    def counted(campaign: Any, along: bool) -> tuple[float, ...]:
        asked.append(along)
        return (1.0 + along,)

    monkeypatch.setattr(module, "_pitches", counted)

    class Campaign:
        """Anything that can be remembered."""

    campaign: Any = Campaign()
    for _ in range(2):
        assert pitches(campaign, along=False) == (1.0,)
        assert pitches(campaign, along=True) == (2.0,)
    assert asked == [False, True]


def test_a_wave_is_taken_out_by_least_squares() -> None:
    place = np.linspace(0.0, 1.0, 500)
    signal = wave(0.1, 3.0, place) + 0.5 * np.cos(2.0 * np.pi * place / 0.37)
    x = np.stack([np.cos(20.0 * np.pi * place), np.sin(20.0 * np.pi * place)], axis=1)
    assert _wave(signal, place, 0.1) == pytest.approx(x @ np.linalg.lstsq(x, signal, rcond=None)[0])


# ---- what is known without them ----------------------------------------------------------------


def test_means_go_by_the_way_of_the_motion() -> None:
    rows = np.array([[1.0, 2.0], [3.0, 6.0], [5.0, 5.0], [7.0, 7.0]])
    found = _less_means(rows, np.array([0.1, 0.2, -0.1, 0.0]))
    assert found.tolist() == [[-1.0, -2.0], [1.0, 2.0], [0.0, 0.0], [7.0, 7.0]]
    assert rows[0].tolist() == [1.0, 2.0]


def test_any_line_between_speeds_is_one_of_the_hats() -> None:
    """Eight quantiles of the speeds of each way; all of a way's hats together are one."""
    speed = np.concatenate((np.linspace(0.01, 0.2, 300), -np.linspace(0.02, 0.5, 300)))
    knots = _knots(speed)
    assert [way for way, _ in knots] == [-1.0, 1.0]
    for (way, places), own in zip(knots, (speed[300:], speed[:300]), strict=True):
        assert places == pytest.approx(np.quantile(own, np.linspace(0.0, 1.0, KNOTS)))
        assert np.all(np.sign(places) == way)
    hats = np.stack(_hats(speed, knots), axis=1)
    assert hats.shape == (600, 16)
    assert hats[300:, :8].sum(axis=1) == pytest.approx(np.ones(300))
    assert hats[:300, 8:].sum(axis=1) == pytest.approx(np.ones(300))
    assert not hats[:300, :8].any()
    assert not hats[300:, 8:].any()
    line = np.where(speed > 0.0, 3.0 + 2.0 * speed, -1.0 - 7.0 * speed)
    assert hats @ np.linalg.lstsq(hats, line, rcond=None)[0] == pytest.approx(line)
    assert len(_knots(np.abs(speed))) == 1
    assert len(_knots(np.full(9, 0.1))[0][1]) == 1


def swinging(name: str, rate: float, force: Any, *, arm: float = 1.0) -> Any:
    """A run to and fro, whose force is told by place, speed and acceleration."""
    t = np.arange(0.0, 40.0, 0.02)
    v = 0.2 * np.sin(rate * t) + 0.1 * np.sin(1.618 * rate * t)
    a = 0.2 * rate * np.cos(rate * t) + 0.1618 * rate * np.cos(1.618 * rate * t)
    place = -0.2 / rate * np.cos(rate * t) - 0.1 / (1.618 * rate) * np.cos(1.618 * rate * t)
    p = record(t, name=name, velocity=v, way=place / arm, friction=force(place, v, a))
    p.motion.acceleration_m_s2 = a
    return p


def of(*prepared: Any, radius_m: float | None = None) -> Any:
    bearing = None if radius_m is None else SimpleNamespace(radius_m=radius_m)
    rig = SimpleNamespace(bearing=bearing, drive=None)
    return SimpleNamespace(prepared=prepared, samples=samples_of(prepared), rig=rig)


def plain(x: Array, v: Array, a: Array) -> Array:
    """A level each way, a viscous part, a mass, and what comes once a turn."""
    found: Array = 5.0 * np.sign(v) + 1.0 + 30.0 * v + 3.0 * a + 2.0 * np.sin(x + 0.3)
    return found


def test_of_speed_acceleration_and_turn_nothing_is_left() -> None:
    """Each run has levels of its own; a wave along the way stays."""

    def higher(x: Array, v: Array, a: Array) -> Array:
        return plain(x, v, a) + 4.0 * np.sign(v) - 2.0

    def waved(x: Array, v: Array, a: Array) -> Array:
        return plain(x, v, a) + 0.5 * np.cos(2.0 * np.pi * x / 0.01)

    campaign = of(swinging("a", 1.1, plain), swinging("b", 0.7, higher))
    place, rest, speed = _without_the_known(campaign)
    assert len(place) == len(rest) == len(speed) > 3000
    assert np.sqrt(np.mean(rest**2)) < 1e-6
    _, left, _ = _without_the_known(of(swinging("a", 1.1, waved), swinging("b", 0.7, higher)))
    assert np.sqrt(np.mean(left**2)) == pytest.approx(0.25, rel=0.1)


def test_places_of_a_shaft_are_on_its_surface() -> None:
    campaign = of(swinging("a", 1.1, plain, arm=0.05), radius_m=0.05)
    place, *_ = _without_the_known(campaign)
    linear = of(swinging("a", 1.1, plain))
    assert place == pytest.approx(_without_the_known(linear)[0])
    assert longest_pitch(campaign) == pytest.approx(longest_pitch(linear))
    assert longest_pitch(linear) == pytest.approx(np.ptp(place) / 4.0)
    assert _way_a_sample(campaign) == pytest.approx(_way_a_sample(linear))
    steps = np.abs(np.diff(linear.prepared[0].motion.angle_rad))
    assert _way_a_sample(linear) == pytest.approx(np.median(steps), rel=0.03)


def test_few_samples_are_taken_as_they_are() -> None:
    p = swinging("a", 1.1, plain)
    few = of(p)
    few.samples = samples_of([p], [np.arange(2000) < 50])
    place, rest, speed = _without_the_known(few)
    assert len(place) < 64
    assert rest == pytest.approx(
        plain(place, speed, p.motion.acceleration_m_s2[:50][-len(place) :])
    )


@pytest.mark.parametrize(
    ("motion", "pitch_m", "gear_ratio", "found"),
    [
        ("linear", 0.02, 4.0, (0.02, 0.005)),
        ("linear", 0.02, 1.0, (0.02,)),
        ("linear", None, 4.0, ()),
        ("rotary", None, 100.0, (0.02 * np.pi,)),
        ("rotary", None, 1.0, ()),
    ],
)
def test_turns_of_screw_and_motor_are_known(
    motion: str, pitch_m: float | None, gear_ratio: float, found: tuple[float, ...]
) -> None:
    drive = SimpleNamespace(motion=motion, pitch_m=pitch_m, gear_ratio=gear_ratio)
    rig: Any = SimpleNamespace(drive=drive)
    assert known_pitches(rig) == pytest.approx(found)
    assert known_pitches(Rig()) == ()
