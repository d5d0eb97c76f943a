"""Single samples of a path or a speed that are off: which are found, where they are put, what is
said."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from jbf.records.lagrange import weights_at_zero
from jbf.records.motion.glitches import (
    _around,
    _between,
    _both_sides,
    _least,
    _missed,
    mend_position,
    mend_speed,
)
from jbf.records.motion.position import Position

DT = 0.01
TIME: Any = DT * np.arange(1000)
STEP = 1e-5
SPEED: Any = 0.2 * np.sin(1.7 * TIME + 0.4)
PATH: Any = -0.2 / 1.7 * np.cos(1.7 * TIME + 0.4)
COUNTED: Any = STEP * np.round(PATH / STEP)


def path_with(jumps: dict[int, float], path: Any = COUNTED, arm: float = 0.5) -> tuple[Any, Any]:
    """A path with single samples off, and what becomes of it."""
    made = path.copy()
    for i, size in jumps.items():
        made[i] += size
    return mend_position("a", TIME[: len(made)], Position(made, "angle_rad", "rad", arm))


def test_a_position_far_off_is_put_where_its_neighbours_say() -> None:
    """Told in the column's own unit, with the first three instants."""
    jumps = {100: 1e-2, 300: -2e-2, 500: 5e-3, 700: 1e-2}
    mended, finding = path_with(jumps)
    np.testing.assert_allclose(mended.path_m, PATH, atol=2.0 * STEP)
    untouched = np.delete(np.arange(1000), list(jumps))
    np.testing.assert_array_equal(mended.path_m[untouched], COUNTED[untouched])
    assert (finding.kind, finding.channel, finding.run) == ("glitches", "angle_rad", "a")
    assert (finding.unit, finding.done) == ("rad", "left out of the motion")
    assert finding.size == pytest.approx(2e-2 / 0.5, rel=2e-3)
    assert finding.words == (
        "4 single samples of the position off by up to 0.04 rad (at 1.00 s, 3.00 s, 5.00 s)"
    )
    one = path_with({100: 1e-2}, arm=1.0)[1]
    assert one.words == "1 single sample of the position off by up to 0.01 rad (at 1.00 s)"


def test_two_positions_side_by_side_are_found_one_after_the_other() -> None:
    """Without the one the other is single."""
    mended, finding = path_with({400: 3e-3, 401: 3e-2})
    np.testing.assert_allclose(mended.path_m, PATH, atol=2.0 * STEP)
    assert finding.words.startswith("2 single samples")


def test_a_path_without_a_glitch_is_the_same_path() -> None:
    """Counts are none, nor what three counts hide, a jump of the path or of its speed."""
    assert path_with({})[1] is None
    assert path_with({100: 2.0 * STEP})[1] is None
    assert path_with({100: 6.0 * STEP})[1] is not None
    stepped = COUNTED.copy()
    stepped[500:] += 1e-2
    mended, finding = path_with({}, stepped)
    assert finding is None
    np.testing.assert_array_equal(mended.path_m, stepped)
    bent = STEP * np.round(0.3 * np.maximum(TIME - 5.0, 0.0) / STEP)
    assert path_with({}, bent)[1] is None


@pytest.mark.parametrize(("counts", "there"), [(2.9, False), (3.1, True)])
def test_a_glitch_is_three_counts_of_the_encoder_or_more(counts: float, there: bool) -> None:
    """On a line that is known exactly."""
    line = STEP * np.arange(1000.0)
    assert (path_with({500: counts * STEP}, line)[1] is not None) == there


@pytest.mark.parametrize(("times", "there"), [(7.8, False), (8.2, True)])
def test_a_glitch_is_eight_local_standard_deviations_or_more(times: float, there: bool) -> None:
    """Of a path that is off to and fro: its cubics are off by eight thirds of that, everywhere."""
    off = 1e-4
    wave = 1e-3 * np.arange(1000.0) + off * np.where(np.arange(1000) % 2, -1.0, 1.0)
    usual = 8.0 / 3.0 * off
    size = times * usual / 0.6745 - usual
    assert (path_with({500: size}, wave)[1] is not None) == there


@pytest.mark.parametrize(("times", "there"), [(2.9, False), (3.1, True)])
def test_a_glitch_of_a_speed_is_three_usual_changes_or_more(times: float, there: bool) -> None:
    """Of a speed that grows by as much from sample to sample, but for a little noise."""
    ramp = 0.1 * TIME + 1e-6 * np.random.default_rng(4).standard_normal(1000)
    ramp[500] += times * 0.1 * DT + 0.1 * DT
    assert (mend_speed("a", TIME, ramp, None)[1] is not None) == there


