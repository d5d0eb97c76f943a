"""The quantities in which a rig's friction and motion are told: units, and the words for them.

Every law in newtons holds for any pair of a force and its way: a force over metres, or a torque
over radians, at a radius of one. The numbers are the same; this module knows what they are called.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from typing import Literal

Motion = Literal["bearing", "linear", "rotary"]

_ROTARY = {
    "N": "N m",
    "N/s": "N m/s",
    "m": "rad",
    "m/s": "rad/s",
    "s/m": "s/rad",
    "N/m": "N m/rad",
    "N s/m": "N m s/rad",
    "N s^2/m^2": "N m s^2/rad^2",
    "1/N^2": "1/(N m)^2",
    "kg": "kg m^2",
}
_LINEAR = {"N m/rad": "N/m", "N m s/rad": "N s/m", "kg m^2": "kg"}
_FORCES = re.compile(r"\(N m\)|N m\b|N\b")


@dataclass(frozen=True)
class Quantities:
    """What a rig's numbers are.

    Attributes
    ----------
    motion
        `bearing` (a shaft in bearings: newtons at the journal's surface), `linear` or `rotary`.
    force, speed, length
        Units of friction, speed and way.
    friction, velocity
        Friction and speed as an axis of a plot calls them, without the unit.
    noun
        What friction is: `force` or `torque`.
    mover
        What moves.
    sensor
        What reads the friction.
    friction_column, speed_column
        What a written record calls them.
    """

    motion: Motion
    force: str
    speed: str
    length: str
    friction: str
    velocity: str
    noun: str
    mover: str
    sensor: str
    friction_column: str = "friction_n"
    speed_column: str = "velocity_m_s"

    def unit(self, si: str) -> str:
        """What a unit of the catalogue, whose laws are in newtons and metres, is here."""
        known = {"bearing": {}, "linear": _LINEAR, "rotary": _ROTARY}[self.motion]
        unit = known.get(si, si)
        if self.force in ("N", "N m"):
            return unit
        if unit in ("kg", "kg m^2"):
            return f"{self.force} s^2/{self.length}"
        return _FORCES.sub(self.force, unit)

    def read_by(self, sensor: str) -> Quantities:
        """The same, read by another sensor."""
        return replace(self, sensor=sensor)

    def in_volts(self) -> Quantities:
        """The quantities of a motor whose voltage stands for its force or torque.

        Coulomb friction is then in V, viscous friction (with the back-EMF) in V s/rad or V s/m, and
        inertia in V s^2/rad or V s^2/m: the constants kS, kV and kA of a feedforward.
        """
        return replace(
            self, force="V", friction="Motor voltage", noun="voltage", friction_column="voltage_v"
        )

    def to_dict(self) -> dict[str, str]:
        """For JSON: the units of what the keys end in `_n`, `_m_s` and `_m` of."""
        return {"force": self.force, "velocity": self.speed, "length": self.length}


OF_BEARING = Quantities(
    "bearing", "N", "m/s", "m", "Friction of one bearing", "Surface speed", "force",
    "the shaft", "the load cell",
)  # fmt: skip
LINEAR = Quantities(
    "linear", "N", "m/s", "m", "Friction force", "Speed", "force",
    "the drive", "the force sensor",
)  # fmt: skip
ROTARY = Quantities(
    "rotary", "N m", "rad/s", "rad", "Friction torque", "Speed", "torque",
    "the drive", "the torque sensor", "torque_n_m", "velocity_rad_s",
)  # fmt: skip
