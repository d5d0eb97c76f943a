"""Recorded motions as references of a control loop."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from jbf import InputError, Rig, Run
from jbf.control import THESIS_BENCH, follow, run
from jbf.control.task import RECORDED

TIME = np.arange(0.0, 10.0, 0.1)
STEPS = np.arange(0.0, 9.9, 0.002)
RADIUS_M = 0.0127


def recorded(**columns: Any) -> Run:
    """A speed that increases by 1 rad/s each second, with additional columns."""
    return Run.from_arrays(TIME, **{"velocity": RADIUS_M * TIME, **columns})


def test_velocity_reference_of_a_bearing_is_the_recorded_speed_in_rad_per_second() -> None:
    task, reference, load = follow(recorded(load_n=100.0 + TIME), Rig.thesis())
    assert np.allclose(reference[0], STEPS)
    assert np.allclose(reference[1], 1.0)
    assert np.allclose(load, 100.0 + STEPS)
    assert (task.control, task.wave) == ("velocity", RECORDED)
    assert (task.low, task.high, task.seconds) == pytest.approx((0.0, 9.898, 9.9))
    assert task.frequency_rad_s * task.seconds == pytest.approx(2.0 * math.pi)


def test_velocity_reference_of_a_linear_axis_is_the_recorded_speed_in_m_per_second() -> None:
    _, reference, load = follow(recorded(), Rig())
    assert np.allclose(reference[0], RADIUS_M * STEPS)
    assert load is None


def test_reference_from_a_record_starts_at_its_first_sample_with_the_bench_step() -> None:
    motion = Run.from_arrays(TIME + 50.0, RADIUS_M * TIME)
    task, reference, _ = follow(motion, Rig.thesis(), bench=replace(THESIS_BENCH, dt_s=0.01))
    assert len(reference[0]) == 990
    assert (reference[0][0], task.high) == pytest.approx((0.0, 9.89))


def test_reference_uses_a_wrapped_angle_only_if_no_speed_is_recorded() -> None:
    wrapped = Run.from_arrays(TIME, angle_rad=np.mod(TIME**2, 2.0 * np.pi))
    reference = follow(wrapped, Rig.thesis()).reference
    inside = (STEPS > 0.1) & (STEPS < 9.8)
    assert np.allclose(reference[0][inside], 2.0 * STEPS[inside])
    assert np.allclose(follow(recorded(angle_rad=5.0 * TIME), Rig.thesis()).reference[0], STEPS)


@pytest.mark.parametrize(("rig", "rate"), [(Rig.thesis(), 1.0), (Rig(), 2.0)])
def test_position_reference_is_the_recorded_position_relative_to_its_start(
    rig: Rig, rate: float
) -> None:
    motion = recorded(angle_rad=3.0 + TIME, position_m=7.0 + 2.0 * TIME)
    task, reference, _ = follow(motion, rig, "position")
    assert task.is_position
    assert np.allclose(reference[0], rate * STEPS)
    assert np.allclose(reference[1], rate)


def test_record_without_motion_or_without_the_required_position_is_rejected() -> None:
    with pytest.raises(InputError, match="angle is constant"):
        follow(recorded(velocity=np.full(len(TIME), 0.1)), Rig())
    for rig, column in ((Rig.thesis(), "position_m"), (Rig(), "angle_rad")):
        with pytest.raises(InputError, match="no angle to follow"):
            follow(recorded(**{column: TIME}), rig, "position")


@pytest.mark.parametrize("control", ["velocity", "position"])
def test_observed_compensator_follows_a_record_to_a_tenth_of_its_spread(control: Any) -> None:
    time_s = np.arange(0.0, 20.0, 0.02)
    angle = 3.0 + 0.02 * (1.0 - np.cos(time_s)) / RADIUS_M
    load = np.where(time_s < 10.0, 104.0, 150.0)
    motion = Run.from_arrays(time_s, 0.02 * np.sin(time_s), angle_rad=angle, load_n=load)
    task, reference, load_n = follow(motion, Rig.thesis(), control)
    r = run(None, "observed", task, reference=reference, load_n=load_n)
    assert r.true_rms < 0.1 * float(np.std(reference[0]))
