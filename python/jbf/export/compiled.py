"""Run exported C code along the motions of a reference."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
import tempfile
from pathlib import Path

import numpy as np

from jbf.arrays import Array
from jbf.errors import InputError
from jbf.export.reference import Reference
from jbf.export.target import STEM

OPTIONS = ("-std=c99", "-O2", "-ffp-contract=off", "-shared", "-fPIC")
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


PROBE = "#include <math.h>\n\ndouble probe(double x) {\n  return sin(x);\n}\n"
"""Program that every C compiler accepts."""


class NoCompiler(Exception):
    """Error without a C compiler that works."""


def run_c(
    source: str, header: str, prefix: str, precision: str, reference: Reference
) -> list[Array]:
    """Compile C code and return its force along the motion of each run, shape (n,).

    Raises
    ------
    NoCompiler
        There is no compiler, or it fails with any program.
    InputError
        The compiler works and refuses the code.
    """
    compiler = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
    if compiler is None:
        raise NoCompiler
    with tempfile.TemporaryDirectory(prefix="jbf-export-", ignore_cleanup_errors=True) as name:
        folder = Path(name)
        code = f"{source.replace(STEM, 'model')}\n{_state_bytes(prefix)}"
        (folder / "model.h").write_text(header, encoding="utf-8")
        errors = _compile(compiler, folder, "model", code)
        if errors is not None:
            if _compile(compiler, folder, "probe", PROBE) is not None:
                raise NoCompiler
            raise InputError(
                problem=f"the C compiler {compiler} refuses the exported code: {errors}",
                remedy="export on a machine with another compiler, and report the message",
            )
        try:
            loaded = ctypes.CDLL(str(folder / "model.so"))
        except OSError:
            raise NoCompiler from None
        return [_along(loaded, prefix, precision, reference, i) for i in range(len(reference.runs))]


def _state_bytes(prefix: str) -> str:
    """C function that returns the size of the state."""
    return (
        f"unsigned long {prefix}_state_bytes(void);\n"
        f"unsigned long {prefix}_state_bytes(void) {{\n"
        f"  return (unsigned long)sizeof({prefix}_state);\n}}\n"
    )


def _compile(compiler: str, folder: Path, name: str, source: str) -> str | None:
    """Compile a C file to a shared library; return the first error, None if it succeeds."""
    (folder / f"{name}.c").write_text(source, encoding="utf-8")
    command = [compiler, *OPTIONS, f"{name}.c", "-lm", "-o", str(folder / f"{name}.so")]
    done = subprocess.run(
        command, cwd=folder, capture_output=True, text=True, errors="replace", check=False
    )
    if done.returncode == 0:
        return None
    lines = [line.strip() for line in done.stderr.splitlines() if line.strip()]
    first = next((line for line in lines if "error" in line.lower()), None)
    return first or (lines[0] if lines else f"exit status {done.returncode}")


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
    size = getattr(library, f"{prefix}_state_bytes")
    size.restype = ctypes.c_ulong
    state = ctypes.create_string_buffer(size())
    force = np.empty(len(rows))
    address, width = rows.ctypes.data, rows.strides[0]
    for k in range(len(rows)):
        call = step if k else start
        force[k] = call(ctypes.byref(state), ctypes.c_void_p(address + k * width))
    return motion.at_samples(force)
