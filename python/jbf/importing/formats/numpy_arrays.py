"""NumPy files: `.npy` (a matrix or records) and `.npz` (named arrays)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from jbf.importing.formats.arrays import ArraySource, add_by_length, vectors_of
from jbf.importing.formats.table import Options, Source


def open_arrays(path: Path, options: Options) -> Source:
    """Open a NumPy file as a source of tables; pickles are not loaded, so that no code is run."""
    with path.open("rb") as file:
        single_array = file.read(6) == b"\x93NUMPY"
    # A single array remains on the disk until it is read.
    content: Any = np.load(path, mmap_mode="r" if single_array else None, allow_pickle=False)
    arrays = {"": content} if single_array else dict(content)
    source = ArraySource(path)
    vectors: dict[str, tuple[Any, str]] = {}
    for name, values in arrays.items():
        vectors |= {n: (v, "") for n, v in vectors_of(name, values).items()}
    add_by_length(source, vectors, options)
    return source
