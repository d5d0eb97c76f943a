"""Check of the columns of a map against its rig, before the files are read."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path

from jbf.errors import InputError
from jbf.importing.mapping import Map
from jbf.records.drive_columns import DriveColumns
from jbf.records.rig import Rig


def check_rig_columns(rig: Rig, mapping: Map) -> None:
    """Raise an InputError if runs with the columns of a map do not match the rig."""
    file = mapping.path or Path("the columns")
    keys = ["time_s", *mapping.columns]
    if rig.drive is not None:
        columns = DriveColumns.of(rig.drive)
        try:
            columns.refuse_foreign_columns(file, 0, keys)
        except InputError as error:
            key = f"columns.{error.column}"
            raise InputError(
                file=file, key=key, problem=error.problem, remedy=error.remedy
            ) from None
        required = columns.required(keys, True)
    else:
        motion = [k for k in ("velocity_m_s", "position_m", "angle_rad") if k in keys]
        required = ["friction_n", motion[0] if motion else "velocity_m_s"]
    missing = [key for key in required if key not in keys]
    if missing:
        remedy = "add it under [columns], or correct the rig's section"
        derived = [f'{k} = "{e}"' for k, (_, e) in at_journal(rig, mapping.columns).items()]
        raise InputError(
            file=file,
            key=f"columns.{missing[0]}",
            problem="is missing, but the rig requires it",
            remedy=f"write {' and '.join(derived)}" if derived else remedy,
        )


_ROTARY = {
    "friction_n": ("torque_n_m", "motor_torque_n_m"),
    "velocity_m_s": ("speed_rpm", "velocity_rad_s", "motor_speed_rpm", "motor_velocity_rad_s"),
}
"""Columns of a shaft from which a column at the surface of the journal is derived."""


def at_journal(rig: Rig, columns: Mapping[str, str]) -> dict[str, tuple[str, str]]:
    """Columns at the surface of a journal that a bearing requires, from those of the shaft.

    Parameters
    ----------
    rig
        The rig; without a bearing, the result is empty.
    columns
        Expressions over the columns of the file, by column of a run.

    Returns
    -------
    dict
        For each missing column of a run the column of the shaft, and the expression.
    """
    if rig.bearing is None:
        return {}
    radius = f"{1e3 * rig.bearing.radius_m:.6g} [mm]"
    count = rig.bearing.count
    operations = {
        "friction_n": f" / {radius}" + (f" / {count}" if count > 1 else ""),
        "velocity_m_s": f" * {radius}",
    }
    present = set(columns)
    if present & {"position_m", "angle_rad"}:
        present.add("velocity_m_s")
    derived = {}
    for key, sources in _ROTARY.items():
        source = next((name for name in sources if name in columns), None)
        if key not in present and source is not None:
            expression = columns[source].strip()
            if re.search(r"[-+]", re.sub(r"`[^`]*`", "", expression)):
                expression = f"({expression})"
            derived[key] = source, f"{expression}{operations[key]}"
    return derived
