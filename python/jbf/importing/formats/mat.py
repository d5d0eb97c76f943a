"""MAT files up to version 7, by scipy; tables and timetables in them by mat-io, where it is."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from jbf.importing.formats.arrays import ArraySource, add_by_length, vectors_of
from jbf.importing.formats.matlab_tables import add_tables
from jbf.importing.formats.table import Options, Source


def open_mat(path: Path, options: Options) -> Source:
    """Open a MAT file: vectors, columns of matrices, fields of structures."""
    from scipy.io import loadmat
    from scipy.io.matlab import MatlabOpaque

    content = loadmat(path, struct_as_record=False, squeeze_me=False)
    vectors: dict[str, tuple[Any, str]] = {}
    opaque = False
    for name, value in content.items():
        if isinstance(value, MatlabOpaque):
            opaque = True
        elif not name.startswith("__"):
            _collect(name, value, vectors)
    source = ArraySource(path)
    if opaque:
        add_tables(source, path)
    if vectors or not source.tables:
        add_by_length(source, vectors, options)
    return source


def _collect(name: str, value: Any, vectors: dict[str, tuple[Any, str]]) -> None:
    fields = getattr(value, "_fieldnames", None)
    if fields is not None:
        for field in fields:
            _collect(f"{name}.{field}", getattr(value, field), vectors)
        return
    array = np.asarray(value)
    if array.dtype == object:
        # A structure stands in an array of one.
        if array.size == 1:
            _collect(name, array.reshape(-1)[0], vectors)
        return
    if array.dtype.kind in "biuf" and array.size > 1:
        vectors |= {n: (v, "") for n, v in vectors_of(name, array).items()}
