"""Run exported C code along the motions of a reference."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
import tempfile
from pathlib import Path

import numpy as np
import numpy.typing as npt

from jbf.export.reference import Reference
from jbf.export.target import STEM

Array = npt.NDArray[np.float64]
OPTIONS = ("-std=c99", "-O2", "-ffp-contract=off", "-shared", "-fPIC")
STATE_BYTES = 4096
COLUMNS = (
    "time_s",
    "velocity",
    "acceleration",
    "angle_rad",
    "weight_offset_rad",
    "load_n",
    "temperature_c",
)
"""Columns of a motion in the order of the C structure."""


class NoCompiler(Exception):
    """Error without a C compiler that works."""


def run_c(
    source: str, header: str, prefix: str, precision: str, reference: Reference
) -> list[Array]:
    """Compile C code and return its force along the motion of each run, shape (n,).

    Raises
    ------
    NoCompiler
        There is no compiler, or it failed.
    """
    compiler = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
    if compiler is None:
        raise NoCompiler
    with tempfile.TemporaryDirectory(prefix="jbf-export-", ignore_cleanup_errors=True) as name:
        folder = Path(name)
        (folder / "model.c").write_text(source.replace(STEM, "model"), encoding="utf-8")
        (folder / "model.h").write_text(header, encoding="utf-8")
        library = folder / "model.so"
        command = [compiler, *OPTIONS, "model.c", "-lm", "-o", str(library)]
        done = subprocess.run(command, cwd=folder, capture_output=True, check=False)
        if done.returncode != 0:
            raise NoCompiler
        try:
            loaded = ctypes.CDLL(str(library))
        except OSError:
            raise NoCompiler from None
        return [_along(loaded, prefix, precision, reference, i) for i in range(len(reference.runs))]


def _along(
    library: ctypes.CDLL, prefix: str, precision: str, reference: Reference, index: int
) -> Array:
    """Force along one motion."""
    real = ctypes.c_double if precision == "double" else ctypes.c_float
    start, step = (getattr(library, f"{prefix}_{name}") for name in ("start", "step"))
    start.restype = step.restype = real
    motion = reference.motions[index]
    columns = motion.motion.columns
    zero = np.zeros(len(columns["time_s"]))
    kind = np.float64 if precision == "double" else np.float32
    layout = [(name, np.float64 if name == "time_s" else kind) for name in COLUMNS]
    rows = np.zeros(len(zero), np.dtype(layout, align=True))
    for name in COLUMNS:
        rows[name] = columns.get(name, zero)
    state = ctypes.create_string_buffer(STATE_BYTES)
    force = np.empty(len(rows))
    address, width = rows.ctypes.data, rows.strides[0]
    for k in range(len(rows)):
        call = step if k else start
        force[k] = call(ctypes.byref(state), ctypes.c_void_p(address + k * width))
    return motion.at_samples(force)
