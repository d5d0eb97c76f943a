"""Options for the operating limits of a rig: speed, acceleration, travel, load, temperature."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from jbf.cli.arguments import Group
from jbf.records.quantities import BEARING, Quantities
from jbf.units.quantity import number_in

if TYPE_CHECKING:
    from jbf.diagnosis import Limits

SPEED, SHARPNESS, LOADS = "--max-velocity", "--max-acceleration", "--loads"
TRAVEL = "--travel"


def add(group: Group, *, otherwise: str, sharpest: str, longest: str, needed: bool = False) -> None:
    """Add the options for the operating limits of a rig to a group of arguments.

    Parameters
    ----------
    otherwise, sharpest, longest
        Help texts that state the default of loads and temperatures (`otherwise`), of the
        acceleration (`sharpest`) and of the travel (`longest`).
    needed
        Whether the option for the maximum speed is required.
    """
    default = "" if needed else f" (default: {otherwise})"
    group.add_argument(
        SPEED,
        metavar="X",
        required=needed,
        help=f"largest speed, in the unit of the rig or as '12 deg/s'{default}",
    )
    group.add_argument(
        SHARPNESS,
        metavar="X",
        help=f"largest acceleration, likewise or as '5 rad/s^2' (default: {sharpest})",
    )
    group.add_argument(
        TRAVEL,
        metavar="X",
        help="length of the free travel, in which a motion starts at the lower end, in the unit of "
        f"the rig or as '300 mm' (default: {longest})",
    )
    group.add_argument(
        LOADS,
        metavar=("LOW", "HIGH"),
        nargs=2,
        help=f"smallest and largest load, in N or as '2 kN' (default: {otherwise})",
    )
    group.add_argument(
        "--temperatures-c",
        metavar=("LOW", "HIGH"),
        nargs=2,
        type=float,
        help=f"lowest and highest temperature of a recording, deg C (default: {otherwise})",
    )


@dataclass(frozen=True)
class LimitOptions:
    """Options for the operating limits of a rig, as text with or without units.

    None stands for the default.
    """

    max_velocity: str | None
    max_acceleration: str | None
    travel: str | None
    loads: tuple[str, str] | None
    temperatures_c: tuple[float, float] | None

    def limits(self, duration_s: float, quantities: Quantities = BEARING) -> Limits:
        """Convert the options to limits in the units of a rig, for runs of a duration in s.

        Raises
        ------
        InputError
            A value is not a number in the unit of the rig, or a limit is not positive.
        """
        from jbf.diagnosis import Limits

        def given(option: str, text: str | None, unit: str) -> float | None:
            """Convert the text of an option to a number in a unit; None if it was not given."""
            return None if text is None else number_in(unit, text, option)

        low, high = (number_in("N", load, LOADS) for load in self.loads or ("0", "0"))
        return Limits(
            velocity=given(SPEED, self.max_velocity, quantities.speed),
            acceleration=given(SHARPNESS, self.max_acceleration, f"{quantities.length}/s^2"),
            duration_s=duration_s,
            load_n=None if self.loads is None else (low, high),
            temperature_c=self.temperatures_c,
            travel=given(TRAVEL, self.travel, quantities.length),
        )
