"""Motion of a planned run, which is known exactly and is not estimated."""

from __future__ import annotations

import numpy as np

from jbf.records.motion.estimated_motion import EstimatedMotion
from jbf.records.run import Run


def known_motion(run: Run, radius_m: float | None) -> EstimatedMotion:
    """Motion of a planned run, whose speed is exact.

    Parameters
    ----------
    run
        A planned run with an angle or a position.
    radius_m
        Journal radius, m; None on a linear axis.
    """
    velocity = run.velocity
    zero_speed = np.concatenate(([False], velocity == 0.0, [False]))
    # A single zero between two moving samples is a reversal or a bend, not a rest.
    resting = zero_speed[1:-1] & (zero_speed[:-2] | zero_speed[2:])
    angle = run.angle_rad
    if angle is None:
        assert run.position_m is not None
        angle = run.position_m / (radius_m or 1.0)
    return EstimatedMotion(
        velocity=velocity,
        acceleration=np.gradient(velocity, run.time_s),
        angle_rad=angle,
        velocity_error_m_s=np.zeros(len(velocity)),
        resting=resting,
        sign_known=np.ones(len(velocity), dtype=bool),
    )
