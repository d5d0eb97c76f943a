"""Where the journal or the slider was: the recorded path, in metres, with its column's name."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from jbf.records.motion.ratio import way_per_unit
from jbf.records.run import Run

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Position:
    """A recorded path.

    Attributes
    ----------
    path_m
        The path, m.
    column, unit
        Of the record.
    arm_m
        Metres of path a unit of the column: the journal's radius, or one.
    """

    path_m: Array
    column: str
    unit: str
    arm_m: float

    def along(self, path_m: Array) -> Position:
        """The same column with another path."""
        return replace(self, path_m=path_m)


def recorded_position(run: Run, radius_m: float | None) -> Position | None:
    """The path on record; None where only the speed tells of it."""
    if run.angle_rad is not None and radius_m is not None:
        return Position(np.unwrap(run.angle_rad) * radius_m, "angle_rad", "rad", radius_m)
    if run.position_m is not None:
        return Position(run.position_m, "position_m", "m", 1.0)
    if run.angle_rad is not None and run.speed_recorded:
        return _by_its_speed(run.time_s, np.unwrap(run.angle_rad), run.velocity_m_s)
    return None


def _by_its_speed(time: Array, angle: Array, speed: Array) -> Position | None:
    """The path of an angle for which no radius is known: by the way a radian that its speed tells,
    where that is the same all the time."""
    radius = way_per_unit(time, angle, speed)
    if radius is None:
        return None
    return Position(angle * radius, "angle_rad", "rad", radius)
