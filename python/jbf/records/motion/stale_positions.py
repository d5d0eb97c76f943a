"""Held samples of a path: repeated values in motion, followed by a jump to the true position."""

from __future__ import annotations

import numpy as np

from jbf.arrays import Array
from jbf.records.counts import count_of
from jbf.records.findings.finding import Finding
from jbf.records.motion.position import Position
from jbf.records.motion.roughness import step_of

MIN_READINGS = 3
"""Minimum number of consecutive repeated readings; with jitter, two may be nearly simultaneous."""
MIN_COUNTS = 5.0
"""Minimum displacement of the shaft during the held readings, in encoder counts."""
MAX_NEXT_ERROR = 0.3
"""Largest error of the next reading, as a share of the missed displacement."""
MIN_REGULARITY = 0.3
"""Minimum displacement from one held reading to the next, relative to the mean."""
MAX_HELD_SHARE = 0.3
"""Largest share of held readings in a record; more of them are a property of the channel."""


def replace_stale_positions(
    name: str, time: Array, position: Position, speed: Array, mover: str = "the shaft"
) -> tuple[Position, Finding | None]:
    """Replace held readings of the path by the position that follows from the speed."""
    path = position.path_m
    moved = np.concatenate(([0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * np.diff(time))))
    threshold = max(MIN_COUNTS * step_of(path), 1e-9 * float(np.ptp(path)))
    edges = np.diff(np.concatenate(([0], (np.diff(path) == 0.0).astype(np.int8), [0])))
    mended, lasted, count = path.copy(), 0.0, 0
    for first, end in zip(np.flatnonzero(edges == 1), np.flatnonzero(edges == -1), strict=True):
        # Readings first + 1 to end repeat the one at first; end + 1 is a new one.
        if end - first < MIN_READINGS or end + 1 >= len(path):
            continue
        if abs(moved[end] - moved[first]) < threshold:
            continue
        # Accept only motion throughout the held readings, which excludes the ends of a rest.
        each = np.abs(np.diff(moved[first : end + 1]))
        if np.min(each) < MIN_REGULARITY * np.mean(each):
            continue
        missed = moved[end + 1] - moved[first]
        if abs(path[end + 1] - path[first] - missed) > MAX_NEXT_ERROR * abs(missed):
            continue
        stale = slice(first + 1, end + 1)
        share = (path[end + 1] - path[first]) / missed
        mended[stale] = path[first] + share * (moved[stale] - moved[first])
        lasted, count = max(lasted, float(time[end] - time[first])), count + end - first
    if not 0 < count <= MAX_HELD_SHARE * len(path):
        return position, None
    readings = count_of(count, "position reading repeats", "position readings repeat")
    words = f"{readings} the previous value while {mover} moves"
    done = "replaced by the integrated speed"
    finding = Finding("held_samples", position.column, name, lasted, "s", done, words)
    return position.along(mended), finding
