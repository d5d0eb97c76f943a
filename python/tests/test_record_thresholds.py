"""Thresholds and sizes of what is found in a record, to a few percent: records that alternate have
noise of a known size, to the digit."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from jbf.records.findings.glitches import glitches
from jbf.records.findings.interpolated import PERIODS, PHASES, SHORT
from jbf.records.findings.pushing import _with_way
from jbf.records.findings.saturation import saturated
from jbf.records.findings.slow_channel import (
    LONGEST,
    SHORTEST,
    _readings_before,
    find_repeated,
)
from jbf.records.findings.steps import step_of
from jbf.records.motion import lateness
from jbf.records.motion.compared import Compared
from jbf.records.motion.held_path import mend_held
from jbf.records.motion.jitter import shaken_path, uneven_stamps
from jbf.records.motion.lateness import _lateness
from jbf.records.motion.position import Position
from jbf.records.motion.ratio import _middle
from jbf.records.motion.roughness import local_noise
from jbf.records.motion.speed_zero import speed_zero

DT = 0.01
TIME: Any = DT * np.arange(900)
EVERY: Any = np.where(np.arange(1000) % 2, -1.0, 1.0)
STAIRS: Any = np.cumsum(np.tile([0.0, 1.0, 0.0, -1.0], 250))
"""Every bend is one."""
NOISE: Any = np.random.default_rng(1).standard_normal(1200)


@pytest.mark.parametrize("size", [1.2e-4, 1e-3])
def test_stamps_that_alternate_are_off_by_their_size(size: float) -> None:
    """Fourth differences of them are sixteen times that; of white noise, the root of 70."""
    found = uneven_stamps("a", DT * np.arange(1000) + size * EVERY)
    assert found is not None
    assert found.size == pytest.approx(16.0 * size / 0.6745 / np.sqrt(70.0))


@pytest.mark.parametrize(("share", "there"), [(0.97, False), (1.03, True)])
def test_stamps_are_off_by_a_hundredth_of_a_step_or_more(share: float, there: bool) -> None:
    """Less is not worth a word."""
    size = share * 0.01 * DT * 0.6745 * np.sqrt(70.0) / 16.0
    assert (uneven_stamps("a", DT * np.arange(1000) + size * EVERY) is not None) == there


def shaken(
    late_s: float,
    *,
    slow_noise: float = 0.0,
    levels: Any = (0.1, 0.45, 1.0),
    times: Any = (1.0, 1.0, 1.0),
) -> Any:
    """A path at three speeds that was read to and fro off its stamps, at each by so many times."""
    speed: Any = np.repeat(np.array(levels), 300)
    path: Any = np.concatenate(([0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * DT)))
    off = (late_s * np.repeat(np.array(times), 300) * speed + slow_noise) * EVERY[:900]
    return shaken_path("a", TIME, path + off, speed), path + off


def test_a_path_that_alternates_was_read_off_its_stamps_by_so_much() -> None:
    """Fifth differences are 32 times that; of white noise, the root of 252. What it is where the
    shaft is slow is taken off."""
    late = 2e-3
    for slow_noise in (0.0, 5e-5):
        found, path = shaken(late, slow_noise=slow_noise)
        assert found is not None
        unit = 32.0 / 0.6745 / np.sqrt(252.0)
        floor = np.min(np.abs(np.diff(path))) / np.sqrt(12.0)
        slow = max(unit * (0.1 * late + slow_noise), floor)
        fast = unit * (late + slow_noise)
        assert found.size == pytest.approx(np.sqrt(fast**2 - slow**2), rel=1e-3)


@pytest.mark.parametrize(
    ("levels", "there"),
    [((0.1, 0.45, 1.0), True), ((0.1, 0.1, 1.0), False),
     ((0.1, 0.28, 1.0), False), ((0.1, 0.55, 0.55), False), ((0.1, 0.62, 1.0), False)],
)  # fmt: skip
def test_a_path_is_asked_at_half_and_at_full_speed(levels: Any, there: bool) -> None:
    """From 0.3 to 0.6 of the top, and beyond."""
    assert (shaken(2e-3, levels=levels)[0] is not None) == there


@pytest.mark.parametrize(("share", "there"), [(0.072, True), (0.078, False)])
def test_noise_at_speed_is_thrice_what_it_is_where_the_shaft_is_slow(
    share: float, there: bool
) -> None:
    """At half speed 0.45 + s of it, at a tenth 0.1 + s: thrice as much up to s = 0.075."""
    assert (shaken(2e-3, slow_noise=share * 2e-3)[0] is not None) == there


@pytest.mark.parametrize(("times", "there"), [(1.57, True), (1.63, False), (0.64, True),
                                              (0.61, False)])  # fmt: skip
def test_jitter_is_one_at_all_speeds(times: float, there: bool) -> None:
    """To a factor of 1.6, either way."""
    assert (shaken(2e-3, times=(0.0, times, 1.0))[0] is not None) == there


@pytest.mark.parametrize(("times", "there"), [(7.8, False), (8.2, True)])
def test_a_reading_sticks_out_by_eight_of_its_noises(times: float, there: bool) -> None:
    """Bends are the root of six times white noise."""
    values = STAIRS.copy()
    values[502] += times / 0.6745 / np.sqrt(6.0)
    assert glitches(values).any() == there


@pytest.mark.parametrize(("times", "there"), [(6.2, False), (6.6, True)])
def test_where_it_is_quiet_eight_tenths_of_the_usual_noise_count(times: float, there: bool) -> None:
    """Beside readings that stand still there is none."""
    values = np.concatenate((STAIRS[:400], 1e-3 * STAIRS[:200], STAIRS[:400]))
    values[502] += times / 0.6745 / np.sqrt(6.0)
    assert glitches(values).any() == there


@pytest.mark.parametrize(("times", "there"), [(2.9, False), (3.1, True)])
def test_a_reading_sticks_out_by_three_usual_changes(times: float, there: bool) -> None:
    """Of a force that grows by one from sample to sample."""
    values = np.arange(1000.0) + 1e-6 * NOISE[:1000]
    values[500] += 1.0 + times
    assert glitches(values).any() == there


def left_out(x: Any, y: Any, parts: int = 12) -> tuple[Any, Any]:
    """Coefficients by least squares, and the error of each from parts left out in turn."""
    part = np.arange(len(y)) * parts // len(y)
    whole = np.linalg.lstsq(x, y, rcond=None)[0]
    each = [np.linalg.lstsq(x[part != k], y[part != k], rcond=None)[0] for k in range(parts)]
    return whole, np.std(each, axis=0) * np.sqrt(parts - 1)


def test_errors_are_those_of_a_dozen_parts_left_out() -> None:
    """Of the force that turns with the motion, and of how late a speed is."""
    way = np.where(np.arange(1200) % 100 < 50, 1.0, -1.0)
    x = np.stack([way, np.ones(1200), np.sin(0.1 * np.arange(1200))], axis=1)
    y = 2.0 * way + 5.0 + NOISE
    found, error = _with_way(x, y)
    wanted, errors = left_out(x, y)
    assert found == pytest.approx(wanted[0])
    assert error == pytest.approx(errors[0])
    v, a = np.sin(0.03 * np.arange(1200)), np.cos(0.05 * np.arange(1200))
    seen = 0.97 * v - 0.02 * a + 0.1 * NOISE
    late, error = _lateness(Compared(v, seen, a, 0.0))
    wanted, errors = left_out(np.stack([v, a], axis=1), seen)
    assert late == pytest.approx(-wanted[1])
    assert error == pytest.approx(errors[1])


@pytest.mark.parametrize(("alike", "told"), [(0.88, True), (0.92, False)])
def test_a_speed_and_an_acceleration_that_are_alike_tell_no_lateness(
    alike: float, told: bool
) -> None:
    """Nine tenths of one another, of either sign."""
    v = np.where(np.arange(1200) % 2, 1.0, -1.0)
    other = np.where(np.arange(1200) % 4 < 2, 1.0, -1.0)
    for sign in (1.0, -1.0):
        a = sign * (alike * v + np.sqrt(1.0 - alike**2) * other)
        found = _lateness(Compared(v, v - 0.01 * a, a, 0.0))
        assert np.isfinite(found[1]) == told
        assert found[0] == (pytest.approx(0.01) if told else 0.0)


def test_the_middle_ratio_and_its_spread_are_those_of_fast_motion() -> None:
    """Half the range of its middle half, and what a count makes of a usual speed."""
    fast = np.repeat([1.0, -2.0], 30)
    ratios = np.tile([1.0, 2.0, 3.0, 4.0, 5.0], 12)
    slow = np.full(40, 0.25)
    by_speed = np.concatenate((fast, slow))
    by_path = np.concatenate((fast * ratios, 99.0 * slow))
    middle, spread = _middle(Compared(by_path, by_speed, by_speed, 0.3))
    assert middle == 3.0
    assert spread == pytest.approx(1.0 + 0.3 / 1.5)
    few = np.concatenate((np.ones(19), np.full(2, 0.1)))
    assert _middle(Compared(few, few, few, 0.0)) == (1.0, np.inf)
    enough = np.concatenate((np.ones(20), np.full(2, 0.1)))
    assert _middle(Compared(enough, enough, enough, 0.0)) == (1.0, 0.0)


def test_periods_are_looked_for_from_a_sample_to_twenty_five() -> None:
    """Closely where a window has many of them; all phases a tenth of a period apart."""
    assert PERIODS[0] == pytest.approx(1.2)
    assert 24.5 < PERIODS[-1] < 25.0
    apart = np.diff(np.log(PERIODS))
    assert apart[PERIODS[1:] < 8.0].max() == pytest.approx(0.005)
    assert apart[PERIODS[:-1] > 8.0].max() == pytest.approx(0.02)
    assert apart.min() > 0.0
    np.testing.assert_allclose(PHASES, np.arange(10) / 10.0)
    assert SHORT[0] == pytest.approx(1.05)
    assert 1.299 < SHORT[-1] < 1.3
    np.testing.assert_allclose(np.diff(np.log(SHORT)), 0.0005)


@pytest.mark.parametrize(
    ("period", "there"), [(1.9, False), (2.2, True), (17.3, True), (57.3, True), (63.0, False)]
)
def test_clocks_of_two_to_sixty_samples_are_looked_for(period: float, there: bool) -> None:
    """Where some of their readings are equal."""
    assert (SHORTEST, LONGEST) == (2.0, 60.0)
    numbers = np.flatnonzero(np.arange(160) % 5 != 3)
    found = _readings_before(np.ceil(0.3 + period * numbers))
    assert (found is not None and np.array_equal(found, numbers)) == there


@pytest.mark.parametrize(("count", "there"), [(4, False), (5, True)])
@pytest.mark.parametrize("way", [1.0, -1.0])
def test_five_readings_at_one_extreme_are_its_end(count: int, there: bool, way: float) -> None:
    """Either end; fewer are a noise's."""
    values = 10.0 * np.sin(0.01 * np.arange(1200)) + 0.3 * NOISE
    values[100 : 100 + 40 * count : 40] = way * 20.0
    assert (saturated(values)[1] == [way * 20.0]) == there


