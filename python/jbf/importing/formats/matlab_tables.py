"""MATLAB tables and timetables, read by mat-io since SciPy and HDF5 cannot."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from jbf.errors import InputError
from jbf.importing.formats.arrays import ArraySource, slices
from jbf.importing.formats.table import library_errors


def add_tables(source: ArraySource, path: Path) -> None:
    """Add every MATLAB table of a file to a source.

    Raises
    ------
    InputError
        If mat-io is not installed, or cannot read the file.
    """
    try:
        from matio import load_from_mat
    except ModuleNotFoundError:
        raise InputError(
            file=path,
            problem="contains a MATLAB table or timetable, which requires mat-io; "
            "mat-io is not installed",
            remedy="pip install 'jbf[timetable]' (Python 3.11 or later), or save plain vectors",
        ) from None
    with library_errors(path, "cannot be read by mat-io"):
        content = load_from_mat(str(path))
    for name, value in content.items():
        if hasattr(value, "columns") and hasattr(value, "index"):
            _add_frame(source, name, value)


def _add_frame(source: ArraySource, name: str, frame: Any) -> None:
    """Add a MATLAB table, given as a pandas frame; the index of a timetable is its time."""
    columns: dict[str, tuple[Any, str]] = {}
    clock = None
    index = frame.index.to_numpy()
    if index.dtype.kind in "mM":
        clock = str(frame.index.name or "Time")
        if index.dtype.kind == "m":
            time = index.astype("timedelta64[ns]").astype(np.int64) / 1e9
            columns[clock] = (slices(time), "s")
        else:
            columns[clock] = (slices(index), "")
    units = getattr(frame, "attrs", {}).get("VariableUnits", [])
    for at, column in enumerate(frame.columns):
        values = np.asarray(frame[column].to_numpy())
        if values.dtype == object and len(values) and np.ndim(values[0]) == 1:
            values = np.array([np.ravel(v)[0] for v in values])
        unit = str(units[at]) if len(units) == len(frame.columns) else ""
        columns[str(column)] = (slices(values), unit)
    source.add(name, columns, len(frame), clock)
