"""Quantities with units in TOML files and command-line options."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

import numpy as np

from jbf.errors import InputError
from jbf.units.unit import parse_unit, unit_of_name

_DIGITS = r"\s*(?P<number>[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?)\s*"
_NUMBER = re.compile(_DIGITS, re.ASCII)
_QUANTITY = re.compile(_DIGITS + r"(?P<unit>(?![\d.])\S.*?)\s*")
_LONGEST = 60


def quantities(section: Mapping[str, Any], prefix: str) -> dict[str, Any]:
    """Convert the quantities in a section of a rig to numbers in the units of their keys.

    Parameters
    ----------
    section
        Keys and values: `pitch_m = "10 mm"` becomes `pitch_m = 0.01`, and so does `"0.01"`. Values
        that are not text of a number, and those of keys that do not end in a unit, are unchanged.
    prefix
        Text before the key in an error, such as ``"drive."``.

    Raises
    ------
    InputError
        The unit is unknown, or its dimensions differ from those of the unit of the key.
    """
    return {key: _converted(key, value, prefix) for key, value in section.items()}


def _converted(key: str, value: object, prefix: str) -> object:
    """Value of one key in the unit of the key; unchanged if it is not a quantity."""
    named = unit_of_name(key)
    if named is None or not isinstance(value, str) or len(value) > _LONGEST:
        return value
    if _NUMBER.fullmatch(value):
        return float(value)
    match = _QUANTITY.fullmatch(value)
    if match is None:
        return value
    target, unit = named[1], parse_unit(match["unit"])
    # Dimensions must be equal, angles included: "10 mm/rev" would become a lead of 1.6 mm.
    if unit is None or unit.dimensions != target.dimensions:
        raise InputError(
            key=f"{prefix}{key}",
            problem=f"{value!r} is not a quantity in {target.text}",
            remedy=f"write a number in {target.text}, or a number with its unit",
        )
    return float(unit.converted(np.array([float(match["number"])]), target)[0])


def number_in(unit: str, text: str, option: str) -> float:
    """Convert the text of an option, with or without a unit, to a number in a given unit.

    Parameters
    ----------
    unit
        Unit of the result, and of a number without a unit.
    text
        Value of the option, such as ``"0.2"`` or ``"12 deg/s"``.
    option
        Name of the option in an error.

    Raises
    ------
    InputError
        The text is not a number, or its unit is unknown or has different dimensions.
    """
    try:
        return float(text)
    except ValueError:
        match = _QUANTITY.fullmatch(text) if len(text) <= _LONGEST else None
    try:
        if match is None:
            raise ValueError
        return _in_unit(float(match["number"]), match["unit"], unit)
    except ValueError:
        raise InputError(
            file=option,
            problem=f"{text!r} is not a quantity in {unit}",
            remedy=f"write a number in {unit}, or a number with its unit",
        ) from None


def _in_unit(number: float, unit: str, target: str) -> float:
    """Convert a number from one unit to another."""
    if unit == target:
        return number
    given, to = parse_unit(unit), parse_unit(target)
    if given is None or to is None or given.dimensions != to.dimensions:
        raise ValueError
    return float(given.converted(np.array([number]), to)[0])
