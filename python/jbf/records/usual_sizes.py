"""Plausible sizes of machine parts: a value far outside is probably in another unit."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from typing import Any

from jbf.units.unit import parse_unit, unit_of_name

USUAL: dict[str, tuple[float, float]] = {
    "radius_m": (1e-4, 2.0),
    "length_m": (1e-4, 2.0),
    "clearance_m": (1e-7, 5e-3),
    "pitch_m": (1e-5, 0.9),
    "viscosity_pa_s": (1e-6, 20.0),
}
"""Smallest and largest usual value of a key of a rig, in the unit of the key.

The limits are those of large machines. They exclude usual values that were written in mm or mPa s
(a pitch of 1 mm, a clearance of 0.05 mm), and no journal bearing or screw in use. Only the pulley
or drum of a hoist may have a larger pitch.
"""
_OTHER_UNITS = ("mm", "um", "mPa s")
"""Units in which data sheets commonly state dimensions and viscosities."""


def warn_of_unusual_sizes(sections: Mapping[str, Mapping[str, Any]]) -> None:
    """Warn of each value of a rig that is outside its usual range, and suggest its unit.

    Parameters
    ----------
    sections
        Keys and values in SI units, by section of the rig.
    """
    for section, content in sections.items():
        for key in USUAL.keys() & content.keys():
            value, (least, most) = content[key], USUAL[key]
            if not least <= value <= most:
                warnings.warn(_message(f"{section}.{key}", value, least, most), stacklevel=4)


def _message(place: str, value: float, least: float, most: float) -> str:
    """Text of the warning for one value, with a suggestion of its unit."""
    named = unit_of_name(place)
    assert named is not None
    unit = named[1]
    others = [other for text in _OTHER_UNITS if (other := parse_unit(text)) and other.fits(unit)]
    likely = [other.text for other in others if least <= value * other.in_si / unit.in_si <= most]
    remedy = (
        f'for {value:g} {likely[0]} write "{value:g} {likely[0]}"' if likely else "check its unit"
    )
    usual = f"{least:g} to {most:g} {unit.text}"
    return f"{place}: {value:g} {unit.text} is outside the usual {usual}; {remedy}"
