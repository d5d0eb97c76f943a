"""NumPy: `.npy` (a matrix or records) and `.npz` (arrays by name)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from jbf.errors import InputError
from jbf.importing.formats.arrays import ArraySource, add_by_length, vectors_of
from jbf.importing.formats.table import Options, Source


def open_arrays(path: Path, options: Options) -> Source:
    """Open a file of arrays; nothing in it is run (no pickles)."""
    try:
        # A single array stays on the disk until it is asked for.
        mode: Any = "r" if path.suffix.lower() == ".npy" else None
        content = np.load(path, mmap_mode=mode, allow_pickle=False)
        arrays = {"": content} if isinstance(content, np.ndarray) else dict(content)
    except (OSError, ValueError, EOFError) as error:
        problem = f"is no whole file of arrays ({str(error).splitlines()[0]})"
        raise InputError(file=path, problem=problem, mend="save it anew") from None
    source = ArraySource(path)
    vectors: dict[str, tuple[Any, str]] = {}
    for name, values in arrays.items():
        vectors |= {n: (v, "") for n, v in vectors_of(name, values).items()}
    add_by_length(source, vectors, options)
    return source
