"""Units and names of the friction and motion quantities of a rig.

Every law in newtons and metres is also valid for a torque and an angle, which are equivalent to a
force and a displacement at a radius of one metre. The numerical values are equal; this module
defines their units and names.
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
    """Units and names of a rig's quantities.

    Attributes
    ----------
    motion
        `bearing` (a shaft in bearings: newtons at the journal's surface), `linear` or `rotary`.
    force, speed, length
        Units of friction, speed and displacement.
    friction, velocity
        Labels of friction and speed on the axis of a plot, without the unit.
    noun
        The kind of friction quantity: `force` or `torque`.
    mover
        The moving part.
    sensor
        The sensor of the friction.
    friction_column, speed_column
        Column names in a written record.
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
        """Convert a unit of the catalogue (newtons and metres) to the unit of this rig."""
        conversions = {"bearing": {}, "linear": _LINEAR, "rotary": _ROTARY}[self.motion]
        unit = conversions.get(si, si)
        if self.force in ("N", "N m"):
            return unit
        if unit in ("kg", "kg m^2"):
            return f"{self.force} s^2/{self.length}"
        return _FORCES.sub(self.force, unit)

    def read_by(self, sensor: str) -> Quantities:
        """Return a copy with another sensor."""
        return replace(self, sensor=sensor)

    def in_volts(self) -> Quantities:
        """Quantities of a motor whose recorded voltage replaces its force or torque.

        Coulomb friction is then in V, viscous friction (with the back-EMF) in V s/rad or V s/m, and
        inertia in V s^2/rad or V s^2/m: the constants kS, kV and kA of a feedforward.
        """
        return replace(
            self, force="V", friction="Motor voltage", noun="voltage", friction_column="voltage_v"
        )

    def to_dict(self) -> dict[str, str]:
        """Units of friction, displacement and speed, JSON-serialisable."""
        return {"force": self.force, "motion": self.length, "velocity": self.speed}


BEARING = Quantities(
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
