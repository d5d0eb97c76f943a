"""Recorded path of the journal or the slider, in metres, with the name of its column."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from jbf.arrays import Array
from jbf.records.angles import continuous
from jbf.records.motion.ratio import metres_per_unit
from jbf.records.run import Run


@dataclass(frozen=True)
class Position:
    """A recorded path.

    Attributes
    ----------
    path_m
        The path, m.
    column, unit
        Name and unit of the recorded column.
    arm_m
        Metres of path per unit of the column: the journal radius, or one.
    """

    path_m: Array
    column: str
    unit: str
    arm_m: float

    def along(self, path_m: Array) -> Position:
        """Return the position record with another path, m."""
        return replace(self, path_m=path_m)


def recorded_position(run: Run, radius_m: float | None) -> Position | None:
    """Recorded path of a run, m; None if only the speed was recorded."""
    if run.angle_rad is not None and radius_m is not None:
        return Position(continuous(run.angle_rad) * radius_m, "angle_rad", "rad", radius_m)
    if run.position_m is not None:
        return Position(run.position_m, "position_m", "m", 1.0)
    if run.angle_rad is not None and run.speed_recorded:
        return _position_from_ratio(run.time_s, continuous(run.angle_rad), run.velocity)
    return None


def travel_of(run: Run, radius_m: float | None) -> float:
    """Largest distance between two positions of a run, m (rad for a rotary drive)."""
    position = recorded_position(run, radius_m)
    if position is not None:
        return float(np.ptp(position.path_m))
    steps = 0.5 * (run.velocity[1:] + run.velocity[:-1]) * np.diff(run.time_s)
    return float(np.ptp(np.concatenate(([0.0], np.cumsum(steps)))))


def _position_from_ratio(time: Array, angle: Array, speed: Array) -> Position | None:
    """Convert an angle of unknown radius to a path, by its ratio to the speed.

    Returns None if this ratio is not constant.
    """
    radius = metres_per_unit(time, angle, speed)
    if radius is None:
        return None
    return Position(angle * radius, "angle_rad", "rad", radius)
