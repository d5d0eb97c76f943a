"""Clock of one file: the origin of its times, and their correction."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from jbf.arrays import Array
from jbf.importing.evaluation import column_unit, converted, evaluate
from jbf.importing.expression import Binary, Node, Reference
from jbf.importing.formats.table import Values
from jbf.importing.targets import wanted_unit

EPOCH_S = (1e8, 1e10)
"""Range of times that are interpreted as seconds since 1970."""


@dataclass
class FileClock:
    """Clock of one file: origin of its times, and their correction.

    Attributes
    ----------
    origin_s
        Whole seconds since 1970 that are subtracted from all times; 0 if times do not count from
        1970, None before the first time is read.
    offset_s, drift, pivot_s
        Parameters of the corrected time, t + offset_s + drift (t - pivot_s).
    rounded
        Whether times are rounded to nanoseconds, so that equal times of several files are equal
        numbers.
    """

    origin_s: float | None = None
    offset_s: float = 0.0
    drift: float = 0.0
    pivot_s: float = 0.0
    rounded: bool = False

    def seconds(self, node: Node, values: Mapping[str, Values], units: Mapping[str, str]) -> Array:
        """Evaluate the time expression of a file and return corrected times, s.

        The whole seconds of the first time are subtracted before any rounding: in the column that
        counts from 1970, and in its unit.
        """
        time = _time(node, values, units)
        if self.origin_s is None:
            finite = time[np.isfinite(time)]
            self.origin_s = float(np.floor(finite[0])) if _is_since_1970(time) else 0.0
        if not self.origin_s:
            return self.corrected(time)
        column = _column_since_1970(node, values, units)
        if column is None:
            return self.corrected(time - self.origin_s)
        first = Fraction(int(self.origin_s)) / column_unit(column, units).ratio
        shifted = values[column.column] - (int(first) if first.denominator == 1 else float(first))
        return self.corrected(_time(node, {**values, column.column: shifted}, units))

    def corrected(self, time: Array) -> Array:
        """Convert times of this clock to times of the recording, s."""
        if self.drift:
            time = time + self.drift * (time - self.pivot_s)
        if self.offset_s:
            time = time + self.offset_s
        return np.round(time, 9) if self.rounded else time


def _time(node: Node, values: Mapping[str, Values], units: Mapping[str, str]) -> Array:
    return converted(evaluate(node, values, units), wanted_unit("time_s"), "time_s")


def _is_since_1970(time: Array) -> bool:
    """Whether times, s, are plausible as seconds since 1970."""
    finite = time[np.isfinite(time)]
    return bool(finite.size) and bool(EPOCH_S[0] < finite[0] < EPOCH_S[1])


def _column_since_1970(
    node: Node, values: Mapping[str, Values], units: Mapping[str, str]
) -> Reference | None:
    """Column of a time expression that counts from 1970, such as in `secs [s] + nsecs [ns]`.

    Returns None if no column counts from 1970.
    """
    if isinstance(node, Binary) and node.sign in ("+", "-"):
        sides = (node.left, node.right) if node.sign == "+" else (node.left,)
        columns = (_column_since_1970(side, values, units) for side in sides)
        return next((column for column in columns if column is not None), None)
    if not isinstance(node, Reference) or not column_unit(node, units).fits(wanted_unit("time_s")):
        return None
    return node if _is_since_1970(_time(node, values, units)) else None
