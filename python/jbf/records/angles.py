"""Angles that restart at each turn."""

from __future__ import annotations

import numpy as np

from jbf.arrays import Array


def continuous(angle: Array) -> Array:
    """Return an angle, rad, without the jumps of an encoder that restarts at each turn.

    An angle that counts the turns is returned unchanged, even if a fast shaft turns by more than
    half a turn between two samples. The recorded or the unwrapped angle (`numpy.unwrap`) is
    returned, whichever has the smaller changes of its steps.
    """
    steps = np.diff(angle)
    if not np.any(np.abs(steps) > np.pi):
        return angle
    unwrapped: Array = np.unwrap(angle)
    changes = [float(np.sum(np.abs(np.diff(a, 2)))) for a in (angle, unwrapped)]
    return unwrapped if changes[1] < changes[0] else angle
