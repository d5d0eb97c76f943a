"""Recorded run as the reference of a loop: its motion and load."""

from __future__ import annotations

from typing import Literal, NamedTuple

import numpy as np

from jbf.arrays import Array
from jbf.control.bench import THESIS_BENCH, Bench
from jbf.control.task import RECORDED, Task
from jbf.errors import InputError
from jbf.records.angles import continuous
from jbf.records.rig import Rig
from jbf.records.run import Run


class Motion(NamedTuple):
    """Recorded motion as arguments of `jbf.control.run`.

    Attributes
    ----------
    task
        Task with the duration of the recording.
    reference
        Reference and its rate of change, one value per step; None for a periodic task.
    load_n
        Load on one bearing, N, one value per step; None if it was not recorded.
    """

    task: Task
    reference: tuple[Array, Array] | None
    load_n: Array | None


def follow(
    recorded: Run,
    rig: Rig,
    control: Literal["position", "velocity"] = "velocity",
    bench: Bench = THESIS_BENCH,
) -> Motion:
    """Convert a recorded motion to the reference of a loop, linear between its samples.

    Parameters
    ----------
    recorded
        Run whose speed or angle is followed. Its load, if recorded, acts on the bench.
    rig
        Rig whose journal radius converts m/s to rad/s. Without a bearing, 1 m is taken as 1 rad.
    control
        Controlled quantity.
    bench
        Bench whose step is used.

    Raises
    ------
    InputError
        Position control of a run without an angle, or a run that does not move.
    """
    radius_m = 1.0 if rig.bearing is None else rig.bearing.radius_m
    values = recorded.velocity / radius_m
    if not recorded.speed_recorded and recorded.angle_rad is not None:
        values = np.gradient(continuous(recorded.angle_rad), recorded.time_s)
    if control == "position":
        where = recorded.angle_rad if rig.bearing is not None else recorded.position_m
        if where is None:
            raise InputError(
                file=recorded.path,
                problem="has no angle to follow",
                remedy="add angle_rad, or follow its speed: --control velocity",
            )
        values = where - where[0]
    time_s = recorded.time_s - recorded.time_s[0]
    steps = np.arange(0.0, time_s[-1], bench.dt_s)
    value = np.interp(steps, time_s, values)
    if not np.ptp(value) > 0.0:
        raise InputError(
            file=recorded.path, problem="the angle is constant", remedy="name a run with motion"
        )
    rate = np.interp(steps, time_s, np.gradient(values, time_s))
    load = None if recorded.load_n is None else np.interp(steps, time_s, recorded.load_n)
    seconds = len(steps) * bench.dt_s
    low, high = float(np.min(value)), float(np.max(value))
    task = Task(control, RECORDED, low, high, 2.0 * np.pi / seconds, seconds)
    return Motion(task, (value, rate), load)
