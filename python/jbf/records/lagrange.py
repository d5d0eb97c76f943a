"""Lagrange interpolation of a few samples."""

from __future__ import annotations

import numpy as np

from jbf.arrays import Array


def weights_at_zero(t: Array) -> Array:
    """Lagrange weights that interpolate values at the times `t` to time zero, shape of `t`."""
    weights = np.ones_like(t)
    for j in range(len(t)):
        for k in range(len(t)):
            if k != j:
                weights[j] *= t[k] / (t[k] - t[j])
    return weights
