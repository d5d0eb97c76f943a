"""Check of the columns of a map against its rig, before the files are read."""

from __future__ import annotations

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
    for key in required:
        if key not in keys:
            raise InputError(
                file=file,
                key=f"columns.{key}",
                problem="is missing, but the rig requires it",
                remedy="add it under [columns], or correct the rig's section",
            )
