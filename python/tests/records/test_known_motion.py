"""Motion of a planned run: exact values and rests."""

import numpy as np
from jbf import Run
from jbf.records.motion.known import known_motion
from known_motions import STEP_S, TIME_S, path_of, speed_of


def test_planned_motion_is_the_planned_speed_with_its_slope() -> None:
    run = Run.from_arrays(TIME_S, speed_of(TIME_S), angle_rad=path_of(TIME_S) / 0.05)
    motion = known_motion(run, 0.05)
    slope = (speed_of(TIME_S + 1e-6) - speed_of(TIME_S - 1e-6)) / 2e-6
    np.testing.assert_array_equal(motion.velocity, speed_of(TIME_S))
    np.testing.assert_allclose(motion.acceleration[1:-1], slope[1:-1], atol=2.0 * STEP_S**2)
    np.testing.assert_allclose(motion.angle_rad, path_of(TIME_S) / 0.05)
    assert not motion.resting.any()
    assert motion.sign_known.all()


def test_planned_motion_rests_at_two_successive_samples_of_zero_speed() -> None:
    speed = np.array([0.1, 0.0, -0.1, 0.0, 0.0, 0.2, 0.2, 0.3, 0.2, 0.0])
    run = Run.from_arrays(STEP_S * np.arange(10), speed, position_m=np.zeros(10))
    assert known_motion(run, None).resting.tolist() == [False] * 3 + [True] * 2 + [False] * 5
