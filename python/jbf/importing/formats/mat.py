"""MAT files up to version 7, read by SciPy; tables in them by mat-io, if installed."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from jbf.errors import InputError
from jbf.importing.formats.arrays import ArraySource, slices, vectors_of
from jbf.importing.formats.mat_structures import Samples, Tree, add_structures
from jbf.importing.formats.matlab_tables import add_tables
from jbf.importing.formats.table import Options, Source


def open_mat(path: Path, options: Options) -> Source:
    """Open a MAT file up to version 7 as a source of tables."""
    from scipy.io import loadmat
    from scipy.io.matlab import MatlabOpaque

    content = loadmat(path, struct_as_record=False, squeeze_me=False)
    opaque = any(isinstance(value, MatlabOpaque) for value in content.values())
    source = ArraySource(path)
    if opaque:
        add_tables(source, path)
    variables = {name: _tree(v) for name, v in content.items() if not name.startswith("__")}
    add_structures(source, variables)
    if not source.tables:
        raise InputError(
            file=path, problem="contains no numeric columns", remedy="name another file"
        )
    return source


def _tree(value: Any) -> Tree:
    """Convert a variable of SciPy to structures, lists, text and numbers."""
    fields = getattr(value, "_fieldnames", None)
    if fields is not None:
        return {field: _tree(getattr(value, field)) for field in fields}
    array = np.asarray(value)
    if array.dtype == object:
        # A structure is stored in an array of one element.
        items = [_tree(item) for item in array.reshape(-1)]
        return items[0] if len(items) == 1 else items
    if array.dtype.kind == "U":
        return str(array.reshape(-1)[0]) if array.size == 1 else ""
    if array.dtype.kind not in "biuf" or array.size < 2:
        return None
    if array.ndim == 3:
        # The samples of a signal with several elements lie along the last dimension.
        array = array.reshape(-1, array.shape[2], order="F").T
    columns = list(vectors_of("", array).values())
    return Samples(len(columns[0]), tuple(map(slices, columns))) if columns else None
