"""Readings behind lines and rows of equal samples: polygons and clocks, each step of the search
against what a textbook or the record says."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from jbf.records.findings.interpolated import (
    PHASES,
    _as_rough_as_noise,
    _exact,
    _first_look,
    _longest,
    _looks,
    _noise,
    _of_short_period,
    _where_to_look,
    _whole_of,
    find_native,
    is_smooth,
)
from jbf.records.findings.polygon import lefts, polygon, sharpened
from jbf.records.findings.slow_channel import (
    _followed,
    _of_clock,
    _readings_before,
    _spread,
    find_repeated,
)

N = 600
TIME: Any = 0.02 * np.arange(N)
NOISE: Any = np.random.default_rng(1).standard_normal(4 * N)
PERIOD, PHASE = 0.057, 0.013


def drawn(period: float = PERIOD, phase: float = PHASE, time: Any = TIME) -> tuple[Any, Any, Any]:
    """A channel that was read at its own instants and drawn as lines: samples, ticks, readings."""
    ticks = time[0] + phase + period * np.arange(-1, int((time[-1] - time[0]) / period) + 3)
    read = 3.0 + 5.0 * np.sin(0.9 * ticks) + 0.4 * NOISE[: len(ticks)]
    return np.interp(time, ticks, read), ticks, read


VALUES, TICKS, READ = drawn()
_, TICKS_FINE, READ_FINE = drawn(1.083 * 0.02, 0.4 * 0.02)


def least_squares(time: Any, values: Any, period: float, phase: float) -> float:
    """What the best polygon leaves, by numpy: RMS a degree of freedom."""
    place = (time - time[0] - phase) / period
    low = np.floor(place).astype(int)
    share = place - low
    low -= low[0]
    design = np.zeros((len(time), low[-1] + 2))
    design[np.arange(len(time)), low] = 1.0 - share
    design[np.arange(len(time)), low + 1] += share
    seen = (design > 1e-3).any(axis=0)
    best, *_ = np.linalg.lstsq(design[:, seen], values, rcond=None)
    gap = values - design[:, seen] @ best
    return float(np.sqrt(np.sum(gap**2) / max(len(time) - int(seen.sum()), 1)))


def test_the_best_polygon_is_that_of_least_squares() -> None:
    """Its corners stand a period apart from the phase on; one that is true leaves nothing."""
    left, knots, corners = polygon(TIME, VALUES, PERIOD, PHASE)
    assert left < 1e-6
    np.testing.assert_allclose(np.diff(knots), PERIOD)
    assert ((knots - PHASE) / PERIOD)[0] == pytest.approx(round((knots[0] - PHASE) / PERIOD))
    inside = (knots > TIME[0]) & (knots < TIME[-1])
    np.testing.assert_allclose(corners[inside], np.interp(knots[inside], TICKS, READ), atol=1e-5)
    assert knots[0] <= TIME[0]
    assert knots[-1] >= TIME[-1]
    for period, phase in ((0.057, 0.03), (0.08, 0.0), (0.11, 0.05), (1.3, 0.4)):
        wanted = least_squares(TIME, VALUES, period, phase)
        assert polygon(TIME, VALUES, period, phase)[0] == pytest.approx(wanted, rel=1e-4)
    periods, phases = np.array([0.057, 0.08, 0.11] * 40), np.array([0.03, 0.0, 0.05] * 40)
    each = lefts(TIME, VALUES, periods, phases)
    assert each.shape == (120,)
    one = [least_squares(TIME, VALUES, p, q) for p, q in zip(periods[:3], phases[:3], strict=True)]
    np.testing.assert_allclose(each, one * 40, rtol=1e-4)
    later = polygon(TIME + 100.0, VALUES, PERIOD, PHASE)
    np.testing.assert_allclose(later[1], knots + 100.0)


def test_a_corner_that_no_sample_is_near_is_not_known() -> None:
    """In a gap of the record."""
    kept = (TIME < 4.0) | (TIME > 5.0)
    _, knots, corners = polygon(TIME[kept], VALUES[kept], PERIOD, PHASE)
    gap = (knots > 4.0 + PERIOD) & (knots < 5.0 - PERIOD)
    assert gap.sum() > 10
    assert np.isnan(corners[gap]).all()
    known = (knots > 0.0) & (knots < 4.0 - PERIOD)
    np.testing.assert_allclose(corners[known], np.interp(knots[known], TICKS, READ), atol=1e-4)


@pytest.mark.parametrize("near", [False, True])
def test_a_period_that_is_nearly_right_is_sharpened(near: bool) -> None:
    """To a small fraction of what it was off, which is what the length of the record allows."""
    off = 0.05 * PERIOD**2 / TIME[-1]
    period, phase = sharpened(TIME, VALUES, PERIOD + off, PHASE + 0.02 * PERIOD, near=near)
    assert abs(period - PERIOD) < 0.02 * off
    assert abs(phase - PHASE) < 0.02 * 0.02 * PERIOD
    assert lefts(TIME, VALUES, np.array([period]), np.array([phase]))[0] < 0.02


def test_noise_of_a_window_is_that_of_its_usual_bends() -> None:
    """Not of one jump; none of a straight line, nor below the digits."""
    white = NOISE[:400]
    assert _noise(white, 0.0) == pytest.approx(1.0, rel=0.15)
    alternating = np.where(np.arange(40) % 2, 1.0, -1.0)
    assert _noise(alternating, 0.0) == pytest.approx(4.0 / np.sqrt(6.0))
    jump = 1e-3 * alternating + np.where(np.arange(40) < 20, 0.0, 50.0)
    assert _noise(jump, 0.0) == pytest.approx(3.0 * 4e-3 / 0.6745 / np.sqrt(6.0))
    assert _noise(2.0 * TIME[:40], 1e-9) == 0.0
    assert _noise(alternating, 1.6) > 0.0
    assert _noise(alternating, 1.7) == 0.0


def test_a_polygon_may_leave_next_to_nothing_or_what_digits_do() -> None:
    """Half a percent of the noise; three times the rounding, up to a twentieth of the noise."""
    fine = np.array([1.0 + 1e-9, 3.0 / 7.0, 2.0])
    assert _exact(fine, 2.0) == pytest.approx(0.01)
    coarse = np.array([1.1, 2.0, 3.7])
    assert _exact(coarse, 2.0) == pytest.approx(0.3 / np.sqrt(12.0))
    assert _exact(coarse, 1.0) == pytest.approx(0.05)


def test_first_looks_are_along_the_record_and_where_it_bends() -> None:
    """Three and three; of a record that bends everywhere but the first."""
    assert _where_to_look(NOISE[:600], 1e-9) == [0, 280, 560]
    flat = np.zeros(600)
    flat[105:125] = NOISE[:20]
    flat[405:415] = NOISE[:10]
    found = _where_to_look(flat, 1e-9)
    assert found[:3] == [0, 280, 560]
    assert found[3] <= 104
    assert found[3] + 40 >= 126
    assert found[4] <= 404
    assert found[4] + 40 >= 416
    assert len(found) == len({*found})


def test_what_is_as_rough_as_noise_was_not_drawn() -> None:
    """Neighbours differ as much as samples far apart."""
    assert _as_rough_as_noise(NOISE[:600])
    assert not _as_rough_as_noise(VALUES)
    slow = np.cumsum(NOISE[:600])
    assert not _as_rough_as_noise(slow)


def test_a_curve_has_smaller_third_than_second_differences() -> None:
    """By half; of noise the third are larger."""
    assert is_smooth(np.sin(0.1 * np.arange(400)))
    assert not is_smooth(NOISE[:400])
    wave = np.sin(0.7 * np.arange(4000))
    # Of a sine they are 2 sin(0.35) times the second, 0.69.
    assert not is_smooth(wave)
    assert is_smooth(wave, 0.72)
    assert not is_smooth(wave, 0.66)


def test_a_first_look_finds_the_period_of_a_window() -> None:
    """Among the best; the same whether its grid is kept or made anew for uneven samples."""
    t, y = TIME[100:140], VALUES[100:140]
    found = _first_look(t, y, 0.02, _noise(y, 1e-6))
    assert 0 < len(found) <= 8
    # Half of it fits as well.
    true = [(p, q) for p, q in found if abs(p / PERIOD - 1.0) < 0.03]
    assert true
    off = (t[0] + true[0][1] - PHASE) / PERIOD
    assert abs(off - round(off)) < 0.15
    bent = t + np.where(np.arange(40) == 20, 1e-4, 0.0)
    again = _first_look(bent, np.interp(bent, TICKS, READ), 0.02, _noise(y, 1e-6))
    assert again[0] == pytest.approx(found[0], rel=0.02)
    assert _first_look(t, NOISE[:40], 0.02, 1.0) == []


def test_looks_span_the_polygons_of_each_period_and_phase() -> None:
    """Orthonormal rows, ten phases a period, at least six samples more than corners."""
    place = np.arange(40.0)
    looks = _looks(place)
    counts = np.diff(np.append(looks.begins, len(looks.basis)))
    assert len(looks.begins) == len(PHASES) * len(looks.periods)
    assert looks.free.min() >= 6
    np.testing.assert_array_equal(40 - counts[:: len(PHASES)], looks.free)
    for k in (0, 57, len(looks.begins) - 1):
        rows = looks.basis[looks.begins[k] : looks.begins[k] + counts[k]]
        np.testing.assert_allclose(rows @ rows.T, np.eye(counts[k]), atol=1e-9)
        period, phase = looks.periods[k // len(PHASES)], PHASES[k % len(PHASES)]
        # A polygon with corners there lies in their span; a line does in any.
        knots = (np.arange(-1, 60) + phase) * period
        inside = np.interp(place, knots, NOISE[:61])
        np.testing.assert_allclose(rows.T @ (rows @ inside), inside, atol=1e-8)
        np.testing.assert_allclose(rows.T @ (rows @ place), place, atol=1e-8)


@pytest.mark.parametrize("times", [1, 2, 3, 5, 6])
def test_a_fraction_of_the_period_is_not_the_readings(times: int) -> None:
    """Of corners at a half, a third, ... of the true ones the true ones are taken."""
    slow, ticks, read = drawn(0.23, 0.05)
    noise = _noise(slow[:80], 1e-6)
    period, phase = _longest(TIME, slow, 0.23 / times, 0.05, noise)
    assert period == pytest.approx(0.23, rel=1e-4)
    assert ((phase - 0.05) / 0.23 + 0.5) % 1.0 == pytest.approx(0.5, abs=1e-3)
    native = find_native(TIME, slow)
    assert native is not None
    assert native.period_s == pytest.approx(0.23, rel=1e-4)
    np.testing.assert_allclose(native.values, np.interp(native.time_s, ticks, read), atol=1e-2)


def test_the_corners_of_a_record_are_readings_or_none() -> None:
    """Those within it; not of a curve, a line, or with another phase that fits as well."""
    noise = _noise(VALUES[:80], 1e-6)
    native = _whole_of(TIME, VALUES, PERIOD, PHASE, noise)
    assert native is not None
    assert native.period_s == PERIOD
    assert native.time_s[0] >= TIME[0]
    assert native.time_s[-1] <= TIME[-1]
    inside = np.flatnonzero(TICKS >= 0.0)[: len(native.time_s)]
    np.testing.assert_allclose(native.time_s, TICKS[inside])
    np.testing.assert_allclose(native.values, READ[inside], atol=1e-4)
    assert _whole_of(TIME, VALUES, PERIOD, PHASE + 0.01, noise) is None
    smooth = np.interp(TIME, TICKS, np.sin(0.9 * TICKS))
    assert _whole_of(TIME, smooth, PERIOD, PHASE, 1.0) is None
    assert _whole_of(TIME, 2.0 * TIME, PERIOD, PHASE, 1.0) is None
    close, _, _ = drawn(0.0205, 0.004)
    assert _whole_of(TIME, close, 0.0205, 0.004, noise) is None


def test_a_record_that_is_short_or_its_own_has_no_readings_behind_it() -> None:
    """Eighty samples at least; white noise, a curve and a straight line are a channel's own."""
    assert find_native(TIME[:79], VALUES[:79]) is None
    found = find_native(TIME[:300], VALUES[:300])
    assert found is not None
    assert found.period_s == pytest.approx(PERIOD, rel=1e-4)
    for own in (NOISE[:N], np.sin(TIME), TIME):
        assert find_native(TIME, own) is None


