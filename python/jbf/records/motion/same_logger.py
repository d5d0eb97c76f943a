"""Further starting values for runs whose estimated reading errors differ from other runs.

The likelihood of a run may have several maxima. The reading errors are properties of the logger, so
the estimates from other runs are used as further starting values.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from jbf.arrays import Array
from jbf.records.motion.readings import AT_REST, ReadingErrors
from jbf.records.motion.smoothing import Smoothed

MAX_VARIANCE_RATIO = 10.0
"""Ratio of the largest variance to the smallest one up to which runs have the same errors."""
MAX_DELAY_DIFFERENCE = 0.1
"""Difference of the velocity delays up to which runs have the same one, samples."""


def further_starts(motions: Sequence[Smoothed]) -> tuple[ReadingErrors, ...]:
    """Starting values for reading errors from other runs; empty if all runs have the same errors.

    Returns
    -------
    tuple of ReadingErrors
        Errors of the runs with the smallest, the median and the largest value of the quantity that
        differs most between the runs.
    """
    if len(motions) < 2 or min(len(motion.readings.time_s) for motion in motions) < 2:
        return ()
    sizes = np.array([_relative_sizes(motion) for motion in motions])
    determined = np.isfinite(sizes).all(axis=0)
    spread = np.ptp(sizes[:, determined], axis=0)
    if np.max(spread) <= 1.0:
        return ()
    order = np.argsort(sizes[:, determined][:, int(np.argmax(spread))], kind="stable")
    chosen = {int(order[0]), int(order[len(order) // 2]), int(order[-1])}
    return tuple(motions[i].errors for i in sorted(chosen))


def _relative_sizes(motion: Smoothed) -> Array:
    """Log variances of position and velocity, and velocity delay, relative to their tolerances.

    The tolerances are `MAX_VARIANCE_RATIO` and `MAX_DELAY_DIFFERENCE`; nan for a channel that was
    not recorded.
    """
    readings, errors = motion.readings, motion.errors
    step_s = float(np.median(np.diff(readings.time_s)))
    velocity = np.isfinite(readings.velocity) & (readings.velocity_shape > AT_REST)
    recorded = np.array([np.isfinite(readings.position).any(), velocity.any(), True])
    logs = np.log([errors.position_variance, errors.velocity_variance]) / np.log(MAX_VARIANCE_RATIO)
    sizes = np.append(logs, errors.velocity_delay_s / (MAX_DELAY_DIFFERENCE * step_s))
    return np.asarray(np.where(recorded, sizes, np.nan))
