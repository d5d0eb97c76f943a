"""Path and speed that differ by a factor: wrong units, wrong signs, unknown radius."""

from typing import Any

import numpy as np
import pytest
from jbf import Run
from jbf.records.motion.estimated_motion import estimate_motion
from jbf.records.motion.position import Position, recorded_position
from jbf.records.motion.ratio import factor_between, metres_per_unit, slope_near
from jbf.records.motion.units import wrong_unit
from jbf.records.motion.window_comparisons import HALF_WIDTHS, window_comparisons
from jbf.records.quantities import BEARING, LINEAR, ROTARY, Quantities
from known_motions import TIME_S, path_of, quantised, speed_of, white

PATH_M, SPEED_M_S = path_of(TIME_S), speed_of(TIME_S)
TURN = 2.0 * np.pi


def test_windows_of_a_parabolic_path_have_its_mean_speed_and_acceleration() -> None:
    time_s: Any = 0.1 * np.arange(200)
    path = 0.5 * 3.0 * time_s**2
    windows = window_comparisons(time_s, path, 6.0 * time_s)
    for half, window in zip(HALF_WIDTHS, windows, strict=True):
        inner = time_s[2 * half : -2 * half]
        np.testing.assert_allclose(window.by_path, 3.0 * inner)
        np.testing.assert_allclose(window.by_speed, 6.0 * inner, rtol=1e-9)
        np.testing.assert_allclose(window.acceleration, 3.0, rtol=1e-9)
        assert window.count == pytest.approx((path[1] - path[0]) / (2 * half * 0.1))


def test_windows_of_path_and_speed_that_contain_a_gap_are_omitted() -> None:
    time_s: Any = np.concatenate((0.1 * np.arange(100), 50.0 + 0.1 * np.arange(100)))
    windows = window_comparisons(time_s, time_s, np.ones(200))
    assert [len(w.by_path) for w in windows] == [200 - 16, 200 - 32, 200 - 64]


def test_number_of_window_widths_depends_on_the_length_of_the_record() -> None:
    for samples, widths in ((67, 0), (68, 1), (75, 1), (76, 2), (92, 3)):
        clock: Any = 0.1 * np.arange(samples)
        assert len(list(window_comparisons(clock, clock, np.ones(samples)))) == widths


@pytest.mark.parametrize("factor", [1.25, -1.0, 57.3, 1e-3, 0.75])
def test_factor_between_path_and_speed_is_recovered_if_wrong_by_25_percent(factor: float) -> None:
    path = factor * PATH_M
    assert factor_between(TIME_S, path, SPEED_M_S) == pytest.approx(factor, rel=5e-3)
    assert slope_near(TIME_S, path, SPEED_M_S, factor) == pytest.approx(factor, rel=2e-3)
    way = metres_per_unit(TIME_S, path, SPEED_M_S)
    assert way == (None if factor < 0.0 else pytest.approx(1.0 / factor, rel=2e-3))


def test_factor_between_path_and_speed_is_reported_beyond_20_percent() -> None:
    factors = [factor_between(TIME_S, f * PATH_M, SPEED_M_S) for f in (1.0, 1.18, 1.22, 0.82, 0.78)]
    assert [factor is not None for factor in factors] == [False, False, True, False, True]


def test_slope_search_returns_its_initial_factor_if_that_factor_is_wrong() -> None:
    assert slope_near(TIME_S, PATH_M, SPEED_M_S, 7.0) == 7.0


def test_unrelated_or_short_path_and_speed_have_no_factor() -> None:
    unrelated = white(len(TIME_S), 1)
    assert factor_between(TIME_S, PATH_M, unrelated) is None
    assert metres_per_unit(TIME_S, PATH_M, unrelated) is None
    assert factor_between(TIME_S[:60], 3.0 * PATH_M[:60], SPEED_M_S[:60]) is None


@pytest.mark.parametrize(("growth", "found"), [(8.0, False), (0.5, True)])
def test_changing_ratio_of_path_and_speed_is_not_reported(growth: float, found: bool) -> None:
    path = 0.1 * (2.0 * TIME_S + 0.5 * growth * TIME_S**2 / TIME_S[-1])
    for function in (factor_between, metres_per_unit):
        assert (function(TIME_S, path, np.full(len(TIME_S), 0.1)) is not None) == found


@pytest.mark.parametrize("gap_s", [0.5, 2.0])
def test_gaps_of_a_fast_motion_do_not_change_the_ratio_of_path_and_speed(gap_s: float) -> None:
    time_s: Any = 0.02 * np.arange(900)
    for begin_s in (3.1, 8.4, 13.3):
        time_s = time_s[(time_s < begin_s) | (time_s > begin_s + gap_s)]
    rate = 2.0 * np.pi * 1.7
    path = -0.2 / rate * np.cos(rate * time_s) + 0.02 * time_s
    speed = 0.2 * np.sin(rate * time_s) + 0.02
    assert factor_between(time_s, path, speed) is None
    assert factor_between(time_s, 1.386 * path, speed) == pytest.approx(1.386, rel=0.02)


@pytest.mark.parametrize("even", [True, False])
def test_distance_per_radian_of_a_slow_quantised_motion_is_recovered(even: bool) -> None:
    random = np.random.default_rng(9)
    steps = np.full(8000, 0.003) if even else random.choice([0.005, 0.05], 4000, p=[0.7, 0.3])
    time_s = np.cumsum(steps)
    counts = quantised(0.1 * np.sin(0.5 * time_s), 4e-4)
    speed = 0.05 * np.cos(0.5 * time_s) + white(len(time_s), 9, 1e-3)
    assert metres_per_unit(time_s, counts, speed) == 1.0
    assert metres_per_unit(time_s, counts, 0.03 * speed) == pytest.approx(0.03, rel=0.01)


