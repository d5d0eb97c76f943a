"""Independent units of paired comparisons: the runs, or their strokes where there are few runs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt

from jbf.estimation.prepared import Prepared

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]
Strokes = npt.NDArray[np.intp]
Units = list[tuple[int, Mask]]
"""Index of a run, and a mask of those of its counting samples that belong to the unit."""

LEAST_UNITS = 6
"""Smallest number of independent units for a paired test over them."""
LEAST_SAMPLES = 16
"""Smallest number of samples of a stroke that counts as a unit."""


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


def independent_units(counted: Mapping[int, Mask], prepared: Sequence[Prepared]) -> Units:
    """Divide samples into units: runs, or strokes where there are fewer than `LEAST_UNITS` runs.

    Parameters
    ----------
    counted
        Samples that count, by the index of the run.
    prepared
        All runs; without them, the runs are the units.
    """
    runs = {i: mask for i, mask in counted.items() if mask.any()}
    if len(runs) >= LEAST_UNITS or not prepared:
        return [(i, np.ones(np.count_nonzero(mask), dtype=bool)) for i, mask in runs.items()]
    units = []
    for i, mask in runs.items():
        stroke = stroke_of(prepared[i])[mask]
        members = [stroke == k for k in range(int(np.max(stroke, initial=-1)) + 1)]
        units += [(i, own) for own in members if np.count_nonzero(own) >= LEAST_SAMPLES]
    return units
