"""Channels that were read by clocks of their own: side by side at all instants of all of them.

At an instant at which a channel was not read its array holds the straight line between its
readings, so that every array is one of numbers; `Run.read` says which values were read. The motion
is estimated from readings alone, and a model is compared at the readings of the force alone.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from jbf.errors import InputError
from jbf.records.checks import MIN_SAMPLES, MOTION, as_array, frozen

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]
Channels = Mapping[str, tuple[npt.ArrayLike, npt.ArrayLike]]

OWN_CLOCK = 0.05
"""Share of a column's cells that must be empty for it to have a clock of its own: fewer are gaps in
a file, to be mended there."""
ALONE = ("friction_n", *MOTION)
"""Columns that need as many readings as a run."""


def side_by_side(channels: Channels, name: str) -> tuple[dict[str, Array], dict[str, Mask]]:
    """Columns at the instants of all channels while the motion lasts, and where each was read;
    those that were read everywhere are not in the second.

    Parameters
    ----------
    channels
        Column name to its instants, s, and its values there, each of shape (n,).
    name
        What an error calls the run.
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
            problem="is missing, and no position tells the motion",
            mend=f"give one of {', '.join(MOTION)}",
        )
    first, last = max(c[0] for c in moving), min(c[-1] for c in moving)
    instants = np.unique(np.concatenate(list(clocks.values())))
    instants = instants[(instants >= first) & (instants <= last)]
    columns, read = {"time_s": frozen(instants)}, {}
    for column, clock in clocks.items():
        columns[column] = frozen(np.interp(instants, clock, values[column]))
        there = np.isin(instants, clock)
        if not there.all():
            read[column] = there
    return columns, read


def with_own_clock(time_s: Array, values: Array) -> tuple[Array, Array]:
    """The instants and readings of a column, without what is missing where that is a clock's; a
    few missing ones are left to be refused."""
    there = np.isfinite(values)
    if there.all() or np.count_nonzero(~there) < max(MIN_SAMPLES, OWN_CLOCK * len(values)):
        return time_s, values
    return time_s[there], values[there]


def filled(time_s: Array, values: Array, there: Mask) -> Array:
    """A column with straight lines where it was not read."""
    return frozen(np.interp(time_s, time_s[there], values[there]))


def of_motion(read: Mapping[str, Mask]) -> Mask | None:
    """Where the motion was read: at the instants of its quickest channel; None where everywhere."""
    masks = [read[column] for column in MOTION if column in read]
    return max(masks, key=lambda mask: int(mask.sum())) if masks else None


def _check_clock(clock: Array, values: Array, column: str, name: str) -> None:
    def wrong(problem: str, mend: str) -> InputError:
        return InputError(file=name, column=column, problem=problem, mend=mend)

    if len(clock) != len(values):
        raise wrong(f"has {len(values)} values at {len(clock)} instants", "give one a reading")
    if column in ALONE and len(clock) < MIN_SAMPLES:
        raise wrong(f"has {len(clock)} readings", f"a run needs at least {MIN_SAMPLES}")
    if not (len(clock) and np.isfinite(clock).all() and np.isfinite(values).all()):
        raise wrong("is not all finite numbers", "leave out what was not read")
    if np.any(np.diff(clock) <= 0.0):
        raise wrong("has a time that repeats or runs back", "sort its readings and drop repeats")
