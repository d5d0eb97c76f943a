"""Friction-speed plane: number of samples per pixel, encoded as an image."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from jbf.arrays import Array, Mask

Counts = npt.NDArray[np.int64]
Places = npt.NDArray[np.int32]

MARGIN = 0.04


@dataclass(frozen=True)
class Frame:
    """Pixel grid over a rectangle of the friction-speed plane.

    Attributes
    ----------
    left, right
        Range of the speed.
    low, high
        Range of the force.
    columns, rows
        Number of pixels; row 0 is at the lowest force.
    """

    left: float
    right: float
    low: float
    high: float
    columns: int
    rows: int

    @classmethod
    def around(cls, x: Sequence[Array], y: Sequence[Array], columns: int, rows: int) -> Frame:
        """Create the grid over the smallest rectangle with all points and a margin."""

        def ends(parts: Sequence[Array]) -> tuple[float, float]:
            low = min((float(np.nanmin(p)) for p in parts if np.any(np.isfinite(p))), default=0.0)
            high = max((float(np.nanmax(p)) for p in parts if np.any(np.isfinite(p))), default=1.0)
            margin = MARGIN * (high - low) or max(abs(high), 1e-12)
            return low - margin, high + margin

        return cls(*ends(x), *ends(y), columns, rows)

    def places(self, x: Array, y: Array) -> Places:
        """Pixel index of each sample in row-major order; one beyond the last for samples outside.

        `x` is the speed and `y` the force of each sample.
        """
        across = (x - self.left) * (self.columns / (self.right - self.left))
        up = (y - self.low) * (self.rows / (self.high - self.low))
        # NaN compares false.
        inside = (across >= 0) & (across < self.columns) & (up >= 0) & (up < self.rows)
        with np.errstate(invalid="ignore"):
            place = up.astype(np.int32) * np.int32(self.columns) + across.astype(np.int32)
        pixels: Places = np.where(inside, place, np.int32(self.rows * self.columns))
        return pixels

    def counts(self, places: Sequence[Places]) -> Counts:
        """Number of samples in each pixel, shape (rows, columns)."""
        pixels = self.rows * self.columns
        total = np.zeros(pixels + 1, dtype=np.int64)
        for part in places:
            total += np.bincount(part, minlength=pixels + 1)
        return total[:pixels].reshape(self.rows, self.columns)

    def picture(self, places: Sequence[Places]) -> str:
        """Image of the number of samples in each pixel, encoded by `shade`."""
        return shade(self.counts(places))

    def to_dict(self) -> dict[str, Any]:
        """Data of the grid for the page."""
        return dict(vars(self))


def shade(counts: Counts) -> str:
    """Encode numbers of samples per pixel as an image: bytes from 0 (none) to 255, base64.

    The scale is logarithmic, the order row by row.
    """
    largest = max(int(counts.max(initial=0)), 1)
    level = np.log1p(counts) / np.log1p(largest)
    shades = np.where(counts > 0, np.maximum(np.round(255 * level), 40), 0).astype(np.uint8)
    return base64.b64encode(shades.tobytes()).decode("ascii")


def within(x: Array, y: Array, box: tuple[float, float, float, float]) -> Mask:
    """Mask of the samples in a rectangle of the friction-speed plane.

    `box` contains smallest and largest speed, smallest and largest force.
    """
    left, right, low, high = box
    inside: Mask = (x >= left) & (x <= right) & (y >= low) & (y <= high)
    return inside
