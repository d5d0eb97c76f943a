"""Rests: where one begins and ends, where it is placed, what is beside it; each by hand."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from jbf.records.motion.rests import (
    _reverses,
    backward_beside_rest,
    place_rests,
    rest_edges,
    resting_samples,
    still_samples,
    unsure_beside_rest,
    without_swings,
)


def places(mask: Any) -> list[int]:
    return [int(i) for i in np.flatnonzero(mask)]


def bits(text: str) -> Any:
    """A mask of ones and zeros."""
    return np.array([c == "1" for c in text])


def test_three_zero_speeds_in_a_row_are_a_rest() -> None:
    """At either end of a record, too; two are a crossing."""
    v = np.array([0, 0, 0, 1, 0, 0, 1, 0, 0, 0, 0, -1, 0, 0, 0], dtype=float)
    assert places(resting_samples(v)) == [0, 1, 2, 7, 8, 9, 10, 12, 13, 14]
    assert not resting_samples(np.array([0.0, 0.0])).any()
    assert not resting_samples(np.array([1e-300, 0.0, 0.0])).any()
    assert len(resting_samples(np.array([]))) == 0


STEP = 1e-4


def stop(still: int, *, hum: float = 0.0, off: float = 0.0) -> tuple[Any, Any, Any]:
    """60 samples at 0.1 m/s, so many at rest with a speed that hums to and fro, and 60 on."""
    n = 120 + still
    time: Any = 0.01 * np.arange(n)
    rest = (np.arange(n) >= 60) & (np.arange(n) < 60 + still)
    speed = np.where(rest, hum * np.where(np.arange(n) % 2, 1.0, -1.0) + off, 0.1)
    path = np.cumsum(np.where(rest, 0.0, 1e-3))
    return time, path, speed


@pytest.mark.parametrize(("still", "rests"), [(19, False), (20, True), (40, True)])
def test_twenty_samples_within_a_step_of_the_encoder_are_a_rest(still: int, rests: bool) -> None:
    """Their speeds are, too; one less may be anything."""
    time, path, speed = stop(still)
    found = still_samples(time, path, speed, STEP)
    assert places(found) == (list(range(60, 60 + still)) if rests else [])


def test_a_hum_of_a_rest_is_a_small_share_of_the_top_speed() -> None:
    """Five thousandths of it, or what is known to be a rest's hum."""
    time, path, speed = stop(40, hum=0.99 * 5e-3 * 0.1)
    assert places(still_samples(time, path, speed, STEP)) == list(range(60, 100))
    time, path, speed = stop(40, hum=1.01 * 5e-3 * 0.1)
    assert not still_samples(time, path, speed, STEP).any()
    assert places(still_samples(time, path, speed, STEP, hum=1e-3)) == list(range(60, 100))


def test_a_path_may_seem_to_go_a_step_and_a_half() -> None:
    """As an encoder at an edge between two counts; further is a motion."""
    time, path, speed = stop(38, hum=1e-4)
    for size, rests in ((1.4, True), (1.6, False)):
        moved = path.copy()
        moved[79:] += size * STEP
        found = still_samples(time, moved, speed, STEP)
        # Beyond it neither half is long enough by itself.
        assert found[70:90].any() == rests
    assert not still_samples(time, path, speed, 0.0)[:60].any()
    assert len(still_samples(time[:19], path[:19], 0.0 * path[:19], STEP)) == 19
    assert not still_samples(time[:19], 0.0 * path[:19], 0.0 * path[:19], STEP).any()
    assert still_samples(time[:20], 0.0 * path[:20], 0.0 * path[:20], STEP).all()
    assert not still_samples(time, path, np.full(len(path), 0.1), STEP).any()


def test_a_speed_that_stands_out_of_the_hum_where_a_rest_ends_is_the_motions() -> None:
    """Nine times the usual one of the rest; within the rest it stays."""
    time, path, speed = stop(40, hum=1e-5)
    for at in (60, 99, 80):
        loud = speed.copy()
        loud[at] = 1e-4
        found = still_samples(time, path, loud, STEP)
        assert places(found) == [i for i in range(60, 100) if i != at or at == 80]
        loud[at] = 8e-5
        assert places(still_samples(time, path, loud, STEP)) == list(range(60, 100))
        loud[at] = 1e-4
        assert places(still_samples(time, path, loud, STEP, hum=1e-4)) == list(range(60, 100))


