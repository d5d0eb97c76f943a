"""Bins along an axis: position, direction of motion, and text.

Only this module generates the text of a bin. Numbers are taken from the bin and never parsed from
its text.
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
"""Axis along which a residual is examined."""

Direction = Literal[-1, 0, 1]
"""Direction of the motion in a bin: backward, both, forward."""

_CENTRES = {"velocity": "v = {:+.3g}", "force": "f = {:+.3g}", "angle": "angle {:.0f}"}
_AFTER = {"time since a rest": "a rest", "distance since a reversal": "a reversal"}


@dataclass(frozen=True)
class Bin:
    """One bin along an axis of the residual.

    Attributes
    ----------
    name
        Name of a bin without a numeric position: a regime, a run.
    centre
        Position of its samples along the axis, in `unit`.
    span
        Lower and upper end, in `unit`; an end may be infinite.
    unit
        Unit of the position; empty for a bin without a numeric position.
    direction
        Direction of motion of its samples.
    with_rest
        True if a backward bin also contains samples at rest.
    """

    name: str = ""
    centre: float | None = None
    span: tuple[float, float] | None = None
    unit: str = ""
    direction: Direction = 0
    with_rest: bool = False

    @property
    def position(self) -> float | None:
        """Position along the axis, in `unit`; None for a bin without a numeric position."""
        if self.span is not None and all(map(math.isfinite, self.span)):
            return 0.5 * (self.span[0] + self.span[1])
        return self.centre


@dataclass(frozen=True)
class Binned:
    """Samples of every run assigned to the bins of one axis.

    Attributes
    ----------
    axis, bins
        The axis, and its bins.
    places
        Bin index of each sample, one array per run; -1 for a sample without a bin.
    force_unit
        Unit of the residuals.
    """

    axis: Axis
    bins: tuple[Bin, ...]
    places: list[Places]
    force_unit: str = "N"

    @property
    def labels(self) -> tuple[str, ...]:
        """Label of each bin, such as its interval, as text."""
        return labels(self.axis, self.bins)


def span_words(b: Bin) -> str:
    """Text of a bin's interval, `up to 0.1 s`, `0.1 to 0.2 s` or `over 0.2 s`; or empty."""
    if b.span is None:
        return ""
    low, high = b.span
    if math.isinf(low):
        return f"up to {high:.2g} {b.unit}"
    if math.isinf(high):
        return f"over {low:.2g} {b.unit}"
    return f"{low:.2g} to {high:.2g} {b.unit}"


def direction_words(b: Bin) -> str:
    """Text of a bin's direction of motion: `v < 0` or `v > 0`; empty for both directions."""
    if b.direction == 0:
        return ""
    if b.direction == 1:
        return "v > 0"
    return "v <= 0" if b.with_rest else "v < 0"


def label(axis: Axis, b: Bin) -> str:
    """Text of a bin: its position along the axis, then its direction of motion."""
    if axis in _CENTRES and b.centre is not None:
        place = f"{_CENTRES[axis].format(b.centre)} {b.unit}"
    elif axis in _AFTER:
        place = f"{span_words(b)} after {_AFTER[axis]}"
    elif b.span is not None:
        place = f"{b.span[0]:.0f} to {b.span[1]:.0f} {b.unit}"
    else:
        place = f"run {b.name}" if axis == "run" else b.name
    # The sign of the speed already gives the direction.
    direction = "" if axis == "velocity" else direction_words(b)
    return ", ".join(words for words in (place, direction) if words)


def labels(axis: Axis, bins: tuple[Bin, ...]) -> tuple[str, ...]:
    """Label of each bin of an axis, as text."""
    return tuple(label(axis, b) for b in bins)
