"""Requirements of effects on a record: columns, shaft angle, displacement of the drive."""

from __future__ import annotations

from collections.abc import Iterable

from jbf.errors import InputError
from jbf.models.catalogue import find_effect
from jbf.models.user_effects import COLUMNS_OF_EVERY_RUN
from jbf.records.rig import Rig
from jbf.records.run import Run
from jbf.records.run_requirements import require


def has_angle(rig: Rig, run: Run) -> bool:
    """Whether a run has a shaft angle; always False for a linear axis."""
    return run.angle_rad is not None and (rig.bearing is not None or run.position_m is None)


def has_path(rig: Rig, run: Run) -> bool:
    """Whether a run has the displacement of the drive, in the units of its speed."""
    return run.position_m is not None or (run.angle_rad is not None and rig.radius_m is not None)


def has_position(run: Run) -> bool:
    """Whether a run has the angle or the linear position of the drive."""
    return run.position_m is not None or run.angle_rad is not None


def require_record(rig: Rig, run: Run, effects: Iterable[str]) -> None:
    """Raise an InputError if a run lacks a column that one of the effects needs."""
    for name in effects:
        needs = find_effect(name).needs
        for column in find_effect(name).columns:
            if column not in COLUMNS_OF_EVERY_RUN:
                require(run, column, f"the effect {name}")
        if "angle" in needs and not has_angle(rig, run):
            require(run, "angle_rad", f"the effect {name}")
            raise InputError(
                file=run.path or run.name,
                column="position_m",
                problem=f"makes this a linear axis, but the effect {name} requires a shaft angle",
                remedy="remove position_m, or give the rig its [bearing]",
            )
        if "temperatures" in needs:
            require(run, "temperature_c", f"the effect {name}")
        if "position" in needs and not has_position(run):
            require(run, "angle_rad" if rig.radius_m else "position_m", f"the effect {name}")
        if "path" in needs and not has_path(rig, run):
            if rig.radius_m is not None:
                require(run, "angle_rad", f"the effect {name}")
            require(run, "position_m", f"without a bearing's radius the effect {name}")
