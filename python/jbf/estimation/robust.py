"""What a few samples that are off do not decide (Hampel 1974)."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

CLIPPED = 3.5
"""Errors count no more than at so many standard deviations."""


def robust_size(values: Array) -> float:
    """A standard deviation from the median; zero of none, as of a run that was set aside."""
    if not len(values):
        return 0.0
    return float(np.median(np.abs(values))) / 0.6745


def clipped_square(errors: Array, size: float) -> float:
    """Their sum of squares, each no further than to `CLIPPED` standard deviations of this size."""
    return float(np.sum(np.minimum(errors**2, (CLIPPED * size) ** 2)))