def clocked(rows: int) -> Any:
    """Rows of a slow clock, so many of them beginning within the record."""
    begins = np.ceil(0.3 + 2.7 * np.arange(rows + 1)).astype(int)
    values = np.repeat(NOISE[: rows + 1], np.diff(np.append(begins, begins[-1] + 2)))
    return DT * np.arange(len(values)), values


@pytest.mark.parametrize(("rows", "there"), [(39, False), (40, True)])
def test_forty_rows_tell_a_clock(rows: int, there: bool) -> None:
    """That begin after the first."""
    assert (find_repeated(*clocked(rows)) is not None) == there


def end_of(top: int, below: dict[int, int]) -> bool:
    """Whether so many readings at an extreme are an end, with so many at levels next to it."""
    values = 10.0 * np.sin(0.01 * np.arange(1200)) + 0.3 * NOISE
    places = iter(range(50, 1200, 11))
    for level in (1, 2, 3, 4):
        for _ in range(below.get(level, 1)):
            values[next(places)] = 20.0 - 0.1 * level
    for _ in range(top):
        values[next(places)] = 20.0
    return saturated(values)[1] == [20.0]


@pytest.mark.parametrize(
    ("top", "below", "there"),
    [
        (5, {}, True),
        (5, {1: 3}, False),
        (6, {1: 3}, True),
        (7, {2: 4}, False),
        (8, {3: 4}, True),
        (7, {3: 4}, False),
        (5, {4: 12}, True),
    ],
)
def test_an_end_has_twice_as_many_readings_as_the_next_three_levels(
    top: int, below: dict[int, int], there: bool
) -> None:
    """Tails of a noise thin out; what lies further in may be anything."""
    assert end_of(top, below) == there


