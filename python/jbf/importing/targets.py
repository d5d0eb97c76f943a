"""Columns of a run that an import can create, and their units."""

from __future__ import annotations

from jbf.errors import InputError, closest, did_you_mean, quoted
from jbf.records.checks import COLUMNS
from jbf.records.csv_file import DRIVE_COLUMNS
from jbf.units.unit import Unit, unit_of_name

KNOWN = (*COLUMNS, *DRIVE_COLUMNS, "pressure_pa")
"""Columns of a run that have a defined meaning."""
FRICTION = (
    "friction_n", "torque_n_m", "motor_torque_n_m", "current_a", "torque_percent", "force_percent",
    "voltage_v",
)  # fmt: skip
LINEAR = ("position_m", "velocity_m_s")
ROTARY = (
    "angle_rad", "velocity_rad_s", "speed_rpm",
    "motor_angle_rad", "motor_velocity_rad_s", "motor_speed_rpm",
)  # fmt: skip
MOTION = (*LINEAR, *ROTARY)
_MIN_SIMILARITY = 0.8
_STEMS = {found[0]: key for key in reversed(KNOWN) if (found := unit_of_name(key)) is not None}


def wanted_unit(key: str) -> Unit:
    """Unit of a column of a run, from the suffix of its name.

    Raises
    ------
    InputError
        If the name resembles a known name, or does not end in a unit.
    """
    if key not in KNOWN:
        suggestion = closest(
            key, [k for k in KNOWN if k.count("_") == key.count("_")], _MIN_SIMILARITY
        )
        stem_and_unit = unit_of_name(key)
        if suggestion is None and stem_and_unit is not None:
            # A known quantity must have its standard name: the name must not state another unit.
            suggestion = _STEMS.get(stem_and_unit[0])
        if suggestion is not None:
            raise InputError(
                key=f"columns.{key}",
                problem="is not known",
                remedy=f"did you mean {quoted(suggestion)}?",
            )
    stem_and_unit = unit_of_name(key)
    if stem_and_unit is None:
        raise InputError(
            key=f"columns.{key}",
            problem="is not known, and its name ends in no unit",
            remedy=(
                f"{did_you_mean(key, KNOWN)}; name your own columns with a unit, such "
                "as setpoint_rpm"
            ),
        )
    return stem_and_unit[1]
