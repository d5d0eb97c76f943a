"""What a recorded path and speed are asked before a motion is made of them, each against a record
whose fault is known."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from jbf import Run
from jbf.records.motion.agreement import contradiction_of, disagreement_of
from jbf.records.motion.derived_speed import centred_speed, derived_speed
from jbf.records.motion.first_stroke import begins_in_a_hum
from jbf.records.motion.held_path import mend_held
from jbf.records.motion.position import Position, recorded_position
from jbf.records.motion.roughness import encoder_step, local_noise, noise_of, step_of
from jbf.records.motion.speed_zero import speed_zero

DT = 0.01
TIME: Any = DT * np.arange(400)
SPEED: Any = 0.2 * np.sin(1.7 * TIME + 0.4)
PATH: Any = -0.2 / 1.7 * np.cos(1.7 * TIME + 0.4)


def test_speeds_that_are_off_the_path_are_off_by_so_much() -> None:
    """A steady error of the speed; nothing where noise of path and speed makes as much."""
    off = 1e-3
    assert disagreement_of(TIME, PATH, SPEED, 0.0, 1e-9) < 1e-4
    found = disagreement_of(TIME, PATH, SPEED + off, 0.0, 1e-9)
    assert found == pytest.approx(off / 0.6745, rel=0.05)
    still = np.zeros(len(TIME))
    assert disagreement_of(TIME, still, still + off, 0.0, 0.0) == pytest.approx(off / 0.6745)
    seen = off * DT / 0.6745
    # Of the path alone, of the speed alone: 1.5 times what noise makes is the edge.
    for share, there in ((1.49, False), (1.51, True)):
        sd_path = seen / share / np.sqrt(2.0)
        wanted = np.sqrt(seen**2 - 2.0 * sd_path**2) / DT if there else 0.0
        found = disagreement_of(TIME, still, still + off, sd_path, 0.0)
        assert found == pytest.approx(wanted)
        sd_speed = seen / share / np.sqrt(0.5) / DT
        wanted = seen / DT if there else 0.0
        assert disagreement_of(TIME, still, still + off, 0.0, sd_speed) == pytest.approx(wanted)


def contradictions(jumps: dict[int, float], sd_path: float = 0.0, sd_speed: float = 0.0) -> Any:
    """What is found where the path jumps on its way from sample to sample, a shaft else at rest
    whose path is off by a micrometre to and fro."""
    path: Any = 1e-6 * (np.arange(400) % 2)
    for gap, size in jumps.items():
        path[gap + 1 :] += size
    return contradiction_of(TIME, path, np.zeros(400), sd_path, sd_speed)


def test_a_contradiction_spoils_three_samples_to_each_side() -> None:
    """By as much speed as the path jumps in a step; the larger one where two are near."""
    found = contradictions({100: 1e-3})
    assert np.flatnonzero(found).tolist() == [98, 99, 100, 101, 102, 103]
    assert found[100] == pytest.approx(1e-3 / DT, rel=2e-3)
    both = contradictions({100: 1e-3, 103: -3e-3})
    assert np.flatnonzero(both).tolist() == list(range(98, 107))
    assert both[99] == pytest.approx(0.1, rel=2e-3)
    assert both[102] == pytest.approx(0.3, rel=2e-3)
    assert not contradictions({}).any()


def test_what_is_usual_or_rare_noise_is_no_contradiction() -> None:
    """Ten times the usual gap, or the error that noise makes; in a hundredth of the gaps."""
    own = 1e-6
    sd_speed = 1e-5 / np.sqrt(0.5) / DT
    for times, there in ((9.6, False), (10.4, True)):
        assert contradictions({100: times * own / 0.6745 - own}).any() == there
        by_path = times * np.sqrt(2.0) * 1e-5 - own
        assert contradictions({100: by_path}, sd_path=1e-5).any() == there
        assert contradictions({100: times * 1e-5 - own}, sd_speed=sd_speed).any() == there
    three = {100 + 30 * k: 1e-3 for k in range(3)}
    assert contradictions(three).any()
    assert not contradictions({100 + 30 * k: 1e-3 for k in range(4)}).any()


def test_a_difference_that_looks_back_is_late_by_half_its_span() -> None:
    """And left aside; one that looks to both sides is not late."""
    step = 1e-4
    path = step * np.round(PATH / step)
    for span in (1, 2, 3, 5, 12):
        speed = np.zeros(len(path))
        speed[span:] = (path[span:] - path[:-span]) / (span * DT)
        found = derived_speed("a", TIME, path, speed)
        assert found is not None
        assert (found.kind, found.channel, found.run) == ("coarse_speed", "velocity_m_s", "a")
        assert (found.size, found.unit) == (span, "samples")
        assert found.words == (
            f"the speed is a difference of the path over {span} samples, "
            f"{0.5 * span * 10.0:.3g} ms late"
        )
        assert found.done == "left aside; the path alone tells the motion"
    for span in (2, 4, 8):
        speed = np.zeros(len(path))
        half = span // 2
        speed[half:-half] = (path[span:] - path[:-span]) / (span * DT)
        found = derived_speed("a", TIME, path, speed)
        assert found is not None
        assert found.words == f"the speed is a difference of the path over {span} samples"
    over_13 = np.zeros(len(path))
    over_13[13:] = (path[13:] - path[:-13]) / (13 * DT)
    assert derived_speed("a", TIME, path, over_13) is None


def test_a_speed_that_was_measured_is_no_difference() -> None:
    """Nor is one of a path that is as smooth as it, of a record that is short or hardly moves, or
    of samples of which a tenth or more are none."""
    step = 1e-4
    path = step * np.round(PATH / step)
    assert derived_speed("a", TIME, path, SPEED) is None
    smooth = np.gradient(PATH, TIME)
    assert derived_speed("a", TIME, PATH, smooth) is None
    coarse = np.zeros(len(path))
    coarse[1:] = np.diff(path) / DT
    assert derived_speed("a", TIME[:47], path[:47], coarse[:47]) is None
    for share, there in ((0.05, True), (0.15, False)):
        mixed = coarse.copy()
        mixed[:: round(1.0 / share)] += 0.01
        assert (derived_speed("a", TIME, path, mixed) is not None) == there
    small = 0.01 * coarse
    small[0] = 1.0
    assert derived_speed("a", TIME, path, small) is None
    assert derived_speed("a", TIME, 0.0 * path, 0.0 * path) is None


@pytest.mark.parametrize(("moves", "there"), [(49, False), (50, True)])
def test_fifty_samples_in_motion_tell_where_a_speed_is_from(moves: int, there: bool) -> None:
    """Of a record that is at rest for nearly as long."""
    coarse = np.zeros(90)
    coarse[20 : 20 + moves] = 1e-2 * (1.0 + np.arange(moves) % 3)
    path = np.concatenate(([0.0], np.cumsum(coarse[1:] * DT)))
    assert (derived_speed("a", TIME[:90], path, coarse) is not None) == there


@pytest.mark.parametrize(("share", "there"), [(0.098, False), (0.106, True)])
def test_a_difference_that_is_smooth_is_as_good_as_a_measured_speed(
    share: float, there: bool
) -> None:
    """Smoother than fifteen hundredths of a count in a sample: here changes of the way grow by one
    count, more and less in turn, which makes noise of 4 / 0.6745 / sqrt(20) of what is more."""
    bends = 1e-5 * (1.0 + share * np.where(np.arange(400) % 2, 1.0, -1.0))
    ways = np.cumsum(bends)
    path = np.cumsum(ways)
    speed = np.concatenate(([0.0], np.diff(path) / DT))
    assert 4.0 * share / 0.6745 / np.sqrt(20.0) == pytest.approx(0.15 * (1.0 - share), rel=0.05)
    assert (derived_speed("a", TIME, path, speed) is not None) == there


def test_a_speed_of_the_path_is_not_late() -> None:
    """Central differences."""
    found = centred_speed(TIME, TIME**2)
    np.testing.assert_allclose(found[1:-1], 2.0 * TIME[1:-1])


def hum(*speeds: float) -> bool:
    return begins_in_a_hum(np.arange(float(len(speeds))), np.array(speeds))


def test_a_run_begins_in_a_hum_where_its_first_way_is_a_thousandth_of_its_longest() -> None:
    """Not where it begins at rest, nor where it never turns."""
    rest = [1.0] * 1000
    assert hum(0.5, -1.0, *(-1.0 for _ in rest))
    assert not hum(5.0, -1.0, *(-1.0 for _ in rest))
    assert not hum(0.0, -1.0, *(-1.0 for _ in rest))
    assert not hum(0.5, *rest)
    assert not hum(0.5)
    # A way of several steps counts whole, to the step before the one that turns.
    for size, found in ((0.4, True), (0.6, False)):
        assert hum(size, size, size, -1.0, *([-1.0] * 1000)) == found
    # The longest way may be any, the last among them.
    assert hum(0.5, -1.0, 1.0, *rest, -1.0)


def test_noise_is_what_third_differences_make_of_it() -> None:
    """No smooth signal has any; white noise has its own, whatever half of the samples do."""
    assert noise_of(TIME**2) < 1e-12
    noise = np.random.default_rng(1).standard_normal(20_000)
    assert noise_of(noise) == pytest.approx(1.0, rel=0.02)
    alternating = np.where(np.arange(100) % 2, 1.0, -1.0)
    assert noise_of(alternating) == pytest.approx(8.0 / 0.6745 / np.sqrt(20.0))
    assert noise_of(alternating[:8]) > 0.0
    assert noise_of(alternating[:7]) == 0.0


def test_noise_that_comes_and_goes_is_local() -> None:
    """Of a long record where it is thrice the usual; else one number."""
    random = np.random.default_rng(2)
    noise = random.standard_normal(1200)
    assert local_noise(noise) == noise_of(noise)
    loud = noise.copy()
    loud[500:800] *= 10.0
    found = local_noise(loud)
    assert isinstance(found, np.ndarray)
    assert found.shape == loud.shape
    assert np.median(found[560:740]) == pytest.approx(10.0, rel=0.3)
    assert set(found[:400].tolist()) == {noise_of(loud)}
    assert local_noise(loud[400:803]) == noise_of(loud[400:803])
    assert isinstance(local_noise(np.concatenate((noise[:300], 10.0 * noise[:104]))), np.ndarray)


def test_the_step_of_an_encoder_is_the_smallest_change() -> None:
    """Rounding is none; a path whose noise is larger than three of its steps' has no encoder."""
    assert step_of(np.array([0.0, 0.3, 0.3, 0.2, 0.2 + 1e-13])) == pytest.approx(0.1)
    assert step_of(np.ones(5)) == 0.0
    assert step_of(np.array([1.0])) == 0.0
    counts = 1e-4 * np.round(PATH / 1e-4)
    assert encoder_step(counts) == pytest.approx(1e-4)
    noisy = PATH + 1e-4 * np.random.default_rng(3).standard_normal(400)
    assert encoder_step(noisy) == 0.0


