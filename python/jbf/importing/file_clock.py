"""Clock of one file: the origin of its times, and their correction."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
import numpy.typing as npt

from jbf.importing.evaluation import Quantity, converted, evaluate
from jbf.importing.expression import Node, Reference
from jbf.importing.formats.table import Values
from jbf.importing.targets import wanted_unit

Array = npt.NDArray[np.float64]

EPOCH_S = (1e8, 1e10)
"""Range of times that are interpreted as seconds since 1970."""


@dataclass
class FileClock:
    """Clock of one file.

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
        """Return corrected times, s.

        The whole seconds of the first time are subtracted before any rounding.
        """
        wanted = wanted_unit("time_s")
        found = evaluate(node, values, units)
        time = converted(found, wanted, "time_s")
        if self.origin_s is None:
            known = time[np.isfinite(time)]
            late = known.size > 0 and EPOCH_S[0] < known[0] < EPOCH_S[1]
            self.origin_s = float(np.floor(known[0])) if late else 0.0
        if self.origin_s and isinstance(node, Reference) and found.unit.pi == 0:
            first = float(Fraction(int(self.origin_s)) / found.unit.ratio)
            time = converted(Quantity(found.value - first, found.unit), wanted, "time_s")
        elif self.origin_s:
            time = time - self.origin_s
        return self.corrected(time)

    def corrected(self, time: Array) -> Array:
        """Convert times of this clock to times of the recording, s."""
        if self.drift:
            time = time + self.drift * (time - self.pivot_s)
        if self.offset_s:
            time = time + self.offset_s
        return np.round(time, 9) if self.rounded else time
