"""Operating limits of a rig, as options."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from jbf.records.quantities import OF_BEARING, Quantities
from jbf.units.quantity import number_in

if TYPE_CHECKING:
    from jbf.diagnosis import Limits

SPEED, SHARPNESS, LOADS = "--max-velocity", "--max-acceleration", "--loads"


def add(
    group: argparse._ArgumentGroup | argparse.ArgumentParser,
    *,
    otherwise: str,
    sharpest: str,
    needed: bool = False,
) -> None:
    """Add the options.

    Parameters
    ----------
    otherwise, sharpest
        Help text for the defaults: of loads and temperatures, and of the acceleration.
    needed
        Whether the maximum speed is required.
    """
    usual = "" if needed else f"; {otherwise}"
    group.add_argument(
        SPEED,
        metavar="X",
        required=needed,
        help=f"maximum speed of the rig, in its unit or as '0.2 rad/s'{usual}",
    )
    group.add_argument(
        SHARPNESS,
        metavar="X",
        help=f"maximum acceleration of the rig, in its unit or as '5 rad/s^2'; {sharpest}",
    )
    group.add_argument(
        LOADS,
        metavar=("LOW", "HIGH"),
        nargs=2,
        help=f"lowest and highest load, in N or as '2 kN'; {otherwise}",
    )
    group.add_argument(
        "--temperatures-c",
        metavar=("LOW", "HIGH"),
        nargs=2,
        type=float,
        help=f"lowest and highest temperature, in degrees Celsius; {otherwise}",
    )


def limits(
    arguments: argparse.Namespace, duration_s: float, quantities: Quantities = OF_BEARING
) -> Limits:
    """Return the limits given by the options, for runs of the given duration in seconds.

    Raises
    ------
    InputError
        A value is not a number in the unit of the rig, or a limit is not positive.
    """
    from jbf.diagnosis import Limits

    speed, acceleration, loads = arguments.max_velocity, arguments.max_acceleration, arguments.loads
    celsius = arguments.temperatures_c
    unit = quantities.speed

    def in_newtons(load: str) -> float:
        return number_in("N", load, LOADS)

    return Limits(
        velocity=None if speed is None else number_in(unit, speed, SPEED),
        acceleration=(
            None
            if acceleration is None
            else number_in(f"{unit.removesuffix('/s')}/s^2", acceleration, SHARPNESS)
        ),
        duration_s=duration_s,
        load_n=None if loads is None else (in_newtons(loads[0]), in_newtons(loads[1])),
        temperature_c=None if celsius is None else tuple(celsius),
    )