@pytest.mark.parametrize(("noise", "there"), [(0.3, False), (0.75, True)])
def test_a_plateau_of_a_coarse_converter_is_no_end(noise: float, there: bool) -> None:
    """Where its noise is less than six tenths of its step."""
    values = np.round(np.clip(10.0 * np.sin(0.01 * np.arange(1200)) + noise * NOISE, -8.0, 8.0))
    assert (saturated(values)[1] != []) == there


@pytest.mark.parametrize(("apart", "step"), [(1.14, 1.0), (1.16, 0.0)])
def test_levels_are_whole_steps_apart_but_for_crumbs(apart: float, step: float) -> None:
    """A fifth of them off by so much: three hundredths of five steps are allowed."""
    levels = np.cumsum(np.where(np.arange(40) % 5 == 4, apart, 1.0))
    assert step_of(np.repeat(levels, 10)) == step


@pytest.mark.parametrize(("share", "step"), [(0.08, 1.0), (0.12, 0.0)])
def test_nine_of_ten_levels_are_whole_steps_apart(share: float, step: float) -> None:
    """A few may be anywhere."""
    levels = np.cumsum(np.where(np.arange(100) < 100 * share, 1.4, 1.0))
    assert step_of(np.repeat(levels, 10)) == step


@pytest.mark.parametrize(("times", "there"), [(5.9, False), (6.1, True)])
def test_a_speed_is_late_by_six_of_its_errors(
    times: float, there: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of the windows that tell it most sharply."""
    found = iter([(9.0, 9.0), (times * 0.01, 0.01), (5.0, 4.0)])
    monkeypatch.setattr(lateness, "compared", lambda *_: [None, None, None])
    monkeypatch.setattr(lateness, "_lateness", lambda _: next(found))
    told = lateness.late_speed("a", TIME, TIME, TIME)
    assert (told is not None) == there
    assert told is None or told.size == pytest.approx(times * 0.01)


@pytest.mark.parametrize(("times", "there"), [(2.9, False), (3.1, True)])
def test_noise_is_uneven_where_it_is_thrice_the_usual(times: float, there: bool) -> None:
    """Locally; else it is one number."""
    loud = np.where((np.arange(1000) > 400) & (np.arange(1000) < 700), times, 1.0)
    found = local_noise(loud * EVERY)
    assert isinstance(found, np.ndarray) == there
    if isinstance(found, np.ndarray):
        unit = 8.0 / 0.6745 / np.sqrt(20.0)
        assert found[550] == pytest.approx(times * unit)
        assert found[100] == pytest.approx(unit)


def standstill(zero: float, noise: float, still: int) -> bool:
    """Whether a speed of so much, to and fro by so much, at a standstill has its zero off."""
    at_rest = (np.arange(900) >= 300) & (np.arange(900) < 300 + still)
    speed = np.where(at_rest, 0.0, 0.1)
    path = np.cumsum(speed) * DT
    read = np.where(at_rest, zero + noise * EVERY[:900], 0.1)
    return speed_zero("a", TIME, path, read, 1e-7, "m/s")[2] is not None


@pytest.mark.parametrize(("times", "there"), [(4.9, False), (5.1, True)])
def test_a_zero_is_off_by_five_of_its_errors(times: float, there: bool) -> None:
    """Of means over twenty samples each: neighbours are not independent."""
    # The last sample in motion ends where the rest is.
    error = 1e-4 / np.sqrt(201.0 / 20.0)
    assert standstill(times * error, 1e-4, 200) == there


@pytest.mark.parametrize(("counts", "there"), [(4.9, False), (5.1, True)])
def test_a_path_is_held_while_the_shaft_moves_on_by_five_counts(counts: float, there: bool) -> None:
    """Of the encoder."""
    path = 1e-3 * np.arange(900.0)
    path[101:105] = path[100]
    path[0] = path[1] - 4e-3 / counts
    position = Position(path, "position_m", "m", 1.0)
    found = mend_held("a", TIME, position, np.full(900, 0.1))[1]
    assert (found is not None) == there
