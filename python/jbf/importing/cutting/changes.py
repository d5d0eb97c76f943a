"""Cuts where the value of a column changes, such as a set point or a run number."""

from __future__ import annotations

import math

import numpy as np

from jbf.importing.cutting.piece import Cut
from jbf.importing.spool import Stream


def cut_at_changes(stream: Stream, column: str, why: str) -> list[Cut]:
    """Cuts at each change of value of a column; a missing value counts as the value before it."""
    at = stream.columns.index(column)
    cuts: list[Cut] = []
    for segment, (first, end) in enumerate(stream.segments):
        before, before_s = math.nan, math.nan
        for block in stream.blocks(first, end):
            finite = np.isfinite(block[:, at])
            times, values = block[finite, 0], block[finite, at]
            if not len(values):
                continue
            previous = np.concatenate(([before], values[:-1]))
            ago = np.concatenate(([before_s], times[:-1]))
            for i in np.flatnonzero((values != previous) & ~np.isnan(previous)):
                cuts.append(Cut(segment, float(ago[i]), float(times[i]), why))
            before, before_s = float(values[-1]), float(times[-1])
    return cuts
