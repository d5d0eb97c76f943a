"""Outliers among the first and last samples of a channel.

Examples are the first samples before a converter is ready, and the last samples of a buffer that
was not full. An outlier within a record is detected from the adjacent samples on both sides; at an
end, there are adjacent samples on one side only. A sample at an end is an outlier if its deviation
from the adjacent samples exceeds the largest deviation within the record by the factor `MIN_RATIO`.
"""

from __future__ import annotations

import numpy as np

from jbf.arrays import Array, Mask
from jbf.records.findings.finding import Finding
from jbf.records.lagrange import weights_at_zero

MAX_OUTLIERS = 3
"""Largest number of outliers at each end."""
MIN_RATIO = 4.0
"""Threshold for the deviation of an end sample, relative to the largest one of inner samples."""
LEAST_SAMPLES = 60


def end_outliers(time: Array, values: Array, neighbours: int) -> Mask:
    """Detect outliers among the first and last samples.

    Parameters
    ----------
    neighbours
        Number of adjacent samples that predict a sample: one for a constant, three for a parabola.
    """
    mask = np.zeros(len(values), dtype=bool)
    if len(values) < max(LEAST_SAMPLES, 2 * MAX_OUTLIERS + 2 * neighbours):
        return mask
    mask[: _count_outliers(time, values, neighbours)] = True
    mask[len(values) - _count_outliers(time[::-1], values[::-1], neighbours) :] = True
    return mask


def _count_outliers(time: Array, values: Array, neighbours: int) -> int:
    """Number of outliers at the beginning of a channel."""
    n = len(values) - neighbours
    t = np.stack([time[k : n + k] - time[:n] for k in range(1, neighbours + 1)])
    y = np.stack([values[k : n + k] - values[:n] for k in range(1, neighbours + 1)])
    deviation = np.abs(np.sum(weights_at_zero(t) * y, axis=0))
    within = float(np.max(deviation[MAX_OUTLIERS : n - MAX_OUTLIERS]))
    outliers = np.flatnonzero(deviation[:MAX_OUTLIERS] > MIN_RATIO * within)
    # If the deviation of all inner samples is zero, there is no scale for the threshold.
    return int(outliers[-1]) + 1 if within > 0.0 and len(outliers) else 0


def ends_finding(
    channel: str, what: str, run: str, mask: Mask, error: Array, unit: str, done: str
) -> Finding | None:
    """Finding for outliers at the ends of a channel; None without outliers.

    `error` has the deviations of the samples, `mask` is True at the outliers, and `done` is the
    action taken.
    """
    if not mask.any():
        return None
    half = len(mask) // 2
    sides = [
        f"the {word} sample" if np.sum(part) == 1 else f"the {word} {np.sum(part)} samples"
        for word, part in (("first", mask[:half]), ("last", mask[half:]))
        if part.any()
    ]
    size = float(np.max(np.abs(error[mask])))
    words = f"outliers in the {what}: {' and '.join(sides)}, up to {size:.3g} {unit}"
    return Finding("glitches", channel, run, size, unit, done, words)
