"""Angle of a link that several joints move; the torque of its weight depends on this angle."""

from __future__ import annotations

from collections.abc import Sequence

from jbf.arrays import Array
from jbf.errors import InputError
from jbf.records.angles import continuous
from jbf.records.rig import Rig
from jbf.records.run import Run

WEIGHT_ANGLE = "weight_angle_rad"


def weight_offset(rig: Rig, run: Run, angle_rad: Array) -> Array | None:
    """Recorded angle of the link minus the angle of the joint, rad, shape (N,).

    None without the column `weight_angle_rad`: the torque of the weight then depends on the angle
    of the joint. The column is used for rotary drives only.
    """
    if rig.quantities.motion != "rotary" or WEIGHT_ANGLE not in run.extra:
        return None
    offset: Array = continuous(run.extra[WEIGHT_ANGLE]) - angle_rad
    return offset


def check_weight_angles(rig: Rig, runs: Sequence[Run]) -> None:
    """Raise an InputError if some runs of a rotary drive have the angle of the link and some not.

    In one model, the torque of the weight depends on one angle.
    """
    if rig.quantities.motion != "rotary":
        return
    having = [run for run in runs if WEIGHT_ANGLE in run.extra]
    missing = [run for run in runs if WEIGHT_ANGLE not in run.extra]
    if having and missing:
        raise InputError(
            file=missing[0].path or missing[0].name,
            column=WEIGHT_ANGLE,
            problem=f"is missing, but {having[0].name} has it",
            remedy="record it in every run, or in none",
        )


def weight_acts_over(run: Run) -> str:
    """Name of the column with the angle on which the torque of the weight depends."""
    return WEIGHT_ANGLE if WEIGHT_ANGLE in run.extra else "angle_rad"


def require_weight_angle(run: Run, fitted: str) -> None:
    """Raise an InputError if the weight of a run acts over another angle than in the fit.

    Parameters
    ----------
    fitted
        `weight_acts_over` of the fitted runs.
    """
    if weight_acts_over(run) != fitted:
        state = "missing" if fitted == WEIGHT_ANGLE else "present"
        raise InputError(
            file=run.path or run.name,
            column=WEIGHT_ANGLE,
            problem=f"is {state}, unlike in the runs to which the weight was fitted",
            remedy="predict runs with the same angles as those of the fit",
        )
