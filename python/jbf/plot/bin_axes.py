"""Plot coordinates of the bins of a residual pattern."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from jbf.arrays import Array
from jbf.comparison.bins import Axis, Bin, direction_words, label, span_words
from jbf.comparison.patterns import Failure
from jbf.records.quantities import BEARING, Quantities


def _names(quantities: Quantities) -> dict[Axis, str]:
    """Axis label of each axis, with the units of a rig."""
    return {
        "velocity": f"{quantities.velocity} ({quantities.speed})",
        "angle": "Shaft angle (deg)" if quantities.motion == "bearing" else "Angle (deg)",
        "time": "Time in the run (s)",
        "time since a rest": "Time since the last rest",
        "distance since a reversal": "Distance since the last reversal",
        "direction": "Direction of motion",
        "regime": "Lubrication regime",
        "force": f"{quantities.noun.capitalize()} of the model ({quantities.force})",
        "speed range": "Speed range",
        "acceleration": "Phase of the motion",
        "run": "Run",
    }


@dataclass(frozen=True)
class BinAxis:
    """Plot coordinates of the bins of a residual pattern.

    Attributes
    ----------
    name
        Axis label, with its unit.
    x
        Position of each bin, shape (b,).
    series
        Label of the line to which a bin belongs: a direction of motion, or empty.
    ticks
        Labels of the positions 0, 1, ... of a categorical axis, else empty.
    """

    name: str
    x: Array
    series: tuple[str, ...]
    ticks: tuple[str, ...]


def bin_axis(failure: Failure, quantities: Quantities = BEARING) -> BinAxis:
    """Plot coordinates of the bins of a pattern, numerical where possible.

    Bins without a numeric position are on a categorical axis.
    """
    name = _names(quantities)[failure.axis]
    series = tuple(_series(b, failure.axis) for b in failure.bins)
    positions = [b.position for b in failure.bins]
    if all(p is not None for p in positions):
        return BinAxis(name, np.array(positions, dtype=float), series, ())
    # Bins of both directions of motion share one position.
    places = [
        replace(b, direction=0, with_rest=False) if line else b
        for b, line in zip(failure.bins, series, strict=True)
    ]
    different = list(dict.fromkeys(places))
    x = np.array([different.index(place) for place in places], dtype=float)
    return BinAxis(name, x, series, tuple(_tick(b, failure.axis) for b in different))


def _series(b: Bin, axis: Axis) -> str:
    """Label of the line to which a bin belongs.

    Along velocity and direction the position itself contains the direction of motion.
    """
    return "" if axis in ("velocity", "direction") else direction_words(b)


def _tick(b: Bin, axis: Axis) -> str:
    """Tick label of a bin; the label of an interval has two lines.

    The unit is in the axis label.
    """
    if b.span is None:
        return b.name or label(axis, b)
    words = span_words(b)
    for lead in ("up to ", "over "):
        if words.startswith(lead):
            return f"{lead.strip()}\n{words.removeprefix(lead)}"
    return words.replace(" to ", "\nto ")
