"""Validation of the recorded path and speed before the motion is estimated from them."""

from __future__ import annotations

from dataclasses import dataclass, replace

from jbf.arrays import Array, Mask
from jbf.errors import InputError
from jbf.records.findings.finding import Finding
from jbf.records.motion.derived_speed import centred_speed, derived_speed
from jbf.records.motion.glitches import (
    mend_path_ends,
    mend_position,
    mend_speed,
    mend_speed_ends,
)
from jbf.records.motion.jitter import jittered_path, uneven_stamps
from jbf.records.motion.position import recorded_position
from jbf.records.motion.roughness import quantum_of, step_of
from jbf.records.motion.speed_delay import filtered_speed
from jbf.records.motion.speed_zero import speed_zero
from jbf.records.motion.stale_positions import replace_stale_positions
from jbf.records.motion.units import wrong_unit
from jbf.records.run import Run

NOT_AS_RECORDED = (
    "units",
    "sign",
    "speed_zero",
    "late_speed",
    "coarse_speed",
    "filtered_speed",
    "no_speed",
)
"""Kinds of findings of a motion whose column is discarded or converted as a whole."""


@dataclass(frozen=True, eq=False)
class CorrectedRecords:
    """Position and speed records of a motion, after correction of inconsistent parts.

    Attributes
    ----------
    path
        The path, m; None if only the speed was recorded.
    step
        The encoder step, m.
    speed
        The speed, m/s.
    speed_measured
        False if the speed is only a difference of the path, without further information.
    findings
        The findings, with the actions taken.
    arm_m
        Metres of path per unit of the position column.
    loose
        True at the ends where the motion is unknown, shape (n,).
    hum
        Largest recorded speed, m/s, that is also treated as rest: one count of a speed with an
        offset.
    """

    path: Array | None
    step: float
    speed: Array
    speed_measured: bool
    findings: tuple[Finding, ...]
    loose: Mask
    arm_m: float = 1.0
    hum: float = 0.0


def corrected_records(
    run: Run, radius_m: float | None, stamps_s: Array | None = None
) -> CorrectedRecords:
    """Examine and correct the position and speed records of a run.

    Outliers are corrected first, because they hide other defects. The validity of a channel as a
    whole is then checked before its single samples.

    Parameters
    ----------
    radius_m
        Journal radius, m; None if unknown.
    stamps_s
        The recorded time stamps, s, if the instants of the run are those of an even clock.
    """
    name, time, speed = run.name, run.time_s, run.velocity
    corrected = stamps_s is not None
    stamps_s = time if stamps_s is None else stamps_s
    quantities = run.quantities
    stamps = uneven_stamps(name, stamps_s, corrected=corrected)
    position = recorded_position(run, radius_m)
    if position is None:
        if not run.speed_recorded:
            raise InputError(
                file=run.path or name,
                column="velocity_m_s",
                problem="is missing; an angle determines no speed without the journal's radius",
                remedy="add the column, or give the rig its [bearing]",
            )
        speed, speed_outliers = mend_speed(name, time, speed, None, quantities.speed)
        speed, end_mask, ends = mend_speed_ends(name, time, speed, None, quantities.speed)
        return CorrectedRecords(
            None, 0.0, speed, True, _present(speed_outliers, *ends, stamps), end_mask
        )
    step = quantum_of(position.path_m) or step_of(position.path_m)
    position, path_outliers = mend_position(name, time, position)
    position, end_mask, ends = mend_path_ends(name, time, position)
    if not run.speed_recorded:
        of_position = _present(path_outliers, *ends, stamps)
        without_speed = _without_speed(
            name, time, position.path_m, step, of_position, end_mask, quantities.speed
        )
        return replace(without_speed, arm_m=position.arm_m)
    zero = unit = None
    hum = 0.0
    # A difference of the positions has no separate unit or zero that could be wrong.
    not_measured = derived_speed(name, stamps_s, position.path_m, speed)
    if not_measured is None:
        speed, hum, zero = speed_zero(name, time, position.path_m, speed, step, quantities.speed)
        unit = wrong_unit(name, time, position, speed, quantities)
        if unit is not None and unit.of_speed:
            speed, hum = speed * unit.factor, hum * abs(unit.factor)
        elif unit is not None:
            position = position.along(position.path_m / unit.factor)
            step = step / abs(unit.factor)
        not_measured = derived_speed(name, stamps_s, position.path_m, speed) or filtered_speed(
            name, time, position.path_m, speed
        )
    path = position.path_m
    speed_outliers = stale = None
    measured = not_measured is None
    if measured:
        speed, speed_outliers = mend_speed(name, time, speed, path, quantities.speed)
        speed, speed_end_mask, speed_ends = mend_speed_ends(
            name, time, speed, path, quantities.speed
        )
        end_mask, ends = end_mask | speed_end_mask, [*ends, *speed_ends]
        position, stale = replace_stale_positions(name, time, position, speed, quantities.mover)
        path = position.path_m
    else:
        speed = centred_speed(time, path)
    jitter = stamps or jittered_path(name, time, path, speed)
    scale = None if unit is None else unit.finding
    findings = _present(
        path_outliers, *ends, zero, scale, not_measured, speed_outliers, stale, jitter
    )
    return CorrectedRecords(path, step, speed, measured, findings, end_mask, position.arm_m, hum)


def _without_speed(
    name: str,
    time: Array,
    path: Array,
    step: float,
    findings: tuple[Finding, ...],
    end_mask: Mask,
    unit: str,
) -> CorrectedRecords:
    """Records of a motion without a recorded speed, with the speed derived from the path."""
    speed = centred_speed(time, path)
    words = "no speed was recorded"
    derived = Finding(
        "no_speed", "velocity_m_s", name, 0.0, unit, "derived from the position", words
    )
    jitter = () if findings else _present(jittered_path(name, time, path, speed))
    return CorrectedRecords(path, step, speed, False, (derived, *findings, *jitter), end_mask)


def _present(*findings: Finding | None) -> tuple[Finding, ...]:
    """The findings that are not None."""
    return tuple(finding for finding in findings if finding is not None)
