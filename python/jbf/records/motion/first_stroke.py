"""Whether a run begins in motion.

A model takes a run that begins in motion to have slid before, its contact bent that way. The speed
of a machine that stands is seldom zero in a record: it hums a little to and fro, and the first of
that is no direction in which anything slid.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

HUM = 1e-3
"""A first way so small a share of the longest one between two turns is a hum."""


def begins_in_a_hum(time_s: Array, velocity_m_s: Array) -> bool:
    """True where the speed turns round before the run has gone anywhere."""
    v = velocity_m_s
    turns = np.flatnonzero(np.sign(v[1:]) != np.sign(v[:-1])) + 1
    if v[0] == 0.0 or not len(turns):
        return False
    steps = 0.5 * (v[1:] + v[:-1]) * np.diff(time_s)
    # A step that turns belongs half to either way: what it has is small beside both.
    ways = np.abs(np.add.reduceat(steps, np.unique(np.concatenate(([0], turns - 1)))))
    first = float(np.sum(np.abs(steps[: max(turns[0] - 1, 1)])))
    return first < HUM * float(np.max(ways))