def held(step: float = 1e-6, **changes: Any) -> tuple[Any, Any, np.ndarray]:
    """A path that stands still while the shaft moves on at 0.1 m/s, and what becomes of it."""
    true: Any = 0.1 * TIME
    path = step * np.round(true / step)
    # One step of the encoder shows it.
    path[0] = true[0] = path[1] - step
    for first, count in changes.get("at", {100: 5}).items():
        path[first + 1 : first + 1 + count] = path[first]
    position = Position(path, "angle_rad", "rad", 0.5)
    speed = changes.get("speed", np.full(400, 0.1))
    mended, finding = mend_held("a", TIME, position, speed, "the drive")
    return mended, finding, true


def test_held_readings_are_put_where_the_speed_says() -> None:
    """Three repeats in a row and more; the finding says how many, and how long the longest."""
    mended, finding, true = held(at={100: 5, 200: 3})
    np.testing.assert_allclose(mended.path_m, true, atol=2e-6)
    assert (finding.kind, finding.channel, finding.unit) == ("held_samples", "angle_rad", "s")
    assert finding.size == pytest.approx(0.05)
    assert finding.words == (
        "8 readings of the position repeat the one before while the drive moves on"
    )
    assert finding.done == "put where the speed says"
    assert (mended.column, mended.arm_m) == ("angle_rad", 0.5)
    short, nothing, _ = held(at={100: 2})
    assert nothing is None
    assert short.path_m[102] == short.path_m[100]


