"""Numeric columns of a data frame or table by name, without importing its library."""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from typing import Any

import numpy as np

from jbf.arrays import Array
from jbf.errors import InputError
from jbf.results import optional


def columns_of(frame: object, name: str) -> dict[str, Array]:
    """Return the numeric columns of a table by name; missing values are nan.

    The table is a frame (pandas, polars), an Arrow table, any object that exports Arrow's C stream
    if pyarrow is installed, or a mapping of arrays. An index that is named `time_s` is also a
    column.

    Raises
    ------
    InputError
        The object is not a table with named columns.
    """
    names = _names(frame)
    if names is None and hasattr(frame, "__arrow_c_stream__"):
        frame = _by_arrow(frame, name)
        names = _names(frame)
    if names is None:
        raise InputError(
            file=name,
            problem=f"{type(frame).__name__} has no named columns",
            remedy="give a pandas or polars frame, an Arrow table or a dict of arrays",
        )
    table: Any = frame
    columns = {column: _numbers(table[column]) for column in names}
    index = getattr(frame, "index", None)
    if "time_s" not in columns and getattr(index, "name", None) == "time_s":
        columns = {"time_s": _numbers(index)} | columns
    return {column: values for column, values in columns.items() if values is not None}


def dataset_of_columns(columns: Mapping[str, Array], units: Mapping[str, str], name: str) -> Any:
    """Return columns as an `xarray.Dataset` over the coordinate `time_s`.

    Raises
    ------
    InputError
        xarray is not installed.
    """
    xarray = optional("xarray", "a dataset")
    variables = {
        column: ("time_s", values, {"units": units[column]} if column in units else {})
        for column, values in columns.items()
    }
    return xarray.Dataset(variables, attrs={"name": name}).set_coords("time_s")


def columns_of_dataset(dataset: Any) -> tuple[dict[str, Any], str]:
    """Return the variables of an `xarray.Dataset` over `time_s` by name, and the dataset's name.

    Raises
    ------
    InputError
        The object has no variables by name.
    """
    variables = getattr(dataset, "variables", None)
    if variables is None or not hasattr(dataset, "data_vars"):
        raise InputError(
            problem=f"{type(dataset).__name__} is not an xarray.Dataset",
            remedy="give a Dataset, or a frame to Run.from_frame",
        )
    columns = {str(n): v.to_numpy() for n, v in variables.items() if v.dims == ("time_s",)}
    return columns, str(dataset.attrs.get("name", "run"))


def _names(frame: object) -> list[str] | None:
    """Column names of a table; None if the object has none."""
    if isinstance(frame, Mapping):
        return [str(name) for name in frame]
    for attribute in ("column_names", "columns"):
        names = getattr(frame, attribute, None)
        # The attribute `columns` of pyarrow holds the columns themselves, not their names.
        if names is not None and not callable(names):
            given = list(names)
            if all(isinstance(column, str) for column in given) and hasattr(frame, "__getitem__"):
                return given
    return None


def _by_arrow(frame: object, name: str) -> Any:
    try:
        pyarrow = importlib.import_module("pyarrow")
    except ImportError:
        raise InputError(
            file=name,
            problem=f"{type(frame).__name__} requires pyarrow, which is not installed",
            remedy="pip install pyarrow, or give a frame or a dict of arrays",
        ) from None
    return pyarrow.table(frame)


def _numbers(column: Any) -> Array | None:
    """Values of a column as numbers; None if it contains anything else."""
    if hasattr(column, "to_numpy") and not hasattr(column, "__array__"):
        column = column.to_numpy()
    values = np.asarray(column)
    if values.dtype.kind == "O":
        # Replace nulls among numbers by nan; columns of text and dates are rejected.
        try:
            values = np.array([np.nan if v is None else v for v in values.tolist()])
        except (TypeError, ValueError):
            return None
    if values.dtype.kind not in "biuf":
        return None
    numbers: Array = values.astype(np.float64)
    return numbers
