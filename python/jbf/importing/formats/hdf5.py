"""HDF5 files, by h5py: vectors of one group and length form a table, as do records."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import h5py
import numpy as np

from jbf.errors import InputError
from jbf.importing.formats.arrays import ArraySource, Slice
from jbf.importing.formats.table import Options, Source

_UNITS = ("unit", "units", "Unit", "Units", "UNIT", "UNITS")
_NAMES = ("columns", "names", "column_names", "channels")
_WIDEST = 64


def open_hdf5(path: Path, options: Options) -> Source:
    """Open an HDF5 file as a source of tables."""
    file = h5py.File(path, "r")
    source = ArraySource(path, file.close)
    groups: dict[tuple[str, int], dict[str, tuple[Slice, str]]] = {}

    def visit(name: str, item: Any) -> None:
        if isinstance(item, h5py.Dataset) and item.ndim in (1, 2) and item.shape[0] > 1:
            parent, _, item_name = name.rpartition("/")
            for column, entry in _columns(item_name, item).items():
                groups.setdefault((parent, item.shape[0]), {})[column] = entry

    file.visititems(visit)
    parents = [parent for parent, _ in groups]
    for (parent, length), columns in groups.items():
        name = parent if parents.count(parent) == 1 else f"{parent} {length} samples".strip()
        source.add(name if len(groups) > 1 else "", columns, length)
    if not source.tables:
        raise InputError(
            file=path, problem="contains no numeric columns", remedy="name another file"
        )
    return source


def _columns(name: str, item: Any) -> dict[str, tuple[Slice, str]]:
    unit = next((_text(item.attrs[key]) for key in _UNITS if key in item.attrs), "")
    if item.dtype.names:
        return {
            field: (_field(item, field), "")
            for field in item.dtype.names
            if item.dtype[field].shape == ()
        }
    if item.dtype.kind not in "biuf":
        return {}
    if item.ndim == 1:
        return {name: (lambda first, end: item[first:end], unit)}
    if item.shape[1] > _WIDEST:
        return {}
    attribute = next((item.attrs[key] for key in _NAMES if key in item.attrs), ())
    names = [_text(word) for word in np.ravel(attribute)]
    if len(names) != item.shape[1]:
        names = [f"{name} column {i + 1}" for i in range(item.shape[1])]
    return {called: (_at(item, i), "") for i, called in enumerate(names)}


def _field(item: Any, field: str) -> Slice:
    return lambda first, end: item[first:end][field]


def _at(item: Any, column: int) -> Slice:
    return lambda first, end: item[first:end, column]


def _text(value: Any) -> str:
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else str(value)