@pytest.mark.parametrize(("samples", "there"), [(479, False), (480, True), (600, True)])
def test_a_channel_that_is_hardly_slower_is_looked_for_in_a_longer_window(
    samples: int, there: bool
) -> None:
    """In the middle of a record of at least twice its length."""
    time = TIME[:samples]
    values, _, _ = drawn(1.083 * 0.02, 0.4 * 0.02, time)
    found = _of_short_period(time, values, 0.02)
    assert (found is not None) == there
    if found is not None:
        assert found.period_s == pytest.approx(1.083 * 0.02, rel=1e-5)
        # It bends in the middle third alone.
        quiet = np.where(np.abs(TICKS_FINE - 6.0) < 2.0, READ_FINE, 3.0)
        middle = np.interp(TIME, TICKS_FINE, quiet)
        assert _of_short_period(TIME, middle, 0.02) is not None


def repeated(period: float = 2.7, rows: int = 200, phase: float = 0.4) -> tuple[Any, Any, Any]:
    """A channel of a slow clock that stands still between readings: samples, instants, readings."""
    time: Any = 0.01 * np.arange(int(rows * period))
    ticks = 0.01 * (phase - period + period * np.arange(rows + 2))
    read = 5.0 * np.sin(3.0 * ticks) + NOISE[: len(ticks)]
    last = np.searchsorted(ticks, time, side="right") - 1
    return time, read[last], (ticks, read)


