"""Signals in the structures of MAT files, with their names and times.

A signal is a structure that holds samples (`values`, `Data`) and their label. Examples are
Simulink's "Structure with time", a timeseries as a structure, and recordings of dSPACE. Its
clock is the time of the structure itself, or of the nearest enclosing structure. All other vectors
are named by their path.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any, TypeAlias

from jbf.importing.formats.arrays import ArraySource, Signal, Slice, add_by_clock

SAMPLES = ("values", "data")
"""Fields that hold the samples of a signal, in lower case."""
LABELS = ("label", "name", "signalname", "blockname")
"""Fields that name a signal, in order of preference."""
UNITS = ("unit", "units")
"""Fields that state a unit."""
SECONDS = ("s", "sec", "seconds")
"""Names of the second as a unit of time."""


@dataclass(frozen=True)
class Samples:
    """Columns of one array: number of rows, and a function per column that reads its rows."""

    rows: int
    columns: tuple[Slice, ...]


Tree: TypeAlias = "Mapping[str, Tree] | list[Tree] | str | Samples | None"
"""A variable of a file: structures, arrays of structures or cells, text, numbers."""


@dataclass(frozen=True)
class _Clock:
    """Times of signals: samples of one column, and their unit."""

    samples: Samples
    unit: str


@dataclass(frozen=True)
class _Variable:
    """Vector or matrix of a file, with its name, unit and times, if known."""

    name: str
    samples: Samples
    unit: str = ""
    clock: _Clock | None = None

    def columns(self) -> Iterator[tuple[str, Slice]]:
        """Yield the columns by name; those of a matrix are numbered from 1."""
        for at, column in enumerate(self.samples.columns, 1):
            several = len(self.samples.columns) > 1
            yield f"{self.name} column {at}" if several else self.name, column


def add_structures(source: ArraySource, content: Mapping[str, Tree]) -> None:
    """Add the variables of a MAT file to a source: signals by their times, others by length."""
    variables = [entry for name, node in content.items() for entry in _walk(node, name, None)]
    by_length: dict[int, dict[str, tuple[Slice, str]]] = {}
    signals = []
    for entry in variables:
        for name, column in entry.columns():
            if entry.clock is None:
                by_length.setdefault(entry.samples.rows, {})[name] = (column, entry.unit)
                continue
            times = entry.clock.samples
            instants = times.columns[0](0, times.rows)
            signals.append(Signal(name, instants, column, entry.unit, entry.clock.unit))
    first_table = not source.tables
    add_by_clock(source, signals, first_table and not by_length)
    for length, columns in by_length.items():
        single = first_table and not signals and len(by_length) == 1
        source.add("" if single else f"{length} samples", columns, length)


def _walk(node: Tree, name: str, clock: _Clock | None) -> Iterator[_Variable]:
    """Yield the signals and vectors in a variable of a MAT file, at any depth.

    Parameters
    ----------
    clock
        Time of the enclosing structure.
    """
    if isinstance(node, Samples):
        if node.rows > 1:
            yield _Variable(name, node)
    elif isinstance(node, list):
        for at, item in enumerate(node, 1):
            yield from _walk(item, f"{name}({at})", clock)
    elif isinstance(node, Mapping):
        yield from _of_structure(node, name, clock)


def _of_structure(node: Mapping[str, Tree], name: str, clock: _Clock | None) -> Iterator[_Variable]:
    """Yield the signals and vectors in the fields of a structure."""
    fields = {key.lower(): key for key in node}
    own_clock = _clock(node, fields)
    time = own_clock or clock
    signal = _signal(node, fields, name, time)
    used = {fields["time"]} if own_clock is not None else set[str]()
    if signal is not None:
        used |= {fields[key] for key in SAMPLES if key in fields}
    below = [
        entry
        for key, item in node.items()
        if key not in used
        for entry in _walk(item, f"{name}.{key}", time)
    ]
    entries = below if signal is None else [signal, *below]
    if own_clock is not None:
        if any(entry.clock is own_clock for entry in entries):
            # Vectors in a structure with a clock, and of its length, are sampled by this clock.
            entries = [
                replace(entry, clock=own_clock)
                if entry.clock is None and entry.samples.rows == own_clock.samples.rows
                else entry
                for entry in entries
            ]
        else:
            yield _Variable(f"{name}.{fields['time']}", own_clock.samples)
    yield from entries


def _clock(node: Mapping[str, Tree], fields: Mapping[str, str]) -> _Clock | None:
    """Times stored in a structure, or None."""
    time = node.get(fields.get("time", ""))
    if not isinstance(time, Samples) or time.rows < 2 or len(time.columns) != 1:
        return None
    about = node.get(fields.get("timeinfo", ""))
    unit = _text(about, UNITS) if isinstance(about, Mapping) else ""
    # Times of Simulink are in seconds.
    simulink = "signals" in fields
    return _Clock(time, "s" if simulink or unit.lower() in SECONDS else unit)


def _signal(
    node: Mapping[str, Tree], fields: Mapping[str, str], name: str, clock: _Clock | None
) -> _Variable | None:
    """Signal stored in a structure; None without samples, or without both label and times."""
    candidates = [node[fields[key]] for key in SAMPLES if key in fields]
    samples = next(
        (item for item in candidates if isinstance(item, Samples) and item.rows > 1), None
    )
    if samples is None:
        return None
    fitting = clock if clock is not None and clock.samples.rows == samples.rows else None
    label = _text(node, LABELS).strip("<> ")
    if fitting is None and not label:
        return None
    about = node.get(fields.get("datainfo", ""))
    unit = _text(node, UNITS) or (_text(about, UNITS) if isinstance(about, Mapping) else "")
    return _Variable(label or name, samples, unit, fitting)


def _text(node: Mapping[str, Any], keys: tuple[str, ...]) -> str:
    """First non-empty text among the fields `keys` of a structure."""
    fields = {key.lower(): value for key, value in node.items()}
    texts = (fields.get(key) for key in keys)
    return next((text.strip() for text in texts if isinstance(text, str) and text.strip()), "")