@pytest.mark.parametrize(("times", "there"), [(7.8, False), (8.2, True)])
def test_a_glitch_of_a_speed_is_eight_of_its_noises_or_more(times: float, there: bool) -> None:
    """A speed whose bends are of one size throughout tells its noise exactly."""
    # Steps of 0, +b, 0, -b: every bend is b.
    bend = 1e-3
    speed = bend * np.cumsum(np.tile([0.0, 1.0, 0.0, -1.0], 250))
    speed[502] += times * bend / 0.6745 / np.sqrt(6.0)
    assert (mend_speed("a", TIME, speed, None)[1] is not None) == there


def test_glitches_are_rare() -> None:
    """Two in a hundred samples; more is noise. Nor is a short record asked."""
    twenty = {40 + 45 * k: 1e-2 for k in range(20)}
    assert path_with(twenty)[1] is not None
    assert path_with(twenty | {30: 1e-2})[1] is None
    assert path_with({30: 1e-2}, COUNTED[:59])[1] is None
    assert path_with({30: 1e-2}, COUNTED[:60])[1] is not None


def speed_with(
    jumps: dict[int, float], *, path: Any = PATH, noise: float = 1e-4, samples: int = 1000
) -> tuple[Any, Any]:
    """A speed with single samples off, and what becomes of it."""
    random = np.random.default_rng(1)
    made = SPEED + noise * random.standard_normal(1000)
    for i, size in jumps.items():
        made[i] += size
    part = slice(0, samples)
    return mend_speed("a", TIME[part], made[part], None if path is None else path[part])


def test_a_speed_that_the_path_does_not_know_of_is_mended() -> None:
    """On a cubic through its neighbours."""
    mended, finding = speed_with({200: 0.1, 600: -0.2})
    np.testing.assert_allclose(mended, SPEED, atol=1e-3)
    assert (finding.kind, finding.channel, finding.run) == ("glitches", "velocity_m_s", "a")
    assert (finding.unit, finding.done) == ("m/s", "left out of the motion")
    assert finding.size == pytest.approx(0.2, rel=0.01)
    assert finding.words == (
        f"2 single samples of the speed off by up to {finding.size:.3g} m/s (at 2.00 s, 6.00 s)"
    )
    told = mend_speed("a", TIME, mended + np.where(TIME == 2.0, 0.1, 0.0), PATH, "rad/s")[1]
    assert told is not None
    assert told.unit == "rad/s"
    assert "rad/s (at" in told.words


def test_a_speed_that_the_path_shares_is_none() -> None:
    """It went there and back; without a path it is a glitch where such are rarer still."""
    slip = PATH.copy()
    slip[201:] += 0.5 * 0.1 * DT
    slip[200:] += 0.5 * 0.1 * DT
    assert speed_with({200: 0.1}, path=slip)[1] is None
    assert speed_with({200: 0.1}, path=None)[1] is not None
    three = {200 + 100 * k: 0.1 for k in range(3)}
    assert speed_with(three, path=None)[1] is not None
    assert speed_with(three | {700: 0.1}, path=None)[1] is None
    assert speed_with(three | {700: 0.1})[1] is not None


@pytest.mark.parametrize(("share", "there"), [(0.31, True), (0.36, False)])
def test_a_path_that_shares_a_third_of_a_glitch_knows_of_it(share: float, there: bool) -> None:
    """The speed must miss it by twice as much as the mended one does."""
    slip = PATH.copy()
    slip[200:] += 0.5 * share * 0.1 * DT
    slip[201:] += 0.5 * share * 0.1 * DT
    assert (speed_with({200: 0.1}, path=slip, noise=1e-6)[1] is not None) == there


