"""WPILib data logs, read according to their specification (version 1.0).

A log consists of records of entries, each with its instant in microseconds. The library of WPILib
is not used, because it returns values from beyond the end of a truncated log.
"""

from __future__ import annotations

import json
from array import array
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from jbf.errors import InputError
from jbf.importing.formats.arrays import ArraySource, Signal, add_by_clock, slices
from jbf.importing.formats.messages import LONGEST
from jbf.importing.formats.table import Options, Source

_TYPES = {"double": "<f8", "float": "<f4", "int64": "<i8", "boolean": "?"}
"""NumPy types of numeric entries, and of arrays of them (`double[]`)."""
_UNITS = ("unit", "units")
"""Keys of an entry's metadata that state its unit."""
_START, _FINISH, _METADATA = 0, 1, 2
"""Kinds of control records, which are the records with entry number 0."""
_US = 1e6
_HEADER = 12
_LARGEST = 2**63 - 1


class _TornError(Exception):
    """Error: the log ends within a record."""


@dataclass
class _Entry:
    """Samples of one log entry: times, and position and size of each sample in the file."""

    name: str
    kind: str
    unit: str
    stamps_us: array[int] = field(default_factory=lambda: array("q"))
    begins: array[int] = field(default_factory=lambda: array("q"))
    sizes: array[int] = field(default_factory=lambda: array("q"))

    def signals(self, data: bytes, origin_us: int) -> Iterator[Signal]:
        """Yield one signal per array element of an entry; times are in seconds since the origin."""
        dtype = np.dtype(_TYPES[self.kind.removesuffix("[]")])
        lengths = np.array(self.sizes) // dtype.itemsize
        width = min(int(lengths.max(initial=0)), LONGEST if self.kind.endswith("[]") else 1)
        # Records may be in any order.
        order = np.argsort(self.stamps_us, kind="stable")
        times = (np.array(self.stamps_us)[order] - origin_us) / _US
        values = np.full((len(order), width), np.nan)
        for row, at in enumerate(order.tolist()):
            count = min(int(lengths[at]), width)
            values[row, :count] = np.frombuffer(data, dtype, count, self.begins[at])
        for column in range(width):
            name = f"{self.name}[{column}]" if self.kind.endswith("[]") else self.name
            yield Signal(name, times, slices(values[:, column]), self.unit, "s")


def open_wpilog(path: Path, options: Options) -> Source:
    """Open a WPILib data log as a source; a truncated record at its end is skipped."""
    data = path.read_bytes()
    if len(data) < _HEADER:
        raise InputError(
            file=path,
            problem="is not a complete WPILib data log",
            remedy="copy it from the robot again",
        )
    source = ArraySource(path)
    entries, torn = _entries(data)
    if torn is not None:
        source.passed_over = [(1, f"the record at byte {torn} is truncated", None)]
    origin_us = min((min(entry.stamps_us) for entry in entries if entry.stamps_us), default=0)
    add_by_clock(source, (s for entry in entries for s in entry.signals(data, origin_us)))
    if not source.tables:
        raise InputError(
            file=path, problem="contains no numeric entries", remedy="name another file"
        )
    return source


def _entries(data: bytes) -> tuple[list[_Entry], int | None]:
    """Numeric entries of a log, and the position of a truncated record, or None.

    Entries of equal name and type, as after a restart, are merged.
    """
    entries: dict[tuple[str, str], _Entry] = {}
    by_number: dict[int, _Entry] = {}
    at = _HEADER + int.from_bytes(data[8:_HEADER], "little")
    while at < len(data):
        lengths = data[at]
        number_end = at + 2 + (lengths & 3)
        size_end = number_end + 1 + (lengths >> 2 & 3)
        begin = size_end + 1 + (lengths >> 4 & 7)
        number = int.from_bytes(data[at + 1 : number_end], "little")
        size = int.from_bytes(data[number_end:size_end], "little")
        if begin + size > len(data):
            return list(entries.values()), at
        if number == 0:
            try:
                _control(data[begin : begin + size], entries, by_number)
            except _TornError:
                return list(entries.values()), at
        elif (entry := by_number.get(number)) is not None:
            entry.stamps_us.append(int.from_bytes(data[size_end:begin], "little") & _LARGEST)
            entry.begins.append(begin)
            entry.sizes.append(size)
        at = begin + size
    return list(entries.values()), None


def _control(
    content: bytes, entries: dict[tuple[str, str], _Entry], by_number: dict[int, _Entry]
) -> None:
    """Process a control record: start or finish of an entry, or a change of its metadata."""
    if len(content) < 5:
        raise _TornError
    number = int.from_bytes(content[1:5], "little")
    if content[0] == _START:
        name, at = _text(content, 5)
        kind, at = _text(content, at)
        metadata, _ = _text(content, at)
        by_number.pop(number, None)
        if kind.removesuffix("[]") in _TYPES:
            entry = _Entry(name, kind, _unit(metadata))
            by_number[number] = entries.setdefault((name, kind), entry)
    elif content[0] == _FINISH:
        by_number.pop(number, None)
    elif content[0] == _METADATA and number in by_number:
        by_number[number].unit = _unit(_text(content, 5)[0])


def _text(content: bytes, at: int) -> tuple[str, int]:
    """Text with a length prefix at a position, and the position of its end."""
    end = at + 4 + int.from_bytes(content[at : at + 4], "little")
    if end > len(content):
        raise _TornError
    return content[at + 4 : end].decode("utf-8", "replace"), end


def _unit(metadata: str) -> str:
    """Unit in the JSON metadata of an entry; empty if not stated."""
    try:
        content = json.loads(metadata)
    except ValueError:
        return ""
    stated = [content.get(key) for key in _UNITS] if isinstance(content, dict) else []
    return next((unit for unit in stated if isinstance(unit, str)), "")