def test_readings_that_stand_until_the_next_are_found() -> None:
    """With the clock that made them; not of few rows, few repeats, or an uneven record."""
    time, values, (ticks, read) = repeated()
    found = find_repeated(time, values)
    assert found is not None
    assert found.period_s == pytest.approx(0.027, rel=1e-4)
    assert len(found.time_s) == len(found.values)
    which = np.round((found.time_s - ticks[0]) / 0.027).astype(int)
    np.testing.assert_array_equal(found.values, read[which])
    np.testing.assert_allclose(found.time_s, ticks[which], atol=0.005)
    for rows, there in ((38, False), (45, True)):
        short, still, _ = repeated(rows=rows)
        assert (find_repeated(short, still) is not None) == there
    bent = time.copy()
    bent[100] += 2e-5
    assert find_repeated(bent, values) is None
    bent[100] -= 1.5e-5
    assert find_repeated(bent, values) is not None
    for period, there in ((1.01, False), (1.06, True)):
        fast, still, _ = repeated(period, rows=500)
        assert (find_repeated(fast, still) is not None) == there
    rows_of_chance = np.repeat(NOISE, 1 + (NOISE > 0.3) + 2 * (NOISE > 1.0))[: len(time)]
    assert find_repeated(time, rows_of_chance) is None


