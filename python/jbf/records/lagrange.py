"""Lagrange's polynomial through a few samples, at one more instant."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]


def weights_at_zero(t: Array) -> Array:
    """Weights, at zero, of values at times, shape (points, ...)."""
    weights = np.ones_like(t)
    for j in range(len(t)):
        for k in range(len(t)):
            if k != j:
                weights[j] *= t[k] / (t[k] - t[j])
    return weights