def test_a_reversal_stays_within_a_step_as_long_as_its_acceleration_has_it() -> None:
    """Twice that is a rest; at speeds that are rounding's there is no reversal."""
    time: Any = 0.01 * np.arange(200)
    first, end = 70, 90
    speed = np.full(200, 0.2)
    speed[first:end] = 0.0
    # From twenty samples before to twenty after: 0.4 m/s in 0.59 s.
    rate = 0.4 / (time[109] - time[50])
    lasts = time[end - 1] - time[first]
    # Half the time that it lasts, in which a reversal goes a step and a half either way.
    step = (lasts / 4.0) ** 2 * rate / 3.0
    assert _reverses(time, speed, first, end, 1.02 * step)
    assert not _reverses(time, speed, first, end, 0.98 * step)
    # A speed on one side that is nearly none: less than a fourth of a percent of the top.
    speed[50] = 0.0024 * 0.2
    assert not _reverses(time, speed, first, end, 4.0 * step)
    speed[50] = 0.0026 * 0.2
    assert _reverses(time, speed, first, end, 4.0 * step)
    assert not _reverses(time, 0.0 * speed, first, end, 4.0 * step)


def test_the_edges_of_a_rest_reach_as_far_as_the_motion_beside_began_before() -> None:
    """By its speed over its acceleration, at most twenty samples and all of the rest; at least
    one."""
    rest = bits("0" * 5 + "1" * 30 + "0" * 5)
    time: Any = 0.1 * np.arange(40)

    def edges(v: float, a: float) -> list[int]:
        return places(rest_edges(rest, time, np.where(rest, 0.0, v), np.where(rest, 0.0, a)))

    # Starts 2.5 steps before the first moving sample; what slows down did not start there.
    assert edges(0.25, 1.0) == [5, 32, 33, 34]
    assert edges(0.25, -1.0) == [5, 6, 7, 34]
    assert edges(-0.25, -1.0) == [5, 32, 33, 34]
    assert edges(0.0, 1.0) == [5, 34]
    assert edges(0.1 + 1e-9, 1.0) == [5, 33, 34]
    assert edges(100.0, 1.0) == [5, *range(15, 35)]
    short = bits("0111100")
    v = np.where(short, 0.0, 100.0)
    found = rest_edges(short, time[:7], v, np.where(short, 0.0, 1.0))
    assert places(found) == [1, 2, 3, 4]


def test_what_goes_backward_beside_a_rest_is_known_by_its_growth() -> None:
    """What sets out does not slow down, nor what stops speed up, by more than a sample's worth."""
    rest = bits("110000011")
    time: Any = 0.1 * np.arange(9)
    v = np.array([0.0, 0.0, -0.05, -0.02, 0.1, 0.2, 0.04, 0.0, 0.0])
    a = np.array([0.0, 0.0, 1.0, 1.0, 1.0, 0.0, 1.0, 0.0, 0.0])
    assert places(backward_beside_rest(rest, time, v, a)) == [2, 3, 6]
    # A sample's worth of its acceleration is the most that chance makes of a speed.
    for speed, backward in ((-0.099, [2]), (-0.101, [])):
        slow = np.where(np.arange(9) == 2, speed, np.where(rest, 0.0, 0.2))
        assert places(backward_beside_rest(rest, time, slow, a)) == backward
    # Not beyond the first that does not, nor where no rest is.
    gap = np.array([0.0, 0.0, 0.2, -0.02, 0.1, 0.2, 0.2, 0.0, 0.0])
    assert places(backward_beside_rest(rest, time, gap, a)) == []
    assert not backward_beside_rest(bits("000000000"), time, v, a).any()
    assert not backward_beside_rest(bits("0"), time[:1], v[:1], a[:1]).any()