def test_rows_begin_within_a_step_after_the_ticks_of_a_clock() -> None:
    """Equal readings begin none; the clock's phase is in the middle of what rows allow."""
    time, values, (ticks, _) = repeated()
    first = np.flatnonzero(np.diff(values) != 0.0) + 1
    begins = time[first]
    count = np.arange(len(first))
    whole = _of_clock(time, values, begins, count, 0.01)
    assert whole is not None
    keep = np.setdiff1d(count, [3, 4, 50])
    some = _of_clock(time, values, begins[keep], keep, 0.01)
    assert some is not None
    np.testing.assert_allclose(some.time_s, whole.time_s, atol=1e-3)
    assert len(some.time_s) == len(whole.time_s)
    assert np.abs(whole.time_s[:, None] - ticks[None, :]).min(axis=1).max() < 0.005
    late = begins.copy()
    late[100] += 0.01
    assert _of_clock(time, values, late, count, 0.01) is None


def test_rows_as_seen_from_a_clock_lie_within_so_many_steps() -> None:
    """The shortest arc that holds all of them, wherever it begins."""
    begins = np.array([0.0, 10.2, 20.1, 29.9])
    spread = _spread(begins, np.array([10.0, 5.0, 7.0]))
    assert spread[0] == pytest.approx(0.3)
    assert spread[1] == pytest.approx(0.3)
    phases = np.sort(np.mod(begins, 7.0))
    gaps = np.append(np.diff(phases), phases[0] + 7.0 - phases[-1])
    assert spread[2] == pytest.approx(7.0 - gaps.max())


def test_readings_before_each_row_are_counted_by_the_longest_clock_that_will_do() -> None:
    """Whether or not some of them are equal; none of rows at no steady clock's."""
    every = np.ceil(0.3 + 3.7 * np.arange(400))
    keep = NOISE[:400] < 0.8
    keep[0] = True
    numbers = np.flatnonzero(keep)
    found = _readings_before(every[keep])
    assert found is not None
    np.testing.assert_array_equal(found, numbers)
    random = np.cumsum(np.ceil(np.random.default_rng(3).exponential(4.0, 400)))
    assert _readings_before(random) is None
    followed = _followed(every[keep], 100, 3.7)
    np.testing.assert_array_equal(followed, numbers)
    assert _followed(every[keep], 100, 3.9) is None
