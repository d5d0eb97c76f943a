"""Glitches and held samples of position and speed, and their replacement."""

from typing import Any

import numpy as np
import pytest
from jbf import Run
from jbf.records.motion.corrected_records import corrected_records
from jbf.records.motion.estimated_motion import estimate_motion
from jbf.records.motion.glitches import mend_position, mend_speed, mend_speed_ends
from jbf.records.motion.position import Position
from jbf.records.motion.stale_positions import replace_stale_positions
from known_motions import STEP_S, Array, places, quantised, white

SAMPLES = 1000
TIME_S: Any = STEP_S * np.arange(SAMPLES)
COUNT_M = 1e-5
SPEED_M_S: Any = 0.2 * np.sin(1.7 * TIME_S + 0.4)
PATH_M: Any = -0.2 / 1.7 * np.cos(1.7 * TIME_S + 0.4)
COUNTED_M = quantised(PATH_M, COUNT_M)


def mended_path(jumps: dict[int, float], path: Array = COUNTED_M) -> Any:
    """Corrected position and finding of a path with offsets at single samples."""
    corrupt = path.copy()
    for i, size in jumps.items():
        corrupt[i] += size
    return mend_position("a", TIME_S, Position(corrupt, "angle_rad", "rad", 0.5))


def test_position_outliers_are_replaced_by_a_cubic_through_their_neighbours() -> None:
    jumps = {100: 1e-2, 300: -2e-2, 500: 5e-3, 700: 1e-2, 701: 1e-3}
    mended, finding = mended_path(jumps)
    np.testing.assert_allclose(mended.path_m, PATH_M, atol=2.0 * COUNT_M)
    others = np.delete(np.arange(SAMPLES), list(jumps))
    np.testing.assert_array_equal(mended.path_m[others], COUNTED_M[others])
    assert (finding.kind, finding.channel, finding.unit) == ("glitches", "angle_rad", "rad")
    assert finding.size == pytest.approx(2e-2 / 0.5, rel=2e-3)


def test_position_outlier_at_uneven_sampling_is_replaced_by_a_cubic() -> None:
    """A straight line would have an error of 80 m/s^2 (0.01 s)^2 / 2 = 4 mm."""
    time_s = np.cumsum(np.where(np.arange(SAMPLES) % 3 == 0, 1.5, 1.0)) * STEP_S
    path = 0.2 * np.sin(20.0 * time_s)
    corrupt = path + np.where(np.arange(SAMPLES) == 400, 0.1, 0.0)
    mended, finding = mend_position("a", time_s, Position(corrupt, "position_m", "m", 1.0))
    assert finding is not None
    assert mended.path_m[400] == pytest.approx(path[400], abs=5e-4)


def test_quantisation_steps_and_corners_of_a_path_are_not_outliers() -> None:
    assert mended_path({})[1] is None
    stepped = COUNTED_M + np.where(np.arange(SAMPLES) >= 500, 1e-2, 0.0)
    mended, finding = mended_path({}, stepped)
    assert finding is None
    np.testing.assert_array_equal(mended.path_m, stepped)
    corner = quantised(0.3 * np.maximum(TIME_S - 5.0, 0.0), COUNT_M)
    assert mended_path({}, corner)[1] is None


def test_position_jump_beyond_eight_standard_deviations_is_an_outlier() -> None:
    """Cubics through the neighbours of an alternating path deviate by 8/3 of its amplitude."""
    path = 1e-3 * np.arange(1000.0) + 1e-4 * np.where(np.arange(1000) % 2, -1.0, 1.0)
    usual = 8.0 / 3.0 * 1e-4
    assert mended_path({500: 7.8 * usual / 0.6745 - usual}, path)[1] is None
    assert mended_path({500: 8.2 * usual / 0.6745 - usual}, path)[1] is not None


def mended_speed(jumps: dict[int, float], *, path: Any = PATH_M, noise: float = 1e-4) -> Any:
    """Corrected speed and finding of a speed with offsets at single samples."""
    speed = SPEED_M_S + white(SAMPLES, 1, noise)
    for i, size in jumps.items():
        speed[i] += size
    return mend_speed("a", TIME_S, speed, path)