def test_what_stands_still_for_another_reason_stays() -> None:
    """A count that is not worth it, a rest, a path that does not catch up, most of a record, or
    its end."""
    # The shaft goes on by four steps, or by six, of what the path shows.
    for step, there in ((1.2e-3, False), (6e-4, True)):
        assert (held(step, at={100: 4})[1] is not None) == there
    slow = np.full(400, 0.1)
    slow[101:104] = 0.0
    assert held(speed=slow)[1] is None
    assert held(speed=np.full(400, 0.2))[1] is None
    assert held(speed=np.full(400, 0.12))[1] is not None
    assert held(at={4 * k: 3 for k in range(90)})[1] is None
    assert held(at={20 * k: 5 for k in range(19)})[1] is not None
    assert held(at={394: 5})[1] is None
    assert held(at={393: 5})[1] is not None


def columns_of(**columns: Any) -> Run:
    return Run.from_arrays(TIME, **columns)


def test_a_path_is_the_angles_with_a_radius_else_the_positions() -> None:
    """Across an angle's jumps; without a radius an angle's way is its speed's, where it has one."""
    angle = np.mod(8.0 * TIME, 2.0 * np.pi)
    both = columns_of(velocity_m_s=SPEED, angle_rad=angle, position_m=PATH)
    found = recorded_position(both, 0.25)
    assert found is not None
    np.testing.assert_allclose(found.path_m, 2.0 * TIME, atol=1e-12)
    assert (found.column, found.unit, found.arm_m) == ("angle_rad", "rad", 0.25)
    found = recorded_position(both, None)
    assert found is not None
    assert (found.column, found.unit, found.arm_m) == ("position_m", "m", 1.0)
    np.testing.assert_array_equal(found.path_m, PATH)
    found = recorded_position(columns_of(velocity_m_s=3.0 * SPEED, angle_rad=PATH), None)
    assert found is not None
    assert found.arm_m == pytest.approx(3.0, rel=1e-3)
    np.testing.assert_allclose(found.path_m, found.arm_m * PATH)
    assert recorded_position(columns_of(angle_rad=PATH), None) is None
    assert recorded_position(columns_of(velocity_m_s=SPEED), 0.25) is None
    moved = found.along(2.0 * PATH)
    assert (moved.column, moved.arm_m) == (found.column, found.arm_m)


