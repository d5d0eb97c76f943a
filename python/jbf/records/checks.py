"""Checks of the columns of a run, for arrays and for files."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from pathlib import Path
from textwrap import shorten
from typing import Any

import numpy as np
import numpy.typing as npt

from jbf.arrays import Array
from jbf.errors import InputError, quoted
from jbf.records.angles import continuous
from jbf.records.counts import count_of

MIN_SAMPLES = 10
COLUMNS = (
    "time_s",
    "angle_rad",
    "position_m",
    "velocity_m_s",
    "friction_n",
    "load_n",
    "temperature_c",
)
"""Columns with a defined meaning, in the order in which `Run.write_csv` writes them."""
UNITS = {
    "time_s": "s",
    "angle_rad": "rad",
    "position_m": "m",
    "load_n": "N",
    "temperature_c": "degC",
}
"""Units of the columns that do not depend on the rig."""
ATTRIBUTES = {"velocity_m_s": "velocity", "friction_n": "friction"}
"""Attributes of `Run`, by column, for quantities whose unit depends on the rig."""
POINT = "point"
"""Column that replaces `time_s`: the number of a steady state, as in a Stribeck curve."""
POINT_S = 60.0
"""Nominal spacing of steady states on the time axis of a run, s."""
SLOW = "temperature_c"
"""Column that may have missing values."""
LARGEST = 1e12
"""Largest plausible absolute value of a known column in SI units.

