"""Bins along an axis as data: where each stands, which way the motion goes, and its words.

The words of a bin are made here and nowhere else, and nothing reads them back: who wants a number
takes it from the bin.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

Places = npt.NDArray[np.intp]

Axis = Literal[
    "velocity",
    "direction",
    "regime",
    "speed range",
    "acceleration",
    "angle",
    "time",
    "run",
    "time since a rest",
    "distance since a reversal",
    "force",
]
"""What a residual is looked at along."""

Direction = Literal[-1, 0, 1]
"""Of the motion in a bin: backwards, either way, forwards."""

_CENTRES = {"velocity": "v = {:+.3g}", "force": "f = {:+.3g}", "angle": "angle {:.0f}"}
_AFTER = {"time since a rest": "a rest", "distance since a reversal": "a reversal"}


@dataclass(frozen=True)
class Bin:
    """One bin.

    Attributes
    ----------
    name
        Of a bin that is no number: a regime, a run.
    centre
        Where its samples lie along the axis, in `unit`.
    span
        From where to where it reaches, in `unit`; an end may be infinite.
    direction
        Which way its samples move.
    with_rest
        True where a backward bin holds samples at rest, too.
    """

    name: str = ""
    centre: float | None = None
    span: tuple[float, float] | None = None
    unit: str = ""
    direction: Direction = 0
    with_rest: bool = False

    @property
    def position(self) -> float | None:
        """Where it stands along its axis, in `unit`; None of a bin that is no number."""
        if self.span is not None and all(map(math.isfinite, self.span)):
            return 0.5 * (self.span[0] + self.span[1])
        return self.centre


@dataclass(frozen=True)
class Binned:
    """Every run's samples sorted into bins.

    `places` holds, one array a run, which bin each sample is in; -1 means in none. `force_unit` is
    that of the residuals.
    """

    axis: Axis
    bins: tuple[Bin, ...]
    places: list[Places]
    force_unit: str = "N"

    @property
    def labels(self) -> tuple[str, ...]:
        """The bins in words."""
        return labels(self.axis, self.bins)


def span_words(b: Bin) -> str:
    """`up to 0.1 s`, `0.1 to 0.2 s`, `over 0.2 s`; empty of a bin without a span."""
    if b.span is None:
        return ""
    low, high = b.span
    if math.isinf(low):
        return f"up to {high:.2g} {b.unit}"
    if math.isinf(high):
        return f"over {low:.2g} {b.unit}"
    return f"{low:.2g} to {high:.2g} {b.unit}"


def direction_words(b: Bin) -> str:
    """`v < 0`, `v > 0`; empty where a bin holds both."""
    if b.direction == 0:
        return ""
    if b.direction == 1:
        return "v > 0"
    return "v <= 0" if b.with_rest else "v < 0"


def label(axis: Axis, b: Bin) -> str:
    """A bin in words: where it stands, then the direction of its motion."""
    if axis in _CENTRES and b.centre is not None:
        place = f"{_CENTRES[axis].format(b.centre)} {b.unit}"
    elif axis in _AFTER:
        place = f"{span_words(b)} after {_AFTER[axis]}"
    elif b.span is not None:
        place = f"{b.span[0]:.0f} to {b.span[1]:.0f} {b.unit}"
    else:
        place = f"run {b.name}" if axis == "run" else b.name
    # The sign of the speed has said it.
    way = "" if axis == "velocity" else direction_words(b)
    return ", ".join(words for words in (place, way) if words)


def labels(axis: Axis, bins: tuple[Bin, ...]) -> tuple[str, ...]:
    """All bins in words."""
    return tuple(label(axis, b) for b in bins)
