"""Columns of recordings in memory, so that a change of the map does not read a file again."""

from __future__ import annotations

import os
from collections import OrderedDict
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from jbf.errors import InputError
from jbf.importing.formats.table import Options, Source, Table, Values
from jbf.importing.side_by_side import open_recording
from jbf.records.run import PathLike

LARGEST = 1 << 29
"""Maximum size of the stored columns, bytes; larger files are read again."""
MOST_COLUMNS = 40
"""Number of columns of a table up to which all are read at the first reading."""

Blocks = list[dict[str, Values]]
Skipped = list[tuple[int, str, int | None]]
Stored = tuple[Blocks, Skipped]
Ticks = Callable[[int, int], None]


@dataclass
class SourceCache:
    """Store of the columns of the files that were read last, in order of their use.

    Attributes
    ----------
    stored
        Blocks of columns, and skipped rows, by file, version of the file, options and table.
    reads
        Number of times that a table was read from its file.
    """

    stored: OrderedDict[Any, Stored] = field(default_factory=OrderedDict)
    reads: int = 0

    def open(self, path: Path, beside: Sequence[PathLike], options: Options, tick: Ticks) -> Source:
        """Open a recording; `tick(done, total)` is called with the bytes that were read.

        Files with separate clocks are not stored.
        """
        source = open_recording(path, beside, options)
        if beside:
            return source
        about = os.stat(path)
        version = (os.path.realpath(path), about.st_size, about.st_mtime_ns, options)
        return CachedSource(source, self, version, tick)

    def get(self, key: Any, names: Sequence[str]) -> Stored | None:
        """Stored blocks of a table, and its skipped rows, if all columns are stored."""
        stored = self.stored.get(key)
        if stored is None or not all(name in block for block in stored[0] for name in names):
            return None
        self.stored.move_to_end(key)
        return stored

    def put(self, key: Any, stored: Stored) -> None:
        """Store the blocks of a table, and remove the oldest ones beyond the maximum size."""
        self.stored[key] = stored
        while sum(_size(blocks) for blocks, _ in self.stored.values()) > LARGEST:
            self.stored.popitem(last=False)


def _size(blocks: Blocks) -> int:
    return sum(values.nbytes for block in blocks for values in block.values())


class CachedSource(Source):
    """Open file whose columns are stored when they are first read."""

    def __init__(self, source: Source, cache: SourceCache, version: Any, tick: Ticks) -> None:
        self.path, self.tables = source.path, source.tables
        self._source, self._cache, self._version, self._tick = source, cache, version, tick
        self._skipped: Skipped = []

    def read_blocks(self, table: Table, names: Sequence[str]) -> Iterator[dict[str, Values]]:
        """Yield the stored blocks; read the file if a column is missing."""
        key = (self._version, table.name)
        stored = self._cache.get(key, names)
        if stored is None:
            stored = self._read(table, names), self._source.skipped_rows()
            self._cache.put(key, stored)
        blocks, self._skipped = stored
        for block in blocks:
            yield {name: block[name] for name in names}

    def _read(self, table: Table, names: Sequence[str]) -> Blocks:
        """Read all columns of a table, or the named ones if the others are not valid."""
        every = [column.name for column in table.columns]
        if set(every) != set(names) and len(every) <= MOST_COLUMNS:
            try:
                blocks = self._read_named(table, every)
            except InputError:
                blocks = []
            # A row that is skipped for an unused column must not be missing.
            if blocks and not self._source.skipped_rows():
                return blocks
        return self._read_named(table, names)

    def _read_named(self, table: Table, names: Sequence[str]) -> Blocks:
        self._cache.reads += 1
        blocks = []
        for block in self._source.blocks(table, names):
            blocks.append(block)
            self._tick(*self._source.read_bytes())
        return blocks

    def head(self, table: Table, rows: int = 20_000) -> dict[str, Values]:
        """First rows of every column of a table, without a reading of the whole file."""
        return self._source.head(table, rows)

    def row_of(self, table: Table, sample: int) -> int | None:
        """Row number of a sample in the file."""
        return self._source.row_of(table, sample)

    def skipped_rows(self) -> list[tuple[int, str, int | None]]:
        """Number, reason and first row of the rows that the reading skipped."""
        return self._skipped

    def read_bytes(self) -> tuple[int, int]:
        """Number of bytes read and size of the file; zeros if unknown."""
        return self._source.read_bytes()

    def close(self) -> None:
        """Close the file."""
        self._source.close()
