"""Columns in the files of a drive, and their conversion to the driven part on reading.

Columns that begin with `motor_`, the current and the percentages refer to the motor. They are
converted to the joint or the slide with `gear_ratio` and `pitch_m`. If several columns hold the
same quantity, the first in the lists below is read.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from jbf.arrays import Array
from jbf.errors import InputError
from jbf.records.angles import continuous
from jbf.records.checks import frozen
from jbf.records.drive import Drive
from jbf.records.findings.finding import Finding

COLUMNS_OF_EVERY_DRIVE = ("time_s", "load_n", "temperature_c")
RPM = 2.0 * math.pi / 60.0
"""One turn per minute in radians per second."""
ALIASES = {
    "torque": "torque_n_m",
    "torque_nm": "torque_n_m",
    "motor_torque": "motor_torque_n_m",
    "current": "current_a",
    "iq": "current_a",
    "voltage": "voltage_v",
    "volts": "voltage_v",
    "load_torque": "load_n_m",
    "load_torque_n_m": "load_n_m",
    "i_a": "current_a",
    "torque_pct": "torque_percent",
    "force_pct": "force_percent",
    "angle": "angle_rad",
    "position_rad": "angle_rad",
    "omega": "velocity_rad_s",
    "speed_rad_s": "velocity_rad_s",
    "rpm": "speed_rpm",
    "motor_rpm": "motor_speed_rpm",
    "position": "position_m",
    "velocity": "velocity_m_s",
    "force_n": "friction_n",
}
"""Common alternative names of the columns of a drive, used only for suggestions."""
_ENDS = {
    "_n_m": "1 N m",
    "_a": "1 A",
    "_v": "1 V",
    "_percent": "1 %",
    "_rpm": "1 revolution per minute",
    "_rad_s": "1 rad/s",
    "_rad": "1 rad",
}
"""Name of one unit of a column, by the suffix of the column name."""
_TURNED = ("angle_rad", "motor_angle_rad")


@dataclass(frozen=True)
class DriveColumns:
    """Columns that the files of a drive may have, with their conversion factors.

    For each quantity: the column names, each with its conversion factor to the driven part.
    """

    drive: Drive
    friction: dict[str, float]
    speed: dict[str, float]
    place: dict[str, float]

    @classmethod
    def of(cls, drive: Drive) -> DriveColumns:
        """Create the table of columns for a drive."""
        motor = drive.motor_rad
        if drive.motion == "rotary":
            speed, place = {"velocity_rad_s": 1.0, "speed_rpm": RPM}, {"angle_rad": 1.0}
        else:
            speed, place = {"velocity_m_s": 1.0}, {"position_m": 1.0}
        if motor is not None:
            speed |= {"motor_velocity_rad_s": 1.0 / motor, "motor_speed_rpm": RPM / motor}
            place |= {"motor_angle_rad": 1.0 / motor}
        return cls(drive, _friction(drive), speed, place)

    @property
    def known(self) -> tuple[str, ...]:
        """All columns with a defined meaning for this drive."""
        of_link = ("weight_angle_rad",) if self.drive.motion == "rotary" else ()
        return (*COLUMNS_OF_EVERY_DRIVE, *self.friction, *self.speed, *self.place, *of_link)

    @property
    def quantities(self) -> tuple[tuple[str, ...], ...]:
        """Columns of each quantity that is read: friction, speed, position, and further columns."""
        of_link = ("weight_angle_rad",) if self.drive.motion == "rotary" else ()
        further = tuple((name,) for name in (*COLUMNS_OF_EVERY_DRIVE, *of_link))
        return tuple(q for q in map(tuple, (self.friction, self.speed, self.place)) if q) + further

    def alternatives(self, name: str) -> tuple[str, ...]:
        """Columns that can replace the required column `name`, and this column itself."""
        motion = (*self.speed, *self.place)
        quantities = (motion, *self.quantities)
        return next((columns for columns in quantities if name in columns), (name,))

    def required(self, header: Sequence[str], need_friction: bool) -> list[str]:
        """Return the required columns: the time, a motion and a friction.

        For each quantity this is the column that is present in the header, or otherwise the first
        possible one.
        """

        def sole(names: Sequence[str]) -> str:
            return next((name for name in names if name in header), names[0])

        columns = ["time_s", sole([*self.speed, *self.place])]
        return columns + ([sole([*self.friction])] if need_friction and self.friction else [])

    def refuse_foreign_columns(self, path: Path, row: int, header: Sequence[str]) -> None:
        """Raise an InputError if the file has a column of another kind of machine."""
        section = f'the rig\'s [drive] has motion = "{self.drive.motion}"'
        for name, remedy in _foreign_columns(self).items():
            if name in header:
                problem = f"does not match the rig: {section}"
                if name in ("friction_n", "velocity_m_s", "position_m"):
                    problem += f', friction = "{self.drive.friction}"'
                raise InputError(file=path, row=row, column=name, problem=problem, remedy=remedy)

    def converted(
        self, name: str, columns: Mapping[str, Array]
    ) -> tuple[dict[str, Array], tuple[Finding, ...]]:
        """Return the columns under the names used in a run, and the conversions as findings."""
        renamed = dict(columns)
        findings: list[Finding] = []
        for target, sizes, si in self._targets():
            recorded = [column for column in sizes if column in columns]
            if not recorded:
                continue
            column, *unread = recorded
            size = sizes[column]
            values = renamed.pop(column)
            if column in _TURNED and size != 1.0:
                values = continuous(values)
            renamed[target] = values if size == 1.0 else frozen(values * size)
            # The default gear ratio is 1, and a missing one should be noticed.
            if size != 1.0 or column.startswith("motor_"):
                findings.append(self._conversion(name, target, column, size, si))
            findings += [_not_read(name, target, unread_column, column) for unread_column in unread]
        return renamed, tuple(findings)

    def _conversion(self, name: str, target: str, column: str, size: float, si: str) -> Finding:
        source_unit = next(unit for end, unit in _ENDS.items() if column.endswith(end))
        words = f"{column} was converted: {source_unit} = {size:.5g} {si}"
        if column.startswith("motor_"):
            words += f" with gear_ratio = {self.drive.gear_ratio:g}"
        return Finding("converted", target, name, size, si, "converted on reading", words)

    def called(self, columns: Mapping[str, Array]) -> dict[str, str]:
        """Map each file column that is read to its name in a run."""
        read = (
            (next((c for c in sizes if c in columns), ""), t) for t, sizes, _ in self._targets()
        )
        return {column: target for column, target in read if column}

    def _targets(self) -> tuple[tuple[str, Mapping[str, float], str], ...]:
        """Column name in a run, file columns with conversion factors, and unit, by quantity."""
        unit = self.drive.quantities
        place = "angle_rad" if self.drive.motion == "rotary" else "position_m"
        return (
            ("friction_n", self.friction, unit.force),
            ("velocity_m_s", self.speed, unit.speed),
            (place, self.place, unit.length),
        )


def _friction(drive: Drive) -> dict[str, float]:
    if drive.friction == "none":
        return {}
    if drive.friction == "voltage":
        return {"voltage_v": 1.0}
    if drive.friction == "force":
        return {"friction_n": 1.0, "force_n": 1.0}
    if drive.friction == "torque":
        assert drive.motor_rad is not None
        of_joint = {"torque_n_m": 1.0} if drive.motion == "rotary" else {}
        return of_joint | {"motor_torque_n_m": drive.motor_rad}
    if drive.friction == "current":
        return {"current_a": drive.unit_n}
    return {"torque_percent" if drive.rated_force_n is None else "force_percent": drive.unit_n}


def _foreign_columns(columns: DriveColumns) -> dict[str, str]:
    """Columns of other kinds of machines that this drive cannot have, each with a remedy."""
    first = next(iter(columns.friction), None)
    remedies = {}
    if first not in ("friction_n", None):
        remedies["friction_n"] = f"keep {first} and remove it, or correct [drive]"
    if columns.drive.motion == "rotary":
        for name, replacement in (("velocity_m_s", "velocity_rad_s"), ("position_m", "angle_rad")):
            remedies[name] = f"give {replacement}, or correct [drive]"
        return remedies
    remedies["weight_angle_rad"] = "remove it: on a slide the weight is constant (sensor_offset)"
    remedies["angle_rad"] = (
        'an angle needs motion = "rotary"; rename the motor\'s angle to motor_angle_rad'
    )
    for name in ("velocity_rad_s", "speed_rpm"):
        remedies[name] = f'it needs motion = "rotary"; rename the motor\'s speed to motor_{name}'
    if columns.drive.pitch_m is None:
        for name in ("motor_angle_rad", "motor_velocity_rad_s", "motor_speed_rpm"):
            remedies[name] = (
                "give [drive] its pitch_m (travel per revolution), or rename the column"
            )
    if columns.drive.friction == "torque":
        remedies["torque_n_m"] = "rename it to motor_torque_n_m if it is the motor's"
    return remedies


def _not_read(name: str, target: str, unread: str, column: str) -> Finding:
    words = f"{unread} is also recorded; {column} is used"
    return Finding("second_column", target, name, 0.0, "1", "kept, not used", words)
