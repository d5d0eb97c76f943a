"""Channels sampled by separate clocks, merged on the union of their time stamps.

At an instant at which a channel was not sampled, the array of the channel holds a value that is
interpolated linearly between adjacent readings, so that every array is numeric. `Run.read` marks
the values that were sampled. The motion is estimated from sampled values only, and a model is
compared with the force at the instants of the force readings only.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from jbf.arrays import Array, Mask
from jbf.errors import InputError
from jbf.records.checks import MIN_SAMPLES, MOTION, as_array, frozen

Channels = Mapping[str, tuple[npt.ArrayLike, npt.ArrayLike]]

SEPARATE_CLOCK_SHARE = 0.05
"""Smallest share of empty cells for a column to be treated as a channel with a separate clock.

Fewer empty cells are gaps in the file, which the user has to repair.
"""
REQUIRED_COLUMNS = ("friction_n", *MOTION)
"""Columns with at least as many readings as the minimum number of samples of a run."""


def side_by_side(channels: Channels, name: str) -> tuple[dict[str, Array], dict[str, Mask]]:
    """Merge channels with separate clocks on the union of their time stamps.

    The union is limited to the time range of the motion.

    Parameters
    ----------
    channels
        Column name to its instants, s, and its values there, each of shape (n,).
    name
        Name of the run in error messages.

    Returns
    -------
    columns : dict of str to ndarray
        `time_s` and the interpolated columns.
    read : dict of str to ndarray
        Masks of the sampled instants; columns sampled at every instant are omitted.
    """
    clocks, values = {}, {}
    for column, (time_s, given) in channels.items():
        clock = as_array(time_s, f"time_s of {column}", name)
        values[column] = as_array(given, column, name)
        _check_clock(clock, values[column], column, name)
        clocks[column] = clock
    moving = [clocks[column] for column in MOTION if column in clocks]
    if not moving:
        raise InputError(
            file=name,
            column="velocity_m_s",
            problem="is missing, and no position is given",
            remedy=f"give one of {', '.join(MOTION)}",
        )
    first, last = max(c[0] for c in moving), min(c[-1] for c in moving)
    instants = np.unique(np.concatenate(list(clocks.values())))
    instants = instants[(instants >= first) & (instants <= last)]
    columns, read = {"time_s": frozen(instants)}, {}
    for column, clock in clocks.items():
        columns[column] = frozen(np.interp(instants, clock, values[column]))
        sampled = np.isin(instants, clock)
        if not sampled.all():
            read[column] = sampled
    return columns, read


def recorded_samples(time_s: Array, values: Array) -> tuple[Array, Array]:
    """Instants and readings of a column, without missing values if its clock is separate.

    A small number of missing values is kept, so that the later checks reject them.
    """
    finite = np.isfinite(values)
    if finite.all() or np.count_nonzero(~finite) < max(
        MIN_SAMPLES, SEPARATE_CLOCK_SHARE * len(values)
    ):
        return time_s, values
    return time_s[finite], values[finite]


def filled(time_s: Array, values: Array, valid: Mask) -> Array:
    """Return a column with linear interpolation at the samples where `valid` is False."""
    return frozen(np.interp(time_s, time_s[valid], values[valid]))


def of_motion(read: Mapping[str, Mask]) -> Mask | None:
    """Mask of the readings of the most densely sampled motion channel; None if all are complete."""
    masks = [read[column] for column in MOTION if column in read]
    return max(masks, key=lambda mask: int(mask.sum())) if masks else None


def _check_clock(clock: Array, values: Array, column: str, name: str) -> None:
    def wrong(problem: str, remedy: str) -> InputError:
        return InputError(file=name, column=column, problem=problem, remedy=remedy)

    if len(clock) != len(values):
        raise wrong(
            f"has {len(values)} values at {len(clock)} instants", "give one value per instant"
        )
    if column in REQUIRED_COLUMNS and len(clock) < MIN_SAMPLES:
        raise wrong(f"has {len(clock)} readings", f"a run needs at least {MIN_SAMPLES}")
    if not (len(clock) and np.isfinite(clock).all() and np.isfinite(values).all()):
        raise wrong("contains values that are not finite", "remove the missing readings")
    if np.any(np.diff(clock) <= 0.0):
        raise wrong("has a time that repeats or decreases", "sort the readings and remove repeats")
