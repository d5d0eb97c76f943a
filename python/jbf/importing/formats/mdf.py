"""MDF3 and MDF4 files, read by asammdf; each channel group has its own times."""

from __future__ import annotations

import logging
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from asammdf import MDF

from jbf.errors import InputError
from jbf.importing.formats.table import BLOCK, Column, Options, Source, Table, Values, as_numbers

CLOCK = "time"


class MdfSource(Source):
    """Open MDF file; each channel group is a table."""

    def __init__(self, path: Path) -> None:
        self.path = path
        # Suppress the log, since asammdf also raises the errors that it logs.
        logging.getLogger("asammdf").setLevel(logging.CRITICAL)
        # asammdf reads requested parts from an open file, but the complete file from a path.
        self._handle = path.open("rb")
        try:
            self._file = MDF(self._handle, use_display_names=False)
        except Exception:
            self._handle.close()
            raise
        self._places: dict[str, tuple[int, dict[str, int]]] = {}
        tables = []
        groups = list(enumerate(self._file.groups))
        names = [_name(at, group) for at, group in groups]
        for (at, group), name in zip(groups, names, strict=True):
            unique_name = name if names.count(name) == 1 else f"{name} {at}"
            table = self._table(at, group, "" if len(groups) == 1 else unique_name)
            if table is not None:
                tables.append(table)
        if not tables:
            raise InputError(
                file=path, problem="contains no numeric channels", remedy="name another file"
            )
        self.tables = tuple(tables)

    def _table(self, at: int, group: Any, name: str) -> Table | None:
        rows = int(group.channel_group.cycles_nr)
        master = self._file.masters_db.get(at)
        if rows < 2:
            return None
        places: dict[str, int] = {}
        columns = [Column(CLOCK, "s")] if master is not None else []
        for index, channel in enumerate(group.channels):
            if index == master or channel.name in places or channel.name == CLOCK:
                continue
            sample = self._values(at, index, 0, 1)
            if sample.dtype.kind not in "biuf" or sample.ndim != 1:
                continue
            places[channel.name] = index
            conversion = getattr(channel, "conversion", None)
            unit = channel.unit or getattr(conversion, "unit", "") or ""
            columns.append(Column(channel.name, unit.strip("\0 ")))
        self._places[name] = at, places
        start = self._file.start_time
        start_text = None if start is None else start.isoformat()
        return Table(
            name, tuple(columns), CLOCK if master is not None else None, rows, start=start_text
        )

    def _values(self, group: int, index: int, first: int, count: int) -> Any:
        signal = self._file.get(
            group=group, index=index, record_offset=first, record_count=count, samples_only=True
        )
        return np.asarray(signal[0])

    def read_blocks(self, table: Table, names: Sequence[str]) -> Iterator[dict[str, Values]]:
        """Yield the named columns of a channel group in blocks of records."""
        group, places = self._places[table.name]
        assert table.rows is not None
        for first in range(0, table.rows, BLOCK):
            count = min(BLOCK, table.rows - first)
            block: dict[str, Values] = {}
            for name in names:
                if name == CLOCK and name not in places:
                    values = self._file.get_master(group, record_offset=first, record_count=count)
                else:
                    values = self._values(group, places[name], first, count)
                block[name] = as_numbers(values)
            yield block

    def close(self) -> None:
        """Close the file."""
        self._file.close()
        self._handle.close()


def _name(at: int, group: Any) -> str:
    stated = getattr(group.channel_group, "acq_name", "") or ""
    return stated or f"group {at}"


def open_mdf(path: Path, options: Options) -> Source:
    """Open an MDF file as a source of tables."""
    return MdfSource(path)
