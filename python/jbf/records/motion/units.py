"""Path and speed that contradict one another by a factor: another unit, or a sign turned."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

from jbf.records.findings.finding import Finding
from jbf.records.motion.compared import Compared, compared
from jbf.records.motion.position import Position
from jbf.records.quantities import OF_BEARING, Quantities

Array = npt.NDArray[np.float64]

FAST = 0.3
"""Share of the top speed above which a ratio tells something."""
OFF = 0.2
"""Path and speed whose ratio is further off one contradict one another,"""
SPREADS = 4.0
"""where that is so many times its spread (half the range of its middle half),"""
STEADY = 0.15
"""and its spread is less than this share: a factor is the same all the time."""
NEAR = 0.06
"""A ratio is a unit's where it is so near to its factor."""


def wrong_unit(
    name: str,
    time: Array,
    position: Position,
    speed: Array,
    quantities: Quantities = OF_BEARING,
) -> Finding | None:
    """A finding where path and speed differ by a factor; its channel is the one not to be believed:
    the speed where the factor is one of a speed's units, else the path."""
    called = quantities.speed_column
    ratio = _ratio(time, position.path_m, speed)
    if ratio is None:
        return None
    if abs(ratio + 1.0) < OFF:
        words = f"{position.column} falls where {called} says that it rises: one has its sign"
        done = "left aside; the speed alone tells the motion"
        return Finding("sign", position.column, name, ratio, "1", done, f"{words} turned")
    column, unit = position.column, ""
    for which, guess, factor in _units(position, turns=quantities.motion == "rotary"):
        if abs(abs(ratio) / factor - 1.0) < NEAR:
            said = called if which == "velocity_m_s" else which
            column, unit = which, f": is {said} in {guess}?"
            break
    other = "path" if column == "velocity_m_s" else "speed"
    turned = ", and the other way" if ratio < 0.0 else ""
    hint = unit or (": is the radius of the journal right?" if position.arm_m != 1.0 else "")
    words = f"{position.column} changes {abs(ratio):.4g} times as fast as {called} says{turned}"
    done = f"left aside; the {other} alone tells the motion"
    return Finding("units", column, name, ratio, "1", done, words + hint)


def _ratio(time: Array, path: Array, speed: Array) -> float | None:
    """How many times as fast the path changes as the speed says; None where they agree, or where
    they are no multiples of one another."""
    for c in compared(time, path, speed):
        ratio, spread = _middle(c)
        if spread < STEADY * abs(ratio) and abs(ratio - 1.0) > max(OFF, SPREADS * spread):
            return ratio
    return None


def _middle(c: Compared) -> tuple[float, float]:
    fast = np.abs(c.by_speed) > FAST * np.quantile(np.abs(c.by_speed), 0.95)
    if fast.sum() < 20:
        return 1.0, np.inf
    low, middle, high = np.quantile(c.by_path[fast] / c.by_speed[fast], [0.25, 0.5, 0.75])
    # A steady speed spreads by nothing, however coarse the counts are.
    coarse = c.count / float(np.median(np.abs(c.by_speed[fast])))
    return float(middle), float(0.5 * (high - low)) + coarse


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