A larger value indicates a corrupt cell or a wrong unit (nanoseconds since 1970). Sums of fourth
powers stay finite up to this limit.
"""
SHORTEST_S = 1e-12
"""Shortest plausible time step between samples, s."""
ANGLES = ("angle_rad", "weight_angle_rad")
"""Columns that may restart at each turn."""
MOTION = ("velocity_m_s", "position_m", "angle_rad")
"""Columns that define the motion; one of them is sufficient."""


def attribute(column: str) -> str:
    """Name of the attribute of `Run` that holds a column of `COLUMNS`."""
    return ATTRIBUTES.get(column, column)


def listed(names: Iterable[str]) -> str:
    """Return the non-empty names as a list for a message, truncated to 160 characters."""
    return shorten(", ".join(name for name in names if name), 160, placeholder=" ...")


def frozen(values: npt.ArrayLike) -> Array:
    """Return a read-only copy of an array as `float64`."""
    array = np.array(values, dtype=np.float64, order="C")
    array.flags.writeable = False
    return array


def unwrapped(column: str, values: Array) -> Array:
    """Return the values of a column, without the jumps of an angle that restarts at each turn."""
    return continuous(values) if column in ANGLES else values


def as_array(values: npt.ArrayLike, column: str, name: str) -> Array:
    """Return a column as a read-only array, or raise `InputError` with the name of its run."""

    def wrong(problem: str) -> InputError:
        return InputError(
            file=name,
            column=column,
            problem=problem,
            remedy="give one number per sample, shape (N,)",
        )

    items = values if isinstance(values, list | tuple) else ()
    if np.ma.is_masked(values) or any(x is np.ma.masked for x in items):
        raise InputError(
            file=name,
            column=column,
            problem="has masked samples",
            remedy="remove them, or give Run.from_channels the readings with their instants",
        )
    try:
        array = np.asarray(values)
        # Text, dates and complex numbers would be converted to values that the user did not intend.
        if array.dtype.kind not in "biufO":
            raise wrong(f"has dtype {array.dtype}, not numbers")
        if array.dtype.kind == "O":
            text = [x for x in array.flat if isinstance(x, str | bytes)]
            if text:
                raise wrong(f"contains the text {quoted(text[0])}, not numbers")
        array = frozen(array)
    except InputError:
        raise
    except (TypeError, ValueError, OverflowError):
        raise wrong("is not an array of numbers") from None
    if array.ndim != 1:
        raise wrong(f"has shape {array.shape}")
    return array


def check_columns(
    name: str,
    columns: Mapping[str, Array],
    path: Path | None,
    rows: Sequence[int] | None,
    standard: Collection[str] = COLUMNS,
) -> None:
    """Raise an InputError if a column does not hold valid values for its name.

    Parameters
    ----------
    name
        Name of the run in error messages, when no file is known.
    columns
        Column name to values.
    path, rows
        The file that the columns were read from, and the line of each sample in it.
    standard
        Columns with a defined meaning, whose values must be plausible for a machine.
    """
    file = path if rows is not None and path is not None else name

    def wrong(column: str, index: int, problem: str, remedy: str) -> InputError:
        if rows is None:
            return InputError(
                file=file, column=column, problem=f"sample {index}: {problem}", remedy=remedy
            )
        return InputError(file=file, row=rows[index], column=column, problem=problem, remedy=remedy)

    samples = len(columns["time_s"])
    if samples < MIN_SAMPLES:
        raise InputError(
            file=file,
            problem=f"has {count_of(samples, 'sample')}",
            remedy=f"a run needs at least {MIN_SAMPLES}",
        )
    for column, values in columns.items():
        if len(values) != samples:
            raise InputError(
                file=file,
                column=column,
                problem=f"has {count_of(len(values), 'sample')} where time_s has {samples}",
                remedy="give every column one value per sample",
            )
        bad = np.flatnonzero(~np.isfinite(values))
        if column == SLOW and np.isfinite(values).any():
            # The temperature may be sampled more slowly; its gaps are interpolated linearly later.
            bad = np.flatnonzero(np.isinf(values))
        if bad.size:
            raise wrong(
                column,
                int(bad[0]),
                f"{values[bad[0]]} is not a finite number",
                "correct the cell or remove the row",
            )
        bad = np.flatnonzero(np.abs(values) > LARGEST) if column in standard else bad
        if bad.size:
            raise wrong(
                column,
                int(bad[0]),
                f"{values[bad[0]]} is not plausible",
                "correct the cell or the unit",
            )
    time_s = columns["time_s"]
    bad = np.flatnonzero(np.diff(time_s) <= 0.0)
    if bad.size:
        before, now = float(time_s[bad[0]]), float(time_s[bad[0] + 1])
        raise wrong(
            "time_s",
            int(bad[0]) + 1,
            f"time repeats at {now}" if now == before else f"time decreases from {before} to {now}",
            "sort the rows and remove repeats; one file is one run",
        )
    bad = np.flatnonzero(np.diff(time_s) < SHORTEST_S)
    if bad.size:
        raise wrong(
            "time_s",
            int(bad[0]) + 1,
            f"a time step of {time_s[bad[0] + 1] - time_s[bad[0]]} s is not plausible",
            "give the time in seconds",
        )
    if "load_n" in columns:
        bad = np.flatnonzero(columns["load_n"] <= 0.0)
        if bad.size:
            raise wrong(
                "load_n",
                int(bad[0]),
                f"a load of {columns['load_n'][bad[0]]} N is not above zero",
                "correct the cell or remove the row",
            )


def selection(selector: slice | npt.ArrayLike, count: int, name: str) -> Any:
    """Check a selector of samples: a slice, or a boolean mask of shape (count,), and return it.

    Raises
    ------
    InputError
        The mask is not boolean or not of shape (count,), or the slice runs backwards.
    """
    if isinstance(selector, slice):
        if selector.step is not None and selector.step < 1:
            raise InputError(
                file=name,
                problem="a selection cannot be reversed",
                remedy="use a step > 0",
            )
        return selector
    index = np.asarray(selector)
    if np.ma.is_masked(selector) or index.dtype != np.bool_ or index.shape != (count,):
        raise InputError(
            file=name,
            problem=f"a mask of {index.dtype} and shape {index.shape} cannot select",
            remedy=f"give a slice or a boolean mask of shape ({count},)",
        )
    return index