def test_what_is_no_glitch_of_a_speed() -> None:
    """Noise, a small change, a corner, a record without noise, a short one, or too many."""
    assert speed_with({})[1] is None
    # Eight of the noise's standard deviations, in its loudest stretch.
    assert speed_with({200: 4e-4})[1] is None
    assert speed_with({200: 2e-2})[1] is not None
    assert speed_with({200: 0.1}, samples=59)[1] is None
    assert speed_with({30: 0.1}, samples=60)[1] is not None
    steady = np.full(1000, 0.2)
    steady[500] = 0.3
    assert mend_speed("a", TIME, steady, None)[1] is None
    corner = 0.2 * np.abs(TIME - 5.0) + 1e-4 * np.random.default_rng(2).standard_normal(1000)
    assert mend_speed("a", TIME, corner, None)[1] is None
    assert speed_with({40 + 40 * k: 0.1 for k in range(20)})[1] is not None
    assert speed_with({40 + 40 * k: 0.1 for k in range(21)})[1] is None
    # To both sides it is off about as much, or it is a step.
    step = SPEED + 1e-4 * np.random.default_rng(3).standard_normal(1000)
    step[500:] += 0.1
    assert mend_speed("a", TIME, step, None)[1] is None


def test_weights_of_a_cubic_at_zero() -> None:
    """Of even steps those of the textbook; of any they give a cubic's own value."""
    even = weights_at_zero(np.array([-2.0, -1.0, 1.0, 2.0]))
    np.testing.assert_allclose(even, np.array([-1.0, 4.0, 4.0, -1.0]) / 6.0)
    t = np.array([[-3.0, -2.0], [-1.0, -0.5], [0.5, 1.0], [4.0, 7.0]])
    value = 2.0 - 3.0 * t + 0.5 * t**2 + 4.0 * t**3
    np.testing.assert_allclose(np.sum(weights_at_zero(t) * value, axis=0), 2.0)


def test_masked_samples_are_on_a_cubic_through_two_good_ones_on_either_side() -> None:
    """On a line at the record's ends; good ones stay."""
    t = np.array([0.0, 1.0, 3.0, 4.0, 6.0, 7.0, 8.0, 9.0])
    cubic = t**3 - 2.0 * t
    mask = np.zeros(8, dtype=bool)
    mask[[3, 4]] = True
    broken = np.where(mask, 99.0, cubic)
    np.testing.assert_allclose(_between(t, broken, mask), cubic)
    mask = np.zeros(8, dtype=bool)
    mask[0] = True
    line = 2.0 * t + 1.0
    np.testing.assert_allclose(_between(t, np.where(mask, 99.0, line), mask), line)
    found = _between(t, np.where(mask, 99.0, cubic), mask)
    assert found[0] == pytest.approx(cubic[1] - (cubic[2] - cubic[1]) / 2.0)
    np.testing.assert_array_equal(found[1:], cubic[1:])


def test_a_sample_is_above_or_below_both_of_its_neighbours() -> None:
    """Where both changes have one sign and differ by less than a factor of two, by the smaller;
    what stands beside a larger one is off as seen from it."""
    before, after = _both_sides(np.diff(np.array([0.0, 3.0, 1.0, 1.0])))
    assert before.tolist() == [3.0, -2.0]
    assert after.tolist() == [2.0, 0.0]
    assert _least(np.array([3.0]), np.array([2.0])).tolist() == [2.0]
    assert _least(np.array([-3.0]), np.array([-2.0])).tolist() == [2.0]
    assert _least(np.array([-3.0]), np.array([2.0])).tolist() == [0.0]
    for large, found in ((3.9, 2.0), (4.1, 0.0)):
        assert _least(np.array([large]), np.array([2.0])).tolist() == [found]
    beside = _least(np.array([1.0, 3.0, 1.0, 0.0, 2.0]), np.array([1.0, 3.0, 1.0, 0.0, 2.0]))
    assert beside.tolist() == [0.0, 3.0, 0.0, 0.0, 2.0]


def test_path_and_speed_disagree_on_both_sides_of_a_sample() -> None:
    """The gaps of the steps to it and from it, of any sign, together."""
    t = np.array([0.0, 1.0, 3.0, 4.0])
    path = np.array([0.0, 1.5, 4.0, 4.0])
    speed = np.array([1.0, 1.0, 1.0, 1.0])
    assert _missed(t, path, speed).tolist() == [0.5, 1.0, 1.5, 1.0]


def test_the_usual_size_is_the_loudest_near_by() -> None:
    """Of medians over a window, the largest of those within half of one."""
    sizes = np.zeros(300)
    sizes[100:200] = 1.0
    found = _around(sizes)
    assert found[90] == 1.0
    assert found[209] == 1.0
    assert found[60] == 0.0
    assert found[240] == 0.0
    single = np.zeros(300)
    single[150] = 1.0
    assert not _around(single).any()
