"""Runs of one logger have the same reading errors: where estimates differ, others are tried.

The likelihood of a run may have several maxima. The errors of the readings belong to the logger, so
those that were estimated from other runs are further starts.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from jbf.records.motion.readings import AT_REST, ReadingErrors
from jbf.records.motion.smoothing import Smoothed

Array = npt.NDArray[np.float64]

SAME = 10.0
"""Ratio of the largest variance to the smallest one up to which runs have the same errors."""
SAME_DELAY = 0.1
"""Difference of the velocity's delays up to which they are the same, samples."""


def further_starts(motions: Sequence[Smoothed]) -> tuple[ReadingErrors, ...]:
    """Errors from which the estimation of each of these motions may start; none where all runs have
    the same errors.

    Returns
    -------
    tuple of ReadingErrors
        Those of the runs with the least, the median and the largest error of the velocity.
    """
    sizes = np.array([_sizes(motion) for motion in motions])
    if len(sizes) < 2 or len(motions[0].readings.time_s) < 2:
        return ()
    step_s = float(np.median(np.diff(motions[0].readings.time_s)))
    delays = [motion.errors.velocity_delay_s for motion in motions]
    spread = np.ptp(sizes, axis=0)
    if np.max(spread) <= np.log(SAME) and np.ptp(delays) <= SAME_DELAY * step_s:
        return ()
    order = np.argsort(sizes[:, int(np.argmax(spread))])
    chosen = {int(order[0]), int(order[len(order) // 2]), int(order[-1])}
    return tuple(motions[i].errors for i in sorted(chosen))


def _sizes(motion: Smoothed) -> Array:
    """Logarithms of the variances of position and velocity; zero of one that was not read."""
    readings, errors = motion.readings, motion.errors
    velocity = np.isfinite(readings.velocity) & (readings.velocity_shape > AT_REST)
    seen = [np.isfinite(readings.position).any(), velocity.any()]
    sizes: Array = np.where(seen, np.log([errors.position, errors.velocity]), 0.0)
    return sizes