def test_a_first_way_is_unsure_until_the_path_has_gone_it() -> None:
    """By more than what chance makes; to a rest likewise, from behind."""
    rest = bits("11000011")
    path = np.array([0.0, 0.0, 0.5, 1.0, 3.0, 4.0, 4.9, 4.9])
    v = np.array([0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 0.0, 0.0])
    assert places(unsure_beside_rest(rest, path, v, 0.9)) == [2]
    assert places(unsure_beside_rest(rest, path, v, 1.0)) == [2, 3, 5]
    assert places(unsure_beside_rest(rest, path, -v, 0.9)) == [2, 3, 4, 5]
    assert places(unsure_beside_rest(bits("00000000"), path, v, 0.9)) == []
    only_after = bits("00000011")
    assert places(unsure_beside_rest(only_after, path, v, 0.95)) == [5]


def test_a_shaft_does_not_go_back_before_it_sets_out_nor_after_it_came() -> None:
    """Speeds that are not sure, against the first and the last that are."""
    rest = bits("100000001")
    v = np.array([0.0, -0.1, 0.1, 0.5, -0.1, 0.4, -0.1, 0.2, 0.0])
    known = bits("100101001")
    without_swings(rest, v, known)
    assert v.tolist() == [0.0, 0.0, 0.1, 0.5, -0.1, 0.4, 0.0, 0.2, 0.0]
    alone = np.array([-0.1, 0.5, -0.1])
    without_swings(bits("000"), alone, bits("010"))
    assert alone.tolist() == [-0.1, 0.5, -0.1]


def test_a_rest_is_where_the_motions_beside_it_stop_and_start() -> None:
    """Their mean, within half a step of what the encoder shows; steady motions say nothing."""
    rest = bits("0111100")

    def placed(v: Any, a: Any, half_step: float = 1.0) -> Any:
        path = np.array([0.9, 1.0, 1.0, 1.0, 1.0, 1.3, 2.0])
        place_rests(rest, path, np.array(v), np.array(a), half_step)
        assert path[[0, 5, 6]].tolist() == [0.9, 1.3, 2.0]
        assert len({*path[1:5].tolist()}) == 1
        return path[1]

    # 0.9 + v^2 / 2a before, 1.3 - v^2 / 2a after.
    stops, starts = [0.4, 0, 0, 0, 0, 0.0, 0], [-1.0, 0, 0, 0, 0, 0.0, 0]
    assert placed(stops, starts) == pytest.approx(0.98)
    assert placed([0.0, 0, 0, 0, 0, 0.6, 0], [0.0, 0, 0, 0, 0, 2.0, 0]) == pytest.approx(1.21)
    both = placed([0.4, 0, 0, 0, 0, 0.6, 0], [-1.0, 0, 0, 0, 0, 2.0, 0])
    assert both == pytest.approx(0.5 * (0.98 + 1.21))
    backward = placed([-0.4, 0, 0, 0, 0, -0.6, 0], [1.0, 0, 0, 0, 0, -2.0, 0])
    assert backward == pytest.approx(0.5 * (0.82 + 1.39))
    assert placed([0.4, 0, 0, 0, 0, 0.6, 0], [0.0] * 7) == 1.0
    for half_step in (0.05, 0.01):
        far = placed([0.0, 0, 0, 0, 0, 0.6, 0], [0.0, 0, 0, 0, 0, 2.0, 0], half_step)
        assert far == pytest.approx(1.0 + half_step)
        near = placed([-2.0, 0, 0, 0, 0, 0, 0], [1.0, 0, 0, 0, 0, 0, 0], half_step)
        assert near == pytest.approx(1.0 - half_step)
    ends = np.array([5.0, 5.0, 5.2])
    place_rests(bits("110"), ends, np.array([0, 0, 1.0]), np.array([0, 0, 10.0]), 1.0)
    assert ends.tolist() == pytest.approx([5.15, 5.15, 5.2])
    starts_moving = np.array([5.0, 5.2, 5.2])
    place_rests(bits("011"), starts_moving, np.array([1.0, 0, 0]), np.array([-10.0, 0, 0]), 1.0)
    assert starts_moving.tolist() == pytest.approx([5.0, 5.05, 5.05])
