"""Operating limits of a rig, as options."""

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
    """Add the options that set the operating limits.

    Parameters
    ----------
    otherwise, sharpest, longest
        Help text for the defaults: of loads and temperatures, of the acceleration, and of the
        travel.
    needed
        Whether the maximum speed is required.
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
    """Operating limits of a rig, with or without units; None for the default."""

    max_velocity: str | None
    max_acceleration: str | None
    travel: str | None
    loads: tuple[str, str] | None
    temperatures_c: tuple[float, float] | None

    def limits(self, duration_s: float, quantities: Quantities = BEARING) -> Limits:
        """Return the limits in the units of a rig, for runs of the given duration in seconds.

        Raises
        ------
        InputError
            A value is not a number in the unit of the rig, or a limit is not positive.
        """
        from jbf.diagnosis import Limits

        def given(option: str, text: str | None, unit: str) -> float | None:
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
