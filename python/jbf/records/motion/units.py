"""Path and speed that contradict one another by a factor: another unit, or a sign turned."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from jbf.records.findings.finding import Finding
from jbf.records.motion.position import Position
from jbf.records.motion.ratio import OFF, factor_between, slope_near
from jbf.records.quantities import OF_BEARING, Quantities

Array = npt.NDArray[np.float64]

NEAR = 0.06
"""A ratio is a unit's where it is so near to its factor."""


@dataclass(frozen=True)
class Mismatch:
    """A path and a speed that differ by a factor.

    Attributes
    ----------
    finding
        What to say; its channel is the column that is taken to be in the wrong.
    factor
        What the path's changes are to be divided by, or the speed multiplied with.
    """

    finding: Finding
    factor: float

    @property
    def of_speed(self) -> bool:
        """Whether it is the speed's unit that is wrong."""
        return self.finding.channel == "velocity_m_s"


def wrong_unit(
    name: str,
    time: Array,
    position: Position,
    speed: Array,
    quantities: Quantities = OF_BEARING,
) -> Mismatch | None:
    """Whether path and speed differ by a factor: the speed is in the wrong where the factor is one
    of its units, else the path. The shape of a motion is in both, whatever its scale."""
    called = quantities.speed_column
    ratio = factor_between(time, position.path_m, speed)
    if ratio is None:
        return None
    if abs(ratio + 1.0) < OFF:
        words = f"{position.column} falls where {called} says that it rises: one has its sign"
        done = f"{position.column} is turned to the speed's sign"
        return Mismatch(
            Finding("sign", position.column, name, ratio, "1", done, words + " turned"), -1
        )
    column, unit, by = position.column, "", slope_near(time, position.path_m, speed, ratio)
    for which, guess, factor in _units(position, turns=quantities.motion == "rotary"):
        if abs(abs(ratio) / factor - 1.0) < NEAR:
            said = called if which == "velocity_m_s" else which
            column, unit, by = which, f": is {said} in {guess}?", float(np.copysign(factor, ratio))
            break
    turned = ", and the other way" if ratio < 0.0 else ""
    hint = unit or (": is the radius of the journal right?" if position.arm_m != 1.0 else "")
    words = f"{position.column} changes {abs(ratio):.4g} times as fast as {called} says{turned}"
    done = f"divided by {by:.4g}, to agree with the speed"
    if column == "velocity_m_s":
        done = f"multiplied by {by:.4g}, to agree with the path"
    return Mismatch(Finding("units", column, name, ratio, "1", done, words + hint), by)


def _units(position: Position, *, turns: bool) -> Iterator[tuple[str, str, float]]:
    """Column, unit it might be in, and the factor that this makes."""
    turn = 2.0 * np.pi
    arm = position.arm_m
    if position.column == "angle_rad":
        yield "angle_rad", "degrees", 360.0 / turn
        yield "angle_rad", "turns", 1.0 / turn
        if not turns:
            yield "velocity_m_s", "rad/s", arm
        yield "velocity_m_s", "degrees a second", arm * turn / 360.0
        yield "velocity_m_s", "turns a minute", arm * turn / 60.0
        yield "velocity_m_s", "turns a second", arm * turn
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