def test_speed_outliers_that_the_path_contradicts_are_replaced() -> None:
    mended, finding = mended_speed({200: 0.1, 600: -0.2})
    np.testing.assert_allclose(mended, SPEED_M_S, atol=1e-3)
    assert (finding.kind, finding.channel, finding.unit) == ("glitches", "velocity_m_s", "m/s")
    assert finding.size == pytest.approx(0.2, rel=0.01)


def test_speed_peak_is_not_an_outlier_if_the_path_contains_a_third_of_it() -> None:
    """The speed's error relative to the path must be twice that of the corrected speed."""
    for share, found in ((0.31, True), (0.36, False), (1.0, False)):
        path = PATH_M.copy()
        path[200:] += 0.5 * share * 0.1 * STEP_S
        path[201:] += 0.5 * share * 0.1 * STEP_S
        assert (mended_speed({200: 0.1}, path=path, noise=1e-6)[1] is not None) == found, share


def test_speed_outliers_are_reported_up_to_0_3_percent_or_2_percent_with_a_path() -> None:
    jumps = [(40 + 40 * k, 0.1) for k in range(21)]
    for count, path in ((3, None), (4, PATH_M), (20, PATH_M)):
        assert mended_speed(dict(jumps[:count]), path=path)[1] is not None
    for count, path in ((4, None), (21, PATH_M)):
        assert mended_speed(dict(jumps[:count]), path=path)[1] is None


@pytest.mark.parametrize(("sd", "found"), [(7.8, False), (8.2, True)])
def test_speed_jump_beyond_eight_standard_deviations_is_an_outlier(sd: float, found: bool) -> None:
    """All second differences of this speed have the same magnitude."""
    speed = 1e-3 * np.cumsum(np.tile([0.0, 1.0, 0.0, -1.0], 250))
    speed[502] += sd * 1e-3 / 0.6745 / np.sqrt(6.0)
    assert (mend_speed("a", TIME_S, speed, None)[1] is not None) == found


def test_speed_with_a_step_or_a_corner_or_no_noise_has_no_outlier() -> None:
    step = SPEED_M_S + white(SAMPLES, 3, 1e-4)
    step[500:] += 0.1
    corner = 0.2 * np.abs(TIME_S - 5.0) + white(SAMPLES, 2, 1e-4)
    steady = np.full(SAMPLES, 0.2)
    steady[500] = 0.3
    for speed in (step, corner, steady, SPEED_M_S + white(SAMPLES, 1, 1e-4)):
        assert mend_speed("a", TIME_S, speed, None)[1] is None


def test_speed_outliers_are_reported_from_sixty_samples_on() -> None:
    spike = SPEED_M_S + white(SAMPLES, 1, 1e-4)
    spike[30] += 0.1
    assert mend_speed("a", TIME_S[:59], spike[:59], PATH_M[:59])[1] is None
    assert mend_speed("a", TIME_S[:60], spike[:60], PATH_M[:60])[1] is not None


def test_speed_that_contradicts_the_path_for_six_samples_is_not_used() -> None:
    # Six samples are too many for an outlier.
    for factor, offset in ((0.5, 0.0), (1.0, 0.05)):
        speed = SPEED_M_S + white(SAMPLES, 6, 1e-4)
        speed[500:506] = factor * speed[500:506] + offset
        motion = estimate_motion(Run.from_arrays(TIME_S, speed, position_m=COUNTED_M), None)
        assert np.max(np.abs(motion.velocity - SPEED_M_S)[490:516]) < 1e-3


@pytest.mark.parametrize("end", [0, SAMPLES - 1])
@pytest.mark.parametrize("angle", [False, True])
def test_speed_outlier_at_a_record_end_is_replaced_and_its_sign_unknown(
    end: int, angle: bool
) -> None:
    speed = SPEED_M_S + white(SAMPLES, 5, 1e-4)
    speed[end] = 40.0
    run = Run.from_arrays(TIME_S, speed, angle_rad=PATH_M / 0.5 if angle else None)
    records = corrected_records(run, 0.5)
    assert places(records.loose) == [end]
    np.testing.assert_allclose(records.speed, SPEED_M_S, atol=2e-3)
    motion = estimate_motion(run, 0.5)
    assert not motion.sign_known[end]
    assert motion.sign_known[[1, 2, -3, -2]].all()
    assert [(f.kind, f.channel) for f in motion.findings] == [("glitches", "velocity_m_s")]


