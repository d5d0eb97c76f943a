"""Path and speed that differ by a factor: a wrong unit, or a reversed sign."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from jbf.arrays import Array
from jbf.records.findings.finding import Finding
from jbf.records.motion.position import Position
from jbf.records.motion.ratio import MIN_DEVIATION, factor_between, slope_near
from jbf.records.quantities import BEARING, Quantities

FACTOR_TOLERANCE = 0.06
"""Relative tolerance within which a ratio matches the factor of a unit."""


@dataclass(frozen=True)
class Mismatch:
    """Finding that path and speed differ by a factor, with the correction.

    Attributes
    ----------
    finding
        The finding; its channel is the column that is assumed to be wrong.
    factor
        Divisor of the changes of the path, or multiplier of the speed.
    """

    finding: Finding
    factor: float

    @property
    def of_speed(self) -> bool:
        """Whether the unit of the speed, not that of the path, is wrong."""
        return self.finding.channel == "velocity_m_s"


def wrong_unit(
    name: str,
    time: Array,
    position: Position,
    speed: Array,
    quantities: Quantities = BEARING,
) -> Mismatch | None:
    """Detect a wrong unit or sign of path or speed, by their ratio; None if they agree.

    The speed is assumed to be wrong if the factor corresponds to one of its units, otherwise the
    path. The factor is determined from the shape of both signals.
    """
    called = quantities.speed_column
    ratio = factor_between(time, position.path_m, speed)
    if ratio is None:
        return None
    if abs(ratio + 1.0) < MIN_DEVIATION:
        words = f"{position.column} decreases where {called} is positive: one has the wrong sign"
        done = f"{position.column} is negated"
        return Mismatch(
            Finding("sign", position.column, name, ratio, "1", done, words + " turned"), -1
        )
    column, unit, by = position.column, "", slope_near(time, position.path_m, speed, ratio)
    for column_of_unit, guess, factor in _units(position, turns=quantities.motion == "rotary"):
        if abs(abs(ratio) / factor - 1.0) < FACTOR_TOLERANCE:
            noun = called if column_of_unit == "velocity_m_s" else column_of_unit
            column, unit, by = (
                column_of_unit,
                f"; {noun} in {guess}?",
                float(np.copysign(factor, ratio)),
            )
            break
    turned = " and with opposite sign" if ratio < 0.0 else ""
    hint = unit or _hint(position, turns=quantities.motion == "rotary")
    words = f"{position.column} changes {abs(ratio):.4g} times as fast as {called}{turned}"
    done = f"divided by {by:.4g}, to agree with the speed"
    if column == "velocity_m_s":
        done = f"multiplied by {by:.4g}, to agree with the position"
    return Mismatch(Finding("units", column, name, ratio, "1", done, words + hint), by)


def _hint(position: Position, *, turns: bool) -> str:
    """Return what to check if no unit explains the ratio of path and speed."""
    if turns:
        return "; check gear_ratio"
    return "; check the radius of the journal" if position.arm_m != 1.0 else ""


def _units(position: Position, *, turns: bool) -> Iterator[tuple[str, str, float]]:
    """Yield a column, a possible unit of it, and the resulting factor between path and speed."""
    turn = 2.0 * np.pi
    arm = position.arm_m
    if position.column == "angle_rad":
        yield "angle_rad", "degrees", 360.0 / turn
        yield "angle_rad", "turns", 1.0 / turn
        if not turns:
            yield "velocity_m_s", "rad/s", arm
        yield "velocity_m_s", "degrees per second", arm * turn / 360.0
        yield "velocity_m_s", "revolutions per minute", arm * turn / 60.0
        yield "velocity_m_s", "revolutions per second", arm * turn
    else:
        yield "position_m", "mm", 1e3
        yield "position_m", "cm", 1e2
        yield "position_m", "um", 1e6
    if turns:
        return
    yield "velocity_m_s", "mm/s", 1e-3
    yield "velocity_m_s", "cm/s", 1e-2
    yield "velocity_m_s", "um/s", 1e-6
    yield "velocity_m_s", "m/min", 1.0 / 60.0
