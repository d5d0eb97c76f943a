"""Robust statistics with bounded influence of outliers (Hampel 1974)."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

CLIPPED = 3.5
"""Limit of the contribution of an error, in standard deviations."""


def robust_size(values: Array) -> float:
    """Standard deviation estimated from the median; zero without values, as for an excluded run."""
    if not len(values):
        return 0.0
    return float(np.median(np.abs(values))) / 0.6745


def clipped_square(errors: Array, size: float) -> float:
    """Sum of squares with each error clipped at `CLIPPED` times the standard deviation `size`."""
    return float(np.sum(np.minimum(errors**2, (CLIPPED * size) ** 2)))
