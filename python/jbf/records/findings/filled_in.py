"""Samples that lie on the straight line between their neighbours: filled in, not read.

A channel with stamps of its own that an export drew onto the rows of another, or onto all instants
of both, has its corners at rows, evenly spaced or not; lost samples that a logger replaced lie so.
Noise puts hardly a sample there: how many it would is told by those that nearly lie there.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from jbf.records.findings.digits import resolution
from jbf.records.findings.interpolated import Native, is_smooth
from jbf.records.motion.roughness import quantum_of

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

LEAST_SHARE, LEAST = 0.02, 10
"""Of the samples: below that nobody filled a channel in; and so many at least."""
BY_CHANCE = 10.0
"""Times as many as chance puts there."""
ROUNDING = 1.05
"""Digits, or steps of a converter, that rounding of three samples puts between one and its line."""
FINE = 0.02
"""What is fine enough to tell a line by, as a share of how far samples beside one are off it."""
CORNERS = 12.0
"""Samples from one on a line to a clear corner, on the whole: a smooth force goes straight on for
longer."""
LONGEST = 50.0
"""Samples a reading on the whole: beyond, the lines are the friction's own."""


def find_filled_in(time: Array, values: Array) -> Native | None:
    """The readings among a channel's samples; None where all are readings."""
    if len(time) < 5:
        return None
    share = (time[1:-1] - time[:-2]) / (time[2:] - time[:-2])
    off = np.abs(values[1:-1] - (1.0 - share) * values[:-2] - share * values[2:])
    rounding = ROUNDING * resolution(values)
    # Of equal samples nobody knows whether they were read: a held channel is another finding.
    level = np.abs(values[2:] - values[:-2]) <= 2.0 * rounding
    line = (off <= rounding) & ~level
    # Where friction itself goes straight on, the samples beside are nearly straight, too.
    beside = (off > rounding) & (np.convolve(line, [1, 0, 1], "same") > 0)
    usual = float(np.median(off[beside])) if np.any(beside) else 0.0
    if usual == 0.0 or rounding > FINE * usual or _far_from_corners(line, off > usual):
        return None
    near = off[(off > rounding) & (off <= usual)]
    # A converter's steps put samples on a line as often as they put them one step off it.
    chance = len(near) / usual * max(quantum_of(values), rounding)
    count = int(line.sum())
    if count < max(LEAST, LEAST_SHARE * len(time), BY_CHANCE * chance):
        return None
    read = np.concatenate(([True], ~line, [True]))
    # Friction that goes on straight lines itself, or a curve, has no noise at its corners.
    if read.sum() * LONGEST < len(time) or is_smooth(values[read]):
        return None
    return Native(time[read], values[read], float(np.median(np.diff(time[read]))))


def _far_from_corners(line: Mask, corner: Mask) -> bool:
    """Whether most samples on lines are far from the nearest corner."""
    if not corner.any() or not line.any():
        return True
    place, corners = np.flatnonzero(line), np.flatnonzero(corner)
    after = np.searchsorted(corners, place)
    left = place - corners[np.maximum(after - 1, 0)]
    right = corners[np.minimum(after, len(corners) - 1)] - place
    distance = np.minimum(np.abs(left), np.abs(right))
    return float(np.median(distance)) > CORNERS
