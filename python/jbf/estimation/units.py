"""Independent units of paired comparisons: the runs, or their strokes where there are few runs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt

from jbf.estimation.prepared import Prepared
from jbf.estimation.settings import DEFAULT, HeldOutSettings

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]
Strokes = npt.NDArray[np.intp]
Units = list[tuple[int, Mask]]
"""Index of a run, and a mask of those of its counting samples that belong to the unit."""


def stroke_of(p: Prepared) -> Strokes:
    """Number of the stroke of each sample; -1 where it is not known to move.

    A stroke ends where the motion reverses.
    """
    motion = p.motion
    moving = np.flatnonzero(p.slides)
    found = np.full(len(motion.velocity), -1, dtype=np.intp)
    if len(moving):
        sign = np.sign(motion.velocity[moving])
        found[moving] = np.cumsum(np.diff(sign, prepend=sign[0]) != 0.0)
    return found


def independent_units(
    counted: Mapping[int, Mask],
    prepared: Sequence[Prepared],
    settings: HeldOutSettings = DEFAULT.held_out,
) -> Units:
    """Divide samples into units: runs, or strokes where there are fewer runs than `min_units`.

    Parameters
    ----------
    counted
        Samples that count, by the index of the run.
    prepared
        All runs; without them, the runs are the units.
    """
    runs = {i: mask for i, mask in counted.items() if mask.any()}
    if len(runs) >= settings.min_units or not prepared:
        return [(i, np.ones(np.count_nonzero(mask), dtype=bool)) for i, mask in runs.items()]
    units = []
    for i, mask in runs.items():
        stroke = stroke_of(prepared[i])[mask]
        members = [stroke == k for k in range(int(np.max(stroke, initial=-1)) + 1)]
        units += [(i, own) for own in members if np.count_nonzero(own) >= settings.min_unit_samples]
    return units
