"""Operating limits of a rig, as options."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from jbf.diagnosis import Limits

SPEED, SHARPNESS = "--max-velocity-m-s", "--max-acceleration-m-s2"


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
        type=float,
        required=needed,
        help=f"of the rig (of a rotary drive in rad/s){usual}",
    )
    group.add_argument(
        SHARPNESS,
        metavar="X",
        type=float,
        help=f"of the rig (of a rotary drive in rad/s^2); {sharpest}",
    )
    for option, what in (
        ("--loads-n", "loads that the rig can be put under"),
        ("--temperatures-c", "temperatures that it can be recorded at"),
    ):
        group.add_argument(
            option,
            metavar=("LOW", "HIGH"),
            nargs=2,
            type=float,
            help=f"{what}; {otherwise}",
        )


def limits(arguments: argparse.Namespace, duration_s: float) -> Limits:
    """Return the limits given by the options, for runs of the given duration in seconds."""
    from jbf.diagnosis import Limits

    loads_n, celsius = arguments.loads_n, arguments.temperatures_c
    return Limits(
        velocity_m_s=arguments.max_velocity_m_s,
        acceleration_m_s2=arguments.max_acceleration_m_s2,
        duration_s=duration_s,
        load_n=None if loads_n is None else tuple(loads_n),
        temperature_c=None if celsius is None else tuple(celsius),
    )
