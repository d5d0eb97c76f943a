"""The load that a record tells: a force, or a pressure that stands for one."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from jbf.records.rig import Rig
from jbf.records.run import Run

Array = npt.NDArray[np.float64]

PRESSURE = "pressure_pa"
LOAD_TORQUE = "load_n_m"
BAR_PA = 1e5
LEAST_LOAD = 1e-9
"""Smallest load torque used, N m; avoids a division by zero."""


def recorded_load(rig: Rig, run: Run) -> Array | None:
    """The load of each sample, shape (N,); None where none was recorded.

    `load_n`, N; or, on an axis without a bearing, the column `pressure_pa`, in bar (1e5 Pa): what a
    seal's friction grows with. Parameters "over load" are then N a bar. On a rotary drive, the size
    of the column `load_n_m`, N m: the torque that a gear transmits.
    """
    if run.load_n is not None:
        return run.load_n
    if rig.bearing is None and PRESSURE in run.extra:
        found: Array = run.extra[PRESSURE] / BAR_PA
        return found
    if rig.quantities.motion == "rotary" and LOAD_TORQUE in run.extra:
        return np.maximum(np.abs(run.extra[LOAD_TORQUE]), LEAST_LOAD)
    return None
