"""Messages of robot logs as rows: each topic is a table, and each numeric field is a column.

Columns are named by their path, such as `effort[0]` or `header.stamp`. The clock of a table is the
stamp in the messages, or the time of the log.
"""

from __future__ import annotations

import re
from abc import abstractmethod
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any

import numpy as np

from jbf.importing.formats.dates import as_date
from jbf.importing.formats.table import BLOCK, Column, Source, Table, Values

LOG_TIME = "log_time"
LONGEST = 32
"""Largest number of list elements that become columns."""
SECONDS = ("sec", "secs", "seconds")
NANOSECONDS = ("nanosec", "nanosecs", "nsec", "nsecs", "nanos", "nanoseconds")
"""Names of the nanosecond part of a time stamp."""
_STEP = re.compile(r"([^.\[\]]+)|\[(\d+)\]")


class MessageSource(Source):
    """Open log of messages; each topic with numbers is a table."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.tables = ()
        # All topics and stamps share one origin, so that their clocks can be compared.
        self.origin_ns = 0

    @abstractmethod
    def messages(self, topic: str) -> Iterable[tuple[int, Any]]:
        """Yield log time, ns, and message of a topic, in the order of the log."""

    def add_topic(self, topic: str, count: int | None) -> None:
        """Inspect the first message of a topic, and add the topic if it holds numbers."""
        first = next(iter(self.messages(topic)), None)
        if first is None:
            return
        _, message = first
        leaves = dict(leaves_of(message))
        if not leaves:
            return
        columns = [Column(LOG_TIME, "s")]
        clock = LOG_TIME
        for name, value in leaves.items():
            if _is_stamp(value):
                columns.append(Column(name, "s"))
                if name == "header.stamp" and nanoseconds(value) > 0:
                    clock = name
            else:
                columns.append(Column(name))
        start = as_date(self.origin_ns)
        self.tables = (*self.tables, Table(topic, tuple(columns), clock, count, start=start))

    def read_blocks(self, table: Table, names: Sequence[str]) -> Iterator[dict[str, Values]]:
        """Yield the named fields of a topic in blocks of messages; NaN where one is absent."""
        paths = [None if name == LOG_TIME else path_of(name) for name in names]
        rows: list[list[float]] = []
        # Do not store messages, which may be much larger than the requested numbers.
        for stamp, message in self.messages(table.name):
            rows.append(
                [
                    (stamp - self.origin_ns) / 1e9
                    if path is None
                    else value_at(message, path, self.origin_ns)
                    for path in paths
                ]
            )
            if len(rows) == BLOCK:
                yield _columns(names, rows)
                rows = []
        if rows:
            yield _columns(names, rows)


def _columns(names: Sequence[str], rows: list[list[float]]) -> dict[str, Values]:
    return dict(zip(names, np.array(rows, dtype=np.float64).T, strict=True))


def leaves_of(message: Any, lead: str = "") -> Iterator[tuple[str, Any]]:
    """Yield every number and every time stamp of a message, with its path."""
    for name, value in _parts(message):
        path = f"{lead}{name}"
        if isinstance(value, bool | np.bool_ | str | bytes) or value is None:
            continue
        if isinstance(value, int | float | np.integer | np.floating) or _is_stamp(value):
            yield path, value
        elif isinstance(value, list | tuple | np.ndarray):
            for at, item in enumerate(value[:LONGEST]):
                if isinstance(item, int | float | np.integer | np.floating):
                    yield f"{path}[{at}]", item
                elif not isinstance(item, str | bytes):
                    yield from leaves_of(item, f"{path}[{at}].")
        else:
            yield from leaves_of(value, f"{path}.")


def _parts(message: Any) -> Iterable[tuple[str, Any]]:
    if isinstance(message, Mapping):
        return message.items()
    if is_dataclass(message):
        return [(f.name, getattr(message, f.name)) for f in fields(message)]
    names = getattr(message, "__slots__", None) or getattr(message, "__dict__", {})
    return [(n.lstrip("_"), getattr(message, n)) for n in names if not n.startswith("__")]


def _is_stamp(value: Any) -> bool:
    names = {name for name, _ in _parts(value)} if not np.isscalar(value) else set()
    return bool(names & set(SECONDS) and names & set(NANOSECONDS))


def nanoseconds(stamp: Any) -> int:
    """Convert a time stamp of seconds and nanoseconds to nanoseconds."""
    parts = dict(_parts(stamp))
    seconds = next(int(parts[n]) for n in SECONDS if n in parts)
    return seconds * 10**9 + next(int(parts[n]) for n in NANOSECONDS if n in parts)


def path_of(name: str) -> list[str | int]:
    """Split the path of a field, such as `a.b[2]`, into its names and indices."""
    return [m[1] if m[1] is not None else int(m[2]) for m in _STEP.finditer(name)]


def value_at(message: Any, path: Sequence[str | int], origin: int) -> float:
    """Number at a path in a message; a stamp in seconds since `origin`; NaN if absent."""
    value = message
    try:
        for step in path:
            if isinstance(step, int) or isinstance(value, Mapping):
                value = value[step]
            else:
                value = getattr(value, step)
        if isinstance(value, int | float | np.integer | np.floating):
            return float(value)
        return (nanoseconds(value) - origin) / 1e9
    except (AttributeError, IndexError, KeyError, TypeError, StopIteration):
        return float("nan")