def mismatch(column: str, factor: float, arm_m: float = 1.0, kind: Quantities = BEARING) -> Any:
    """Mismatch of a path whose derivative is `factor` times the speed."""
    position = Position(factor * PATH_M, column, column.rpartition("_")[2], arm_m)
    return wrong_unit("a", TIME_S, position, SPEED_M_S, kind)


@pytest.mark.parametrize(
    ("column", "factor", "arm_m", "kind", "channel", "hint"),
    [
        ("angle_rad", 360.0 / TURN, 0.3, BEARING, "angle_rad", "degrees"),
        ("angle_rad", 1.0 / TURN, 0.3, BEARING, "angle_rad", "turns"),
        ("angle_rad", 0.3, 0.3, BEARING, "velocity_m_s", "rad/s"),
        ("angle_rad", 0.3 * TURN / 360.0, 0.3, BEARING, "velocity_m_s", "degrees per second"),
        ("angle_rad", 0.3 * TURN / 60.0, 0.3, BEARING, "velocity_m_s", "revolutions per minute"),
        ("angle_rad", TURN / 60.0, 1.0, ROTARY, "velocity_m_s", "revolutions per minute"),
        ("position_m", 1e3, 1.0, LINEAR, "position_m", "mm"),
        ("position_m", 1e6, 1.0, LINEAR, "position_m", "um"),
        ("position_m", 1e-3, 1.0, LINEAR, "velocity_m_s", "mm/s"),
        ("position_m", 1e-6, 1.0, LINEAR, "velocity_m_s", "um/s"),
        ("position_m", 1.0 / 60.0, 1.0, LINEAR, "velocity_m_s", "m/min"),
    ],
)
def test_wrong_unit_of_path_or_speed_is_recognised_by_their_ratio(
    column: str, factor: float, arm_m: float, kind: Quantities, channel: str, hint: str
) -> None:
    for signed in (factor, -factor):
        found = mismatch(column, signed, arm_m, kind)
        assert (found.finding.kind, found.finding.channel) == ("units", channel)
        assert found.finding.size == pytest.approx(signed, rel=5e-3)
        assert found.factor == pytest.approx(signed, rel=1e-12)
        assert found.of_speed == (channel == "velocity_m_s")
        assert f" {hint}?" in found.finding.words


def test_ratio_of_path_and_speed_that_matches_no_unit_is_applied_to_the_path() -> None:
    found = mismatch("angle_rad", 5.0, 0.3)
    assert (found.finding.channel, found.factor) == ("angle_rad", pytest.approx(5.0, rel=2e-3))


def test_ratio_of_path_and_speed_means_millimetres_if_within_5_percent() -> None:
    for factor, is_unit in ((1.05e3, True), (1.1e3, False)):
        assert ("mm" in mismatch("position_m", factor).finding.words) == is_unit


def test_ratio_of_path_and_speed_near_minus_one_is_a_wrong_sign() -> None:
    for factor in (-1.0, -1.15):
        found = mismatch("angle_rad", factor, 0.3)
        assert (found.finding.kind, found.factor, found.of_speed) == ("sign", -1, False)
    assert mismatch("angle_rad", -1.3, 0.3).finding.kind == "units"
    assert mismatch("angle_rad", 1.0, 0.3) is None


def test_path_is_the_unwrapped_angle_times_the_radius_or_else_the_position() -> None:
    angle = np.mod(8.0 * TIME_S, TURN)
    run = Run.from_arrays(TIME_S, SPEED_M_S, angle_rad=angle, position_m=PATH_M)
    by_angle: Any = recorded_position(run, 0.25)
    np.testing.assert_allclose(by_angle.path_m, 2.0 * TIME_S, atol=1e-12)
    assert (by_angle.column, by_angle.unit, by_angle.arm_m) == ("angle_rad", "rad", 0.25)
    by_position: Any = recorded_position(run, None)
    assert (by_position.column, by_position.unit, by_position.arm_m) == ("position_m", "m", 1.0)
    assert recorded_position(Run.from_arrays(TIME_S, SPEED_M_S), 0.25) is None
    assert recorded_position(Run.from_arrays(TIME_S, angle_rad=PATH_M), None) is None


@pytest.mark.parametrize("radius_m", [1.0, 0.31, 0.0127])
def test_motion_is_recovered_from_speed_and_angle_if_the_radius_is_unknown(radius_m: float) -> None:
    angle = np.round(PATH_M / radius_m, 5)
    speed = SPEED_M_S + white(len(TIME_S), 0, 1e-4)
    motion = estimate_motion(Run.from_arrays(TIME_S, speed, angle_rad=angle), None)
    assert motion.findings == ()
    assert np.std(motion.velocity - SPEED_M_S) < 0.5e-4
    assert np.max(np.abs(np.diff(motion.angle_rad - angle))) < 1e-4


def test_angle_unrelated_to_the_speed_is_unwrapped_but_not_used_for_speed() -> None:
    angle = np.mod(np.cumsum(np.random.default_rng(3).uniform(0.0, 1.0, len(TIME_S))), TURN)
    motion = estimate_motion(Run.from_arrays(TIME_S, SPEED_M_S, angle_rad=angle), None)
    np.testing.assert_allclose(motion.angle_rad, np.unwrap(angle))
    np.testing.assert_allclose(motion.velocity, SPEED_M_S, atol=1e-4)
