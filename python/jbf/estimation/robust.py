"""Robust statistics with bounded influence of outliers (Hampel 1974)."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]


def robust_size(values: Array) -> float:
    """Standard deviation estimated from the median; zero without values, as for an excluded run."""
    if not len(values):
        return 0.0
    return float(np.median(np.abs(values))) / 0.6745


def clipped_square(errors: Array, size: float, clip_sigma: float) -> float:
    """Sum of squares with errors clipped at `clip_sigma` standard deviations of `size`."""
    return float(np.sum(np.minimum(errors**2, (clip_sigma * size) ** 2)))
