"""CODESYS trace exports: for each variable in turn, a block of times and values.

CODESYS and systems based on it (Machine Expert, ctrlX, e!COCKPIT) write `0.Variable; NAME`, more
lines about the variable, and then its samples, `; time; value`.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np

from jbf.errors import InputError
from jbf.importing.formats.arrays import ArraySource, Signal, add_by_clock, slices
from jbf.importing.formats.table import Source

VARIABLE = re.compile(r"^\s*\d+\.Variable\s*[;,\t]\s*(?P<name>[^;,\t]+?)\s*[;,\t]?\s*$", re.I)
_SAMPLE = re.compile(r"^\s*[;,\t]\s*(?P<time>[^;\t]+?)\s*[;\t,]\s*(?P<value>[^;\t]+?)\s*[;\t]?\s*$")


def is_trace(lines: Iterable[str]) -> bool:
    """Whether the first lines of a file are those of a trace export."""
    return any(VARIABLE.match(line) for line in lines)


def open_trace(path: Path, lines: Iterable[str]) -> Source:
    """Open a trace export as a source; variables with equal times share a table."""
    source = ArraySource(path)
    add_by_clock(source, _blocks(path, lines))
    if not source.tables:
        raise InputError(file=path, problem="contains no samples", remedy="export the trace again")
    return source


def _blocks(path: Path, lines: Iterable[str]) -> Iterator[Signal]:
    """Yield the signal of each variable in a trace export, with its sample times."""
    name, rows = "", list[list[float]]()
    for number, line in enumerate(lines, 1):
        if (variable := VARIABLE.match(line)) is not None:
            if rows:
                yield _signal(name, rows)
            name, rows = variable["name"], []
        elif (sample := _SAMPLE.match(line)) is not None and name:
            try:
                cells = (sample[k].replace(",", ".") for k in ("time", "value"))
                rows.append([float({"TRUE": "1", "FALSE": "0"}.get(c, c)) for c in cells])
            except ValueError:
                problem = f"{line.strip()!r} is not a sample"
                raise InputError(
                    file=path, row=number, problem=problem, remedy="export the trace again"
                ) from None
    if rows:
        yield _signal(name, rows)


def _signal(name: str, rows: list[list[float]]) -> Signal:
    times, values = np.array(rows).T
    return Signal(name, times, slices(values))
