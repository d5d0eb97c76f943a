"""The friction-speed plane: how many samples lie where, as a picture of so many pixels."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]
Counts = npt.NDArray[np.int64]
Places = npt.NDArray[np.int32]

MARGIN = 0.04


@dataclass(frozen=True)
class Frame:
    """A rectangle of the plane in pixels: `x` is the speed, `y` the force, row 0 at the bottom."""

    left: float
    right: float
    low: float
    high: float
    columns: int
    rows: int

    @classmethod
    def around(cls, x: Sequence[Array], y: Sequence[Array], columns: int, rows: int) -> Frame:
        """The rectangle that holds all points, with a margin."""

        def ends(parts: Sequence[Array]) -> tuple[float, float]:
            low = min((float(np.nanmin(p)) for p in parts if np.any(np.isfinite(p))), default=0.0)
            high = max((float(np.nanmax(p)) for p in parts if np.any(np.isfinite(p))), default=1.0)
            more = MARGIN * (high - low) or max(abs(high), 1e-12)
            return low - more, high + more

        return cls(*ends(x), *ends(y), columns, rows)

    def places(self, x: Array, y: Array) -> Places:
        """The pixel of each sample, row by row; one beyond the last for what lies in none."""
        across = (x - self.left) * (self.columns / (self.right - self.left))
        up = (y - self.low) * (self.rows / (self.high - self.low))
        # Not-a-number compares false.
        inside = (across >= 0) & (across < self.columns) & (up >= 0) & (up < self.rows)
        with np.errstate(invalid="ignore"):
            place = up.astype(np.int32) * np.int32(self.columns) + across.astype(np.int32)
        found: Places = np.where(inside, place, np.int32(self.rows * self.columns))
        return found

    def counts(self, places: Sequence[Places]) -> Counts:
        """Samples in each pixel, shape (rows, columns)."""
        pixels = self.rows * self.columns
        found = np.zeros(pixels + 1, dtype=np.int64)
        for part in places:
            found += np.bincount(part, minlength=pixels + 1)
        return found[:pixels].reshape(self.rows, self.columns)

    def picture(self, places: Sequence[Places]) -> str:
        """The same as `shade` draws it."""
        return shade(self.counts(places))

    def to_dict(self) -> dict[str, Any]:
        """For the page."""
        return dict(vars(self))


def shade(counts: Counts) -> str:
    """Counts as bytes from 0 (none) to 255 on a logarithmic scale, row by row, in base64."""
    most = max(int(counts.max(initial=0)), 1)
    level = np.log1p(counts) / np.log1p(most)
    shown = np.where(counts > 0, np.maximum(np.round(255 * level), 40), 0).astype(np.uint8)
    return base64.b64encode(shown.tobytes()).decode("ascii")


def within(x: Array, y: Array, box: tuple[float, float, float, float]) -> Mask:
    """Samples in a rectangle: least and largest speed, least and largest force."""
    left, right, low, high = box
    inside: Mask = (x >= left) & (x <= right) & (y >= low) & (y <= high)
    return inside