@pytest.mark.parametrize("end", [0, SAMPLES - 1])
@pytest.mark.parametrize("with_speed", [False, True])
def test_position_outlier_at_a_record_end_is_extrapolated(end: int, with_speed: bool) -> None:
    path = PATH_M.copy()
    path[end] += 0.1
    speed = SPEED_M_S + white(SAMPLES, 5, 1e-4) if with_speed else None
    records: Any = corrected_records(Run.from_arrays(TIME_S, speed, angle_rad=path / 0.5), 0.5)
    assert places(records.loose) == [end]
    np.testing.assert_allclose(records.path, PATH_M, atol=1e-4)
    (finding,) = [f for f in records.findings if f.kind == "glitches"]
    assert (finding.channel, finding.unit) == ("angle_rad", "rad")
    assert finding.size == pytest.approx(0.2, rel=0.02)


def test_deviating_end_of_the_speed_is_an_outlier_only_if_the_path_lacks_it() -> None:
    speed = SPEED_M_S + white(SAMPLES, 5, 1e-4)
    speed[-1] += 1.0
    path = PATH_M.copy()
    path[-1] += 0.5 * STEP_S
    mended, outliers, findings = mend_speed_ends("a", TIME_S, speed, path, "m/s")
    assert (outliers.any(), findings) == (False, [])
    np.testing.assert_array_equal(mended, speed)
    mended, outliers, findings = mend_speed_ends("a", TIME_S, speed, PATH_M, "m/s")
    assert outliers.sum() == len(findings) == 1
    assert mended[-1] == pytest.approx(SPEED_M_S[-1], abs=2e-3)


def held_path(at: dict[int, int], *, step: float = 1e-6, speed: Any = 0.1) -> tuple[Any, Any, Any]:
    """Corrected position, finding and true path of a shaft at 0.1 m/s.

    The recorded position repeats the sample at each key of `at` as often as its value specifies.
    """
    true: Any = 0.1 * TIME_S[:400]
    path = quantised(true, step)
    path[0] = true[0] = path[1] - step
    for first, count in at.items():
        path[first + 1 : first + 1 + count] = path[first]
    position, speeds = Position(path, "angle_rad", "rad", 0.5), np.broadcast_to(speed, 400)
    return *replace_stale_positions("a", TIME_S[:400], position, speeds, "the drive"), true


def test_held_positions_of_a_moving_shaft_are_reconstructed_from_the_speed() -> None:
    mended, finding, true = held_path({100: 5, 200: 3})
    np.testing.assert_allclose(mended.path_m, true, atol=2e-6)
    assert (finding.kind, finding.channel, finding.unit) == ("held_samples", "angle_rad", "s")
    assert finding.size == pytest.approx(0.05)


@pytest.mark.parametrize(
    ("at", "step", "speed", "found"),
    [
        ({100: 2}, 1e-6, 0.1, False),  # fewer than three
        ({100: 4}, 1.2e-3, 0.1, False),  # the shaft moves by 3.3 counts
        ({100: 4}, 6e-4, 0.1, True),  # the shaft moves by 6.7 counts
        ({100: 5}, 1e-6, 0.2, False),  # the path does not catch up with the speed
        ({100: 5}, 1e-6, 0.12, True),
        ({4 * k: 3 for k in range(90)}, 1e-6, 0.1, False),  # most of the record
        ({20 * k: 5 for k in range(19)}, 1e-6, 0.1, True),
        ({394: 5}, 1e-6, 0.1, False),  # until the end
        ({393: 5}, 1e-6, 0.1, True),
    ],
)
def test_constant_position_is_held_only_if_its_next_change_makes_up_for_the_missed_travel(
    at: Any, step: float, speed: float, found: bool
) -> None:
    assert (held_path(at, step=step, speed=speed)[1] is not None) == found


def test_constant_position_at_a_stop_of_the_shaft_is_not_held() -> None:
    speed = np.full(400, 0.1)
    speed[101:104] = 0.0
    assert held_path({100: 5}, speed=speed)[1] is None
