"""A failure's bins as plot coordinates: positions, series, tick labels, the axis's name."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from jbf.comparison.bins import Axis, Bin, direction_words, label, span_words
from jbf.comparison.patterns import Failure
from jbf.records.quantities import OF_BEARING, Quantities

Array = npt.NDArray[np.float64]


def _names(said: Quantities) -> dict[Axis, str]:
    return {
        "velocity": f"{said.velocity} ({said.speed})",
        "angle": "Shaft angle (deg)" if said.motion == "bearing" else "Angle (deg)",
        "time": "Time in the run (s)",
        "time since a rest": f"Time since {said.mover} rested",
        "distance since a reversal": "Distance since the motion reversed",
        "direction": "Direction of motion",
        "regime": "Lubrication regime",
        "force": f"{said.noun.capitalize()} of the model ({said.force})",
        "speed range": "Speed range",
        "acceleration": "Phase of the motion",
        "run": "Run",
    }


@dataclass(frozen=True)
class BinAxis:
    """Where each bin stands on a plot.

    Attributes
    ----------
    name
        For the axis, with its unit.
    x
        Position of each bin, shape (b,).
    series
        Label of the line a bin belongs to: a direction of motion, or empty.
    ticks
        Names of the positions 0, 1, ... where the axis holds words, else empty.
    """

    name: str
    x: Array
    series: tuple[str, ...]
    ticks: tuple[str, ...]


def bin_axis(failure: Failure, said: Quantities = OF_BEARING) -> BinAxis:
    """Where a failure's bins stand: at their numbers, or side by side under their words."""
    name = _names(said)[failure.axis]
    series = tuple(_series(b, failure.axis) for b in failure.bins)
    positions = [b.position for b in failure.bins]
    if all(p is not None for p in positions):
        return BinAxis(name, np.array(positions, dtype=float), series, ())
    # Both ways of one place stand above one another.
    places = [
        replace(b, direction=0, with_rest=False) if line else b
        for b, line in zip(failure.bins, series, strict=True)
    ]
    different = list(dict.fromkeys(places))
    x = np.array([different.index(place) for place in places], dtype=float)
    return BinAxis(name, x, series, tuple(_tick(b, failure.axis) for b in different))


def _series(b: Bin, axis: Axis) -> str:
    """The line that a bin belongs to; along velocity and direction the place tells the way."""
    return "" if axis in ("velocity", "direction") else direction_words(b)


def _tick(b: Bin, axis: Axis) -> str:
    """A bin's place in words, on two lines where that helps; the axis's name says the rest."""
    if b.span is None:
        return b.name or label(axis, b)
    words = span_words(b)
    for lead in ("up to ", "over "):
        if words.startswith(lead):
            return f"{lead.strip()}\n{words.removeprefix(lead)}"
    return words.replace(" to ", "\nto ")
