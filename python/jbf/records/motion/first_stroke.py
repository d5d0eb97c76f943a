"""Detection of a run that begins at rest with a noisy speed.

If a run begins in motion, a model assumes that the contact is deflected in that direction. The
recorded speed of a machine at rest is seldom zero, but has noise. The sign of this noise is then
not a direction of sliding.
"""

from __future__ import annotations

import numpy as np

from jbf.arrays import Array

MAX_NOISE_SHARE = 1e-3
"""Largest first displacement of noise, relative to the longest one between two reversals."""


def begins_with_oscillation(time_s: Array, velocity: Array) -> bool:
    """Whether the speed at the start of a run reverses before a significant displacement."""
    v = velocity
    turns = np.flatnonzero(np.sign(v[1:]) != np.sign(v[:-1])) + 1
    if v[0] == 0.0 or not len(turns):
        return False
    steps = 0.5 * (v[1:] + v[:-1]) * np.diff(time_s)
    # The displacement in a step with a reversal is small, and is not divided between the
    # directions.
    displacements = np.abs(np.add.reduceat(steps, np.unique(np.concatenate(([0], turns - 1)))))
    first = float(np.sum(np.abs(steps[: max(turns[0] - 1, 1)])))
    return first < MAX_NOISE_SHARE * float(np.max(displacements))
