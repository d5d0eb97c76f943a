"""MAT files of version 7.3, which are HDF5 with conventions of MATLAB, by h5py."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import h5py
import numpy as np

from jbf.errors import InputError
from jbf.importing.formats.arrays import ArraySource, Slice
from jbf.importing.formats.mat_structures import Samples, Tree, add_structures
from jbf.importing.formats.matlab_tables import add_tables
from jbf.importing.formats.table import Options, Source

_WIDEST = 64
"""Largest number of columns of a matrix of channels; wider matrices are ignored."""
_DEEPEST = 32
"""Largest depth of nested structures, since a file may refer to itself."""


def open_mat73(path: Path, options: Options) -> Source:
    """Open a MAT file of version 7.3 as a source of tables."""
    file = h5py.File(path, "r")
    source = ArraySource(path, file.close)
    variables = {name: item for name, item in file.items() if not name.startswith("#")}
    if any(_is_opaque(item) for item in variables.values()):
        add_tables(source, path)
    add_structures(source, {name: _tree(file, item, 0) for name, item in variables.items()})
    if not source.tables:
        raise InputError(
            file=path, problem="contains no numeric columns", remedy="name another file"
        )
    return source


def _is_opaque(item: Any) -> bool:
    """Whether a variable contains opaque MATLAB objects (such as tables)."""
    if isinstance(item, h5py.Group):
        return any(map(_is_opaque, item.values()))
    return "MATLAB_object_decode" in item.attrs


def _tree(file: Any, item: Any, depth: int) -> Tree:
    """Convert a variable of the file to structures, lists, text and numbers."""
    if depth > _DEEPEST or _is_opaque(item):
        return None
    if isinstance(item, h5py.Group):
        if _is_array_of_structures(item):
            fields = {name: np.ravel(field[()], order="F") for name, field in item.items()}
            count = min(map(len, fields.values()))
            return [
                {name: _tree(file, file[refs[k]], depth + 1) for name, refs in fields.items()}
                for k in range(count)
            ]
        return {name: _tree(file, field, depth + 1) for name, field in item.items()}
    if item.dtype == h5py.ref_dtype:
        return [_tree(file, file[ref], depth + 1) for ref in np.ravel(item[()], order="F") if ref]
    if "MATLAB_empty" in item.attrs:
        return None
    if item.attrs.get("MATLAB_class") == b"char":
        return "".join(map(chr, np.ravel(item[()])))
    if item.dtype.kind not in "biuf":
        return None
    return _samples(item)


def _is_array_of_structures(group: Any) -> bool:
    """Whether an HDF5 group is an array of structures, stored field by field."""
    fields = list(group.values())
    return bool(fields) and all(
        isinstance(field, h5py.Dataset)
        and field.dtype == h5py.ref_dtype
        and "MATLAB_class" not in field.attrs
        for field in fields
    )


def _samples(item: Any) -> Samples | None:
    """Columns of a numeric dataset (MATLAB stores matrices transposed in HDF5)."""
    if item.ndim == 3:
        # The samples of a signal with several elements lie along MATLAB's last dimension.
        width = item.shape[1] * item.shape[2]
        columns = tuple(_element(item, at) for at in range(width))
        return Samples(item.shape[0], columns) if width <= _WIDEST else None
    if item.ndim != 2:
        return None
    width, rows = item.shape
    if rows == 1:
        return Samples(width, (_first_column(item),))
    if width > _WIDEST:
        return None
    return Samples(rows, tuple(_row(item, at) for at in range(width)))


def _row(item: Any, at: int) -> Slice:
    return lambda first, end: item[at, first:end]


def _first_column(item: Any) -> Slice:
    return lambda first, end: item[first:end, 0]


def _element(item: Any, at: int) -> Slice:
    return lambda first, end: np.reshape(item[first:end], (-1, item.shape[1] * item.shape[2]))[
        :, at
    ]
