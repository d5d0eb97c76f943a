"""Trace exports of controllers: a block of times and values for each variable, one after the other.

CODESYS and the systems made of it (Machine Expert, ctrlX, e!COCKPIT) write `0.Variable; NAME`, more
lines about the variable, and then its samples, `; time; value`.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np
import numpy.typing as npt

from jbf.errors import InputError
from jbf.importing.formats.arrays import ArraySource, slices
from jbf.importing.formats.table import Source, unique

Array = npt.NDArray[np.float64]
VARIABLE = re.compile(r"^\s*\d+\.Variable\s*[;,\t]\s*(?P<name>[^;,\t]+?)\s*[;,\t]?\s*$", re.I)
_SAMPLE = re.compile(r"^\s*[;,\t]\s*(?P<time>[^;\t]+?)\s*[;\t,]\s*(?P<value>[^;\t]+?)\s*[;\t]?\s*$")


def is_trace(lines: Iterable[str]) -> bool:
    """Whether a file's first lines are those of such an export."""
    return any(VARIABLE.match(line) for line in lines)


def open_trace(path: Path, lines: Iterable[str]) -> Source:
    """Open a trace export: one table where all variables have the same times, else one of each."""
    blocks = list(_blocks(path, lines))
    _, *names = unique(["time", *(name for name, _, _ in blocks)])
    source = ArraySource(path)
    times = [time for _, time, _ in blocks]
    if times and all(np.array_equal(times[0], time) for time in times[1:]):
        values = {n: (slices(v), "") for n, (_, _, v) in zip(names, blocks, strict=True)}
        source.add("", {"time": (slices(times[0]), ""), **values}, len(times[0]))
    else:
        for name, (_, time, value) in zip(names, blocks, strict=True):
            source.add(name, {"time": (slices(time), ""), name: (slices(value), "")}, len(time))
    if not source.tables:
        raise InputError(file=path, problem="holds no samples", mend="export the trace anew")
    return source


def _blocks(path: Path, lines: Iterable[str]) -> Iterator[tuple[str, Array, Array]]:
    """Name, times and values of each variable."""
    name, rows = "", list[list[float]]()
    for number, line in enumerate(lines, 1):
        if (variable := VARIABLE.match(line)) is not None:
            if rows:
                yield name, *np.array(rows).T
            name, rows = variable["name"], []
        elif (sample := _SAMPLE.match(line)) is not None and name:
            try:
                cells = (sample[k].replace(",", ".") for k in ("time", "value"))
                rows.append([float({"TRUE": "1", "FALSE": "0"}.get(c, c)) for c in cells])
            except ValueError:
                problem = f"{line.strip()!r} is no sample"
                raise InputError(
                    file=path, row=number, problem=problem, mend="export the trace anew"
                ) from None
    if rows:
        yield name, *np.array(rows).T
