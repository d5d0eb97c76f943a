"""Rig (bearing, lubricant and load, or a drive) as a TOML file and as frozen dataclasses."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import MISSING, asdict, dataclass, fields
from typing import Any, TypeVar

import tomlkit

from jbf import _core
from jbf.errors import InputError, quoted
from jbf.records.drive import Drive
from jbf.records.quantities import BEARING, LINEAR, Quantities
from jbf.records.toml_file import (
    PathLike,
    number,
    positive,
    read_toml,
    refuse_unknown,
    require,
    table,
)
from jbf.records.usual_sizes import warn_of_unusual_sizes
from jbf.text_files import write_text
from jbf.units.quantity import quantities

MOST_BEARINGS = 1000
COLDEST_C, WARMEST_C = -100.0, 1000.0
"""Range of temperatures of a lubricant, degrees Celsius."""

_Section = TypeVar("_Section", "Bearing", "Lubricant", "Load")


def _make_positive(section: object, *names: str) -> None:
    for name in names:
        object.__setattr__(section, name, positive(getattr(section, name), name))


@dataclass(frozen=True)
class Bearing:
    """Geometry of one journal bearing and of the shaft that turns in it.

    Attributes
    ----------
    radius_m, length_m, clearance_m : float
        Journal radius, length and radial clearance, m; the clearance is less than the radius.
    mass_kg : float
        Rotating mass, kg.
    count : int
        Number of bearings on the shaft, at least 1.

    Raises
    ------
    InputError
        A dimension is not above zero, or the clearance is not less than the radius.

    Examples
    --------
    >>> jbf.Bearing(radius_m=0.02, length_m=0.03, clearance_m=5e-5, mass_kg=2.0, count=2).count
    2
    """

    radius_m: float
    length_m: float
    clearance_m: float
    mass_kg: float
    count: int

    def __post_init__(self) -> None:
        _make_positive(self, "radius_m", "length_m", "clearance_m", "mass_kg")
        if self.clearance_m >= self.radius_m:
            raise InputError(
                key="clearance_m",
                problem=f"{self.clearance_m} m is not below the radius of {self.radius_m} m",
                remedy="give both in metres",
            )
        if isinstance(self.count, bool) or not isinstance(self.count, int) or self.count < 1:
            raise InputError(
                key="count",
                problem=f"{self.count!r} is not an integer of at least 1",
                remedy="write the number of bearings on the shaft, such as 4",
            )
        if self.count > MOST_BEARINGS:
            raise InputError(
                key="count",
                problem=f"{self.count} bearings exceed the limit",
                remedy=f"write at most {MOST_BEARINGS}",
            )


@dataclass(frozen=True)
class Lubricant:
    """Viscosity of the lubricant.

    Attributes
    ----------
    viscosity_pa_s : float
        Dynamic viscosity, Pa s.
    temperature_c : float, optional
        Temperature to which the viscosity refers, degrees Celsius. In a model with
        `vogel_viscosity`, the parameters of the law refer to this temperature.

    Raises
    ------
    InputError
        The viscosity is not above zero, or the temperature is out of range.

    Examples
    --------
    >>> jbf.Lubricant(viscosity_pa_s=0.02, temperature_c=40.0)
    Lubricant(viscosity_pa_s=0.02, temperature_c=40.0)
    """

    viscosity_pa_s: float
    temperature_c: float | None = None

    def __post_init__(self) -> None:
        _make_positive(self, "viscosity_pa_s")
        if self.temperature_c is None:
            return
        celsius = number(self.temperature_c, "temperature_c")
        if not (COLDEST_C <= celsius <= WARMEST_C):
            raise InputError(
                key="temperature_c",
                problem=f"{celsius} is outside {COLDEST_C:g} to {WARMEST_C:g}",
                remedy="give it in degrees Celsius",
            )
        object.__setattr__(self, "temperature_c", celsius)


@dataclass(frozen=True)
class Load:
    """Normal load on a bearing.

    Attributes
    ----------
    normal_n
        Normal load on one bearing, N.

    Raises
    ------
    InputError
        The load is not above zero.

    Examples
    --------
    >>> jbf.Load(100.0)
    Load(normal_n=100.0)
    """

    normal_n: float

    def __post_init__(self) -> None:
        _make_positive(self, "normal_n")


def _section(
    kind: type[_Section], mapping: Mapping[str, Any], name: str, prefix: str
) -> _Section | None:
    if name not in mapping:
        return None
    content = table(mapping[name], prefix + name)
    keys = [f.name for f in fields(kind)]
    refuse_unknown(content, keys, f"{prefix}{name}.")
    content = quantities(content, f"{prefix}{name}.")
    needed = [f.name for f in fields(kind) if f.default is MISSING]
    require(content, needed, f"{prefix}{name}")
    try:
        return kind(**content)
    except InputError as error:
        raise error.within(key_prefix=f"{prefix}{name}.") from None


@dataclass(frozen=True)
class Rig:
    """The machine that a run was measured on; sections that a law does not need are None.

    A `drive` defines the quantities of the recording and of the results for a machine without
    journal bearings.

    Attributes
    ----------
    bearing : Bearing, optional
        Journal bearings; required for laws with a lubricant film.
    lubricant : Lubricant, optional
        Viscosity of the lubricant; required for laws with a film.
    load : Load, optional
        Load on one bearing; required for laws whose coefficients are relative to the load.
    drive : Drive, optional
        Rotary or linear drive whose columns the runs have.

    Warns
    -----
    UserWarning
        A dimension, the pitch or the viscosity is far outside the usual range of machines, as in a
        wrong unit (`pitch_m=10`).

    Examples
    --------
    >>> rig = jbf.Rig(load=jbf.Load(50.0))
    >>> rig.bearing is None
    True
    >>> jbf.Rig.thesis().bearing.count
    4
    """

    bearing: Bearing | None = None
    lubricant: Lubricant | None = None
    load: Load | None = None
    drive: Drive | None = None

    def __post_init__(self) -> None:
        sections = {"bearing": Bearing, "lubricant": Lubricant, "load": Load, "drive": Drive}
        for name, kind in sections.items():
            value = getattr(self, name)
            if value is not None and not isinstance(value, kind):
                raise InputError(
                    key=name,
                    problem=f"the {name} is not a jbf.{kind.__name__} but a {type(value).__name__}",
                    remedy=f"give jbf.{kind.__name__}(...), or read a file: jbf.read_rig(PATH)",
                )
        if self.bearing is not None and self.drive is not None:
            raise InputError(
                key="drive",
                problem="cannot be combined with [bearing]: both define the friction",
                remedy="keep one: [bearing] for journal bearings, [drive] for any other machine",
            )
        warn_of_unusual_sizes(self.to_mapping())

    @property
    def quantities(self) -> Quantities:
        """Units and names of the rig's friction and motion quantities."""
        if self.drive is not None:
            return self.drive.quantities
        return LINEAR if self.bearing is None else BEARING

    @property
    def radius_m(self) -> float | None:
        """Displacement per radian of the recorded angle; None if an angle is not a displacement.

        This is the radius of the journal, m, or 1 for a rotary drive, whose displacement is its
        angle.
        """
        if self.bearing is not None:
            return self.bearing.radius_m
        return 1.0 if self.quantities.motion == "rotary" else None

    @classmethod
    def from_mapping(
        cls, mapping: Mapping[str, Any], *, file: PathLike | None = None, prefix: str = ""
    ) -> Rig:
        """Build a rig from the nested mapping of its TOML file.

        A quantity is a number in the unit that its key ends in, or text with an explicit unit, such
        as "10 mm".

        Parameters
        ----------
        file : path, optional
            File to name in an error.
        prefix : str
            Prefix of each key in an error, such as ``"rig."`` inside a model file.

        Raises
        ------
        InputError
            A key is unknown, missing, of the wrong type or out of range.
        """
        try:
            refuse_unknown(mapping, [f.name for f in fields(cls)], prefix)
            return cls(
                _section(Bearing, mapping, "bearing", prefix),
                _section(Lubricant, mapping, "lubricant", prefix),
                _section(Load, mapping, "load", prefix),
                Drive.from_mapping(mapping["drive"], f"{prefix}drive")
                if "drive" in mapping
                else None,
            )
        except InputError as error:
            raise error.within(file=file) from None

    @classmethod
    def thesis(cls, table: str = "4.2") -> Rig:
        """The test rig of Cohn (1998), with the load of a table of this thesis: "4.2" to "4.5"."""
        loads_n = {"4.2": 104.0, "4.3": 83.5, "4.4": 104.0, "4.5": 83.5}
        if table not in loads_n:
            raise InputError(
                problem=f"{quoted(table)} is not a parameter table of the thesis",
                remedy=f"choose from {', '.join(loads_n)}",
            )
        sizes = _core.thesis_bearing()
        lubricant = Lubricant(viscosity_pa_s=sizes.pop("viscosity_pa_s"))
        return cls(Bearing(**sizes), lubricant, Load(normal_n=loads_n[table]))

    def to_mapping(self) -> dict[str, dict[str, Any]]:
        """Return the nested mapping of plain values, without sections and keys that are None."""
        return {
            name: {key: value for key, value in section.items() if value is not None}
            for name, section in asdict(self).items()
            if section is not None
        }

    def write(self, path: PathLike) -> None:
        """Write the rig as TOML, atomically; reading the file gives an equal rig.

        Raises
        ------
        InputError
            The file cannot be written.
        """
        write_text(path, tomlkit.dumps(self.to_mapping()))


def read_rig(path: PathLike) -> Rig:
    r"""Read a rig from TOML.

    Parameters
    ----------
    path : path
        The file `rig.toml`.

    Returns
    -------
    Rig
        Bearing, lubricant, load and drive, as far as the file has their sections.

    Raises
    ------
    InputError
        The file is not TOML, or a key is unknown, missing, of the wrong type or out of range.

    Examples
    --------
    >>> from pathlib import Path
    >>> _ = Path("rig.toml").write_text("[load]\nnormal_n = 50.0\n")
    >>> jbf.read_rig("rig.toml").load
    Load(normal_n=50.0)
    """
    return Rig.from_mapping(read_toml(path), file=path)