STEP = 1e-5


def stopped(zero: float, noise: float = 0.0, still: int = 100) -> tuple[Any, float, Any]:
    """A speed whose zero is off, of a shaft that moves, rests, and moves on."""
    speed = np.where((np.arange(400) >= 150) & (np.arange(400) < 150 + still), 0.0, 0.1)
    path = STEP * np.round(np.cumsum(speed) * DT / STEP)
    random = np.random.default_rng(4).standard_normal(400)
    return speed_zero("a", TIME, path, speed + zero + noise * random, STEP, "m/s")


def test_a_speed_at_a_standstill_tells_its_zero() -> None:
    """Which is taken off everywhere."""
    speed, hum, finding = stopped(2e-3)
    np.testing.assert_allclose(speed[160:240], 0.0, atol=1e-12)
    assert speed[0] == pytest.approx(0.1)
    assert hum == pytest.approx(0.1)
    assert (finding.kind, finding.channel, finding.unit) == ("speed_zero", "velocity_m_s", "m/s")
    assert finding.size == pytest.approx(2e-3)
    assert finding.words == "the speed reads 0.002 m/s while the position stands still"
    assert finding.done == "taken off"
    assert stopped(-2e-3)[2].size == pytest.approx(-2e-3)


@pytest.mark.parametrize(
    ("zero", "noise", "still", "there"),
    [
        (2e-3, 0.0, 55, False),
        (2e-3, 0.0, 65, True),
        (3.5e-5, 0.0, 100, False),
        (4.5e-5, 0.0, 100, True),
        (1e-3, 1e-3, 100, False),
        (1e-2, 1e-3, 100, True),
        (0.0, 0.0, 100, False),
    ],
)
def test_a_zero_is_off_by_more_than_chance_and_counts_would_make(
    zero: float, noise: float, still: int, there: bool
) -> None:
    """Sixty samples at a standstill; four counts of way in the longest; five standard errors."""
    speed, hum, finding = stopped(zero, noise, still)
    assert (finding is not None) == there
    if not there:
        assert hum == 0.0
        assert speed[0] == pytest.approx(0.1 + zero, abs=5.0 * noise + 1e-12)


def test_a_path_without_steps_tells_no_zero() -> None:
    """Nor does a record that never stands still, or a short one."""
    still = np.zeros(400)
    assert speed_zero("a", TIME, PATH, SPEED, 0.0, "m/s")[2] is None
    assert speed_zero("a", TIME, PATH, SPEED, 1e-9, "m/s")[2] is None
    assert speed_zero("a", TIME[:10], still[:10], still[:10] + 1.0, STEP, "m/s")[2] is None
