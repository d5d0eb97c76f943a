"""Recorded load: a normal force, a pressure, or a transmitted torque."""

from __future__ import annotations

import numpy as np

from jbf.arrays import Array
from jbf.records.rig import Rig
from jbf.records.run import Run

PRESSURE = "pressure_pa"
LOAD_TORQUE = "load_n_m"
BAR_PA = 1e5
LEAST_LOAD = 1e-9
"""Smallest load torque used, N m; avoids a division by zero."""


def recorded_load(rig: Rig, run: Run) -> Array | None:
    """Recorded load at each sample, shape (N,); None if none was recorded.

    The load is `load_n`, N. On an axis without a bearing it may be the column `pressure_pa`,
    converted to bar (1e5 Pa), on which the friction of a seal depends. Parameters "over load" are
    then in N per bar. On a rotary drive it may be the magnitude of the column `load_n_m`, N m: the
    torque that a gear transmits.
    """
    if run.load_n is not None:
        return run.load_n
    if rig.bearing is None and PRESSURE in run.extra:
        load: Array = run.extra[PRESSURE] / BAR_PA
        return load
    if rig.quantities.motion == "rotary" and LOAD_TORQUE in run.extra:
        return np.maximum(np.abs(run.extra[LOAD_TORQUE]), LEAST_LOAD)
    return None
