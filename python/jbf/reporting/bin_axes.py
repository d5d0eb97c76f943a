"""A failure's bins as plot coordinates: positions, series, tick labels, the axis's name."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from jbf.comparison.comparison import Failure

Array = npt.NDArray[np.float64]

_DIRECTION = re.compile(r"^(?P<rest>.*?),? ?(?P<direction>v (<|<=|>|>=) 0)$")
_SPEED = re.compile(r"^v = ([-+][\d.e+-]+) m/s$")
_FORCE = re.compile(r"^f = ([-+][\d.e+-]+) N$")
_ANGLE = re.compile(r"^angle ([\d.]+) deg$")
_SPAN = re.compile(r"^([\d.e+-]+) to ([\d.e+-]+) s$")
_NAMES = {
    "velocity": "Surface speed (m/s)",
    "angle": "Shaft angle (deg)",
    "time": "Time in the run (s)",
    "time since a rest": "Time since the shaft rested",
    "distance since a reversal": "Distance since the motion reversed",
    "direction": "Direction of motion",
    "regime": "Lubrication regime",
    "force": "Force of the model (N)",
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


def bin_axis(failure: Failure) -> BinAxis:
    """Sort the labels of a failure's bins into numbers or words, and by direction."""
    split = [_split(label, failure.axis) for label in failure.labels]
    series = tuple(direction for _, direction in split)
    places = [place for place, _ in split]
    name = _NAMES.get(failure.axis, failure.axis.capitalize())
    values = [_value(place) for place in places]
    if all(v is not None for v in values):
        return BinAxis(name, np.array(values, dtype=float), series, ())
    words = list(dict.fromkeys(places))
    x = np.array([words.index(place) for place in places], dtype=float)
    return BinAxis(name, x, series, tuple(map(_shortened, words)))


def _split(label: str, axis: str) -> tuple[str, str]:
    """A label's place along the axis, and its direction where it names one."""
    found = _DIRECTION.match(label)
    if found is None or axis == "direction":
        return label, ""
    return found["rest"], found["direction"]


def _value(place: str) -> float | None:
    """The number that a place stands for, where it is one."""
    for pattern in (_SPEED, _FORCE, _ANGLE, _SPAN):
        found = pattern.match(place)
        if found:
            return float(np.mean([float(x) for x in found.groups()]))
    return None


def _shortened(words: str) -> str:
    """What the axis's name already says, left out; a second line where it helps."""
    short = re.sub(r" after (a )?(rest|reversal)$", "", words).removeprefix("run ")
    for lead in ("up to ", "over "):
        if short.startswith(lead):
            return f"{lead.strip()}\n{short.removeprefix(lead)}"
    return short.replace(" to ", "\nto ")
