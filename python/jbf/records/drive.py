"""Drive of a machine: section `[drive]` of `rig.toml`, with motion and friction measurement."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any, Literal, get_args

from jbf.errors import InputError, did_you_mean, quoted
from jbf.records.quantities import LINEAR, ROTARY, Quantities
from jbf.records.toml_file import positive, refuse_unknown, require, table
from jbf.units.quantity import quantities

Kind = Literal["rotary", "linear"]
Friction = Literal["force", "torque", "current", "percent", "voltage", "none"]

_CONSTANTS: dict[tuple[str, str], tuple[str, ...]] = {
    ("rotary", "torque"): (),
    ("rotary", "current"): ("torque_constant_n_m_a",),
    ("rotary", "percent"): ("rated_torque_n_m",),
    ("linear", "force"): (),
    ("linear", "torque"): (),
    ("linear", "current"): ("force_constant_n_a", "torque_constant_n_m_a"),
    ("linear", "percent"): ("rated_force_n", "rated_torque_n_m"),
    ("rotary", "voltage"): (),
    ("linear", "voltage"): (),
    ("rotary", "none"): (),
    ("linear", "none"): (),
}
"""Constants that convert a reading into a force or a torque, by motion and reading.

Exactly one of the listed constants is required.
"""
_ALL_CONSTANTS = tuple(dict.fromkeys(name for names in _CONSTANTS.values() for name in names))
_SENSORS = {
    "force": "the force sensor",
    "torque": "the torque sensor",
    "current": "the current sensor",
    "percent": "the torque reading of the drive",
    "voltage": "the motor's voltage",
    "none": "the deceleration",
}


@dataclass(frozen=True)
class Drive:
    """A rotary or linear drive, and the meaning of its columns.

    Attributes
    ----------
    motion : str
        `rotary` (results in N m and rad) or `linear` (in N and m).
    friction : str
        The recorded quantity: `force`, `torque`, `current` (A), `percent` of a rated value,
        `voltage` (V; results are in volts), or `none`: a coast-down or free swing, whose friction
        is the known mass or inertia times the deceleration.
    torque_constant_n_m_a, force_constant_n_a : float, optional
        Torque of the motor, N m, or force of a linear motor, N, per ampere.
    rated_torque_n_m, rated_force_n : float, optional
        Torque or force at 100 %, at the motor.
    gear_ratio : float
        Turns of the motor per turn of the driven part: the joint, or the screw.
    pitch_m : float, optional
        Travel of a linear drive per turn of its screw (lead), or of its pinion or pulley, m.
    inertia_kg_m2, mass_kg : float, optional
        Known moved inertia or mass, reported together with the estimate of `inertia`. Required for
        `friction = "none"`, in order to convert the deceleration into a force.

    Raises
    ------
    InputError
        A constant that the recorded quantity requires is missing, or is not above zero.

    Examples
    --------
    >>> drive = jbf.Drive("rotary", "current", torque_constant_n_m_a=0.05, gear_ratio=100.0)
    >>> jbf.Rig(drive=drive).quantities.force
    'N m'
    """

    motion: Kind
    friction: Friction
    torque_constant_n_m_a: float | None = None
    force_constant_n_a: float | None = None
    rated_torque_n_m: float | None = None
    rated_force_n: float | None = None
    gear_ratio: float = 1.0
    pitch_m: float | None = None
    inertia_kg_m2: float | None = None
    mass_kg: float | None = None

    def __post_init__(self) -> None:
        _check_word("motion", self.motion, get_args(Kind))
        readings = [friction for motion, friction in _CONSTANTS if motion == self.motion]
        _check_word("friction", self.friction, readings, f" of a {self.motion} drive")
        if isinstance(self.gear_ratio, str):
            remedy = "write the turns of the motor per turn of the driven part, such as 50"
            raise _wrong("gear_ratio", f"{quoted(self.gear_ratio)} is not a number", remedy)
        for name in (f.name for f in fields(self)):
            value = getattr(self, name)
            if name in ("motion", "friction") or value is None:
                continue
            object.__setattr__(self, name, positive(value, name))
        self._check_constants()
        misplaced = "mass_kg" if self.motion == "rotary" else "inertia_kg_m2"
        strangers = (misplaced, "pitch_m") if self.motion == "rotary" else (misplaced,)
        for name in strangers:
            if getattr(self, name) is not None:
                raise _wrong(name, f"does not apply to a {self.motion} drive", "remove it")
        if self.friction == "none" and self.moved is None:
            name = "inertia_kg_m2" if self.motion == "rotary" else "mass_kg"
            problem = 'is missing, and is required for friction = "none"'
            raise _wrong(
                name,
                problem,
                "write the known value; friction is its product with the deceleration",
            )
        if self.motion == "linear" and self.pitch_m is None:
            turning = self.friction == "torque" or self._of_motor is not None
            if turning or self.gear_ratio != 1.0:
                problem = "is missing, and is required to convert the motor's torque to a force"
                remedy = "write the travel per revolution of the screw, m"
                raise _wrong("pitch_m", problem, remedy)

    def _check_constants(self) -> None:
        required = _CONSTANTS[self.motion, self.friction]
        given = [name for name in _ALL_CONSTANTS if getattr(self, name) is not None]
        for name in given:
            if name not in required:
                problem = f'is not used for a {self.motion} drive with friction = "{self.friction}"'
                raise _wrong(name, problem, "remove it, or correct friction")
        if required and len(given) != 1:
            problem = "are both given" if given else "is missing"
            remedy = "keep one of them" if given else f'friction = "{self.friction}" needs it'
            raise _wrong(" or ".join(required), problem, remedy)

    @property
    def moved(self) -> float | None:
        """Known inertia (kg m^2) or mass (kg) that the drive accelerates; None if unknown."""
        return self.inertia_kg_m2 if self.motion == "rotary" else self.mass_kg

    @property
    def _of_motor(self) -> float | None:
        """Motor torque, N m, per unit of the reading; None for a force sensor or a linear motor."""
        if self.torque_constant_n_m_a is not None:
            return self.torque_constant_n_m_a
        return None if self.rated_torque_n_m is None else self.rated_torque_n_m / 100.0

    @property
    def motor_rad(self) -> float | None:
        """Motor angle, rad, per unit of travel of the driven part (rad or m); None if unknown."""
        if self.motion == "rotary":
            return self.gear_ratio
        return None if self.pitch_m is None else self.gear_ratio * 2.0 * math.pi / self.pitch_m

    @property
    def unit_n(self) -> float:
        """Force or torque at the driven part per ampere or per percent, N or N m."""
        if self.force_constant_n_a is not None:
            return self.force_constant_n_a
        if self.rated_force_n is not None:
            return self.rated_force_n / 100.0
        assert self._of_motor is not None
        assert self.motor_rad is not None
        return self._of_motor * self.motor_rad

    @property
    def quantities(self) -> Quantities:
        """Units and names of the quantities in results."""
        kind = ROTARY if self.motion == "rotary" else LINEAR
        read = kind.read_by(_SENSORS[self.friction])
        return read.in_volts() if self.friction == "voltage" else read

    @classmethod
    def from_mapping(cls, content: object, prefix: str) -> Drive:
        """Create a drive from its TOML section; errors name the key, preceded by `prefix`."""
        keys = [f.name for f in fields(cls)]
        section: Mapping[str, Any] = table(content, prefix)
        refuse_unknown(section, keys, f"{prefix}.")
        require(section, ("motion", "friction"), prefix)
        try:
            return cls(**quantities(section, ""))
        except InputError as error:
            raise error.within(key_prefix=f"{prefix}.") from None


def _check_word(key: str, word: object, words: Sequence[str], context: str = "") -> None:
    if word not in words:
        shown = quoted(word) if isinstance(word, str) else f"a {type(word).__name__}"
        raise _wrong(key, f"{shown} is not a valid {key}{context}", did_you_mean(word, words))


def _wrong(key: str, problem: str, remedy: str) -> InputError:
    return InputError(key=key, problem=problem, remedy=remedy)
