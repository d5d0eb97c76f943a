"""Interpolated samples on the straight line between their neighbours.

Such samples occur if an export interpolated a channel with separate time stamps at the time stamps
of another channel, or of both. A logger may also interpolate lost samples. The corners of such a
record coincide with rows, at equal or unequal intervals. A sample with noise is rarely on the line
by chance; the expected number is estimated from the samples close to the line.
"""

from __future__ import annotations

import numpy as np

from jbf.arrays import Array, Mask
from jbf.records.findings.digits import resolution
from jbf.records.findings.interpolated import Native, is_smooth
from jbf.records.motion.roughness import quantum_of

LEAST_SHARE, LEAST = 0.02, 10
"""Smallest share and smallest number of interpolated samples for a finding."""
MIN_CHANCE_RATIO = 10.0
"""Minimum ratio of the number of samples on a line to the number expected by chance."""
ROUNDING = 1.05
"""Deviation from the line due to the rounding of three samples, in digits or quantisation steps."""
MAX_ROUNDING = 0.02
"""Largest rounding at which lines are detectable, relative to the deviation of adjacent samples."""
MAX_CORNER_DISTANCE = 12.0
"""Largest median distance from a sample on a line to a significant corner, in samples.

Straight segments of a smooth force are longer.
"""
LONGEST = 50.0
"""Largest ratio of samples to readings; at a larger ratio, the friction itself is linear."""


def find_interpolated_samples(time: Array, values: Array) -> Native | None:
    """Return the original readings of a channel; None if all samples are readings."""
    if len(time) < 5:
        return None
    share = (time[1:-1] - time[:-2]) / (time[2:] - time[:-2])
    deviation = np.abs(values[1:-1] - (1.0 - share) * values[:-2] - share * values[2:])
    rounding = ROUNDING * resolution(values)
    # Equal samples are excluded: a held channel is a separate finding.
    level = np.abs(values[2:] - values[:-2]) <= 2.0 * rounding
    line = (deviation <= rounding) & ~level
    # If the friction itself is linear there, the adjacent samples are also close to a line.
    next_to_line = (deviation > rounding) & (np.convolve(line, [1, 0, 1], "same") > 0)
    typical = float(np.median(deviation[next_to_line])) if np.any(next_to_line) else 0.0
    if (
        typical == 0.0
        or rounding > MAX_ROUNDING * typical
        or _far_from_corners(line, deviation > typical)
    ):
        return None
    small = deviation[(deviation > rounding) & (deviation <= typical)]
    # Quantisation puts samples on a line as often as one step off it.
    chance = len(small) / typical * max(quantum_of(values), rounding)
    count = int(line.sum())
    if count < max(LEAST, LEAST_SHARE * len(time), MIN_CHANCE_RATIO * chance):
        return None
    read = np.concatenate(([True], ~line, [True]))
    # If the friction itself is piecewise linear or a smooth curve, the corners have no noise.
    if read.sum() * LONGEST < len(time) or is_smooth(values[read]):
        return None
    return Native(time[read], values[read], float(np.median(np.diff(time[read]))))


def _far_from_corners(line: Mask, corner: Mask) -> bool:
    """Whether most samples on straight lines are far from the nearest corner."""
    if not corner.any() or not line.any():
        return True
    place, corners = np.flatnonzero(line), np.flatnonzero(corner)
    after = np.searchsorted(corners, place)
    before = place - corners[np.maximum(after - 1, 0)]
    behind = corners[np.minimum(after, len(corners) - 1)] - place
    distance = np.minimum(np.abs(before), np.abs(behind))
    return float(np.median(distance)) > MAX_CORNER_DISTANCE
