"""MAT files of version 7.3, which are HDF5 with MATLAB's habits, by h5py."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import h5py

from jbf.errors import InputError
from jbf.importing.formats.arrays import ArraySource, Slice
from jbf.importing.formats.matlab_tables import add_tables
from jbf.importing.formats.table import Options, Source


def open_mat73(path: Path, options: Options) -> Source:
    """Open a MAT file: vectors, columns of matrices, fields of structures."""
    file = h5py.File(path, "r")
    source = ArraySource(path, file.close)
    found: dict[int, dict[str, tuple[Slice, str]]] = {}
    opaque = _collect(file, "", found)
    if opaque:
        add_tables(source, path)
    for length, columns in found.items():
        source.add(f"{length} samples" if len(found) > 1 else "", columns, length)
    if not source.tables:
        raise InputError(file=path, problem="holds no columns of numbers", mend="name another")
    return source


def _collect(group: Any, lead: str, found: dict[int, dict[str, tuple[Slice, str]]]) -> bool:
    """Gather vectors by length; says whether MATLAB's own objects are among them."""
    opaque = False
    for name, item in group.items():
        if name.startswith("#"):
            continue
        whole = f"{lead}{name}"
        if "MATLAB_object_decode" in item.attrs:
            opaque = True
        elif isinstance(item, h5py.Group):
            opaque |= _collect(item, f"{whole}.", found)
        elif (
            item.dtype.kind in "biuf"
            and item.ndim == 2
            and item.attrs.get("MATLAB_class") != b"char"
        ):
            # MATLAB's columns are HDF5's rows.
            rows, width = item.shape[1], item.shape[0]
            if rows == 1:
                rows, width = width, 1
                found.setdefault(rows, {})[whole] = (_first_column(item), "")
            elif width <= 64:
                for at in range(width):
                    called = whole if width == 1 else f"{whole} column {at + 1}"
                    found.setdefault(rows, {})[called] = (_row(item, at), "")
    found.pop(1, None)
    return opaque


def _row(item: Any, at: int) -> Slice:
    return lambda first, end: item[at, first:end]


def _first_column(item: Any) -> Slice:
    return lambda first, end: item[first:end, 0]
