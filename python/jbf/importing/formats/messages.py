"""Messages of robots' logs as rows: each field that is a number is a column, `effort[0]`,
`header.stamp`; each topic is a table with the clock of its stamps, or of the log."""

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
"""Elements of a list that become columns."""
_SECONDS = ("sec", "secs")
_NANOSECONDS = ("nanosec", "nanosecs", "nsec", "nsecs")
_STEP = re.compile(r"([^.\[\]]+)|\[(\d+)\]")


class MessageSource(Source):
    """A log of messages by topic."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.tables = ()
        # One for all topics and stamps: their clocks are to be compared.
        self.origin_ns = 0

    @abstractmethod
    def messages(self, topic: str) -> Iterable[tuple[int, Any]]:
        """Log time, ns, and message, in the order of the log."""

    def add_topic(self, topic: str, count: int | None) -> None:
        """Look at a topic's first message, and add it where it holds numbers."""
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
        """Columns in blocks of messages; a field that a message lacks is no sample."""
        paths = [None if name == LOG_TIME else path_of(name) for name in names]
        rows: list[list[float]] = []
        # A message may be far larger than the numbers that are wanted of it: none is kept.
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
    """Every number and every stamp of a message, with its path."""
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
    return bool(names & set(_SECONDS) and names & set(_NANOSECONDS))


def nanoseconds(stamp: Any) -> int:
    """A stamp of seconds and nanoseconds in nanoseconds."""
    parts = dict(_parts(stamp))
    whole = next(int(parts[n]) for n in _SECONDS if n in parts)
    return whole * 10**9 + next(int(parts[n]) for n in _NANOSECONDS if n in parts)


def path_of(name: str) -> list[str | int]:
    """`a.b[2]` as steps."""
    return [m[1] if m[1] is not None else int(m[2]) for m in _STEP.finditer(name)]


def value_at(message: Any, path: Sequence[str | int], origin: int) -> float:
    """The number at a path, a stamp in seconds from its origin on; nan where there is none."""
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
