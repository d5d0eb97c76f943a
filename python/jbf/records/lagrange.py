"""Lagrange interpolation of a few samples at a further instant."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]


def weights_at_zero(t: Array) -> Array:
    """Lagrange weights at time zero for values at the times `t`, shape (points, ...)."""
    weights = np.ones_like(t)
    for j in range(len(t)):
        for k in range(len(t)):
            if k != j:
                weights[j] *= t[k] / (t[k] - t[j])
    return weights
