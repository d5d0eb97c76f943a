"""Source that combines files recorded at the same time with separate clocks.

Each file provides one or several tables of the source, named by the stem of the file.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path

from jbf.errors import InputError
from jbf.importing.formats.registry import open_source
from jbf.importing.formats.table import Options, Source, Table, Values


class SideBySide(Source):
    """Several open files as one source; the clock of the first file is that of the recording.

    Attributes
    ----------
    files
        Paths, the main file first.
    """

    def __init__(self, sources: Sequence[Source], stack: ExitStack, options: Options) -> None:
        self.path = sources[0].path
        self.files = tuple(source.path for source in sources)
        self._stack = stack
        self._origins: dict[str, tuple[Source, Table]] = {}
        self._reading = sources[0]
        tables = []
        chosen = _select_tables(sources, options.table)
        for source, source_tables in zip(sources, chosen, strict=True):
            stem = stem_of(source.path)
            for table in source_tables:
                name = stem if len(source_tables) == 1 else f"{stem}/{table.name}"
                self._origins[name] = source, table
                tables.append(replace(table, name=name))
        self.tables = tuple(tables)

    def file_of(self, table: Table) -> Path:
        """Path of the file that contains a table."""
        return self._origins[table.name][0].path

    def read_blocks(self, table: Table, names: Sequence[str]) -> Iterator[dict[str, Values]]:
        """Yield the blocks of a table from its file; an error names that file."""
        source, origin = self._origins[table.name]
        self._reading = source
        try:
            yield from source.blocks(origin, names)
        except InputError as error:
            raise error.within(file=source.path) from None

    def row_of(self, table: Table, sample: int) -> int | None:
        """Row number of a sample in the file that contains the table."""
        source, origin = self._origins[table.name]
        return source.row_of(origin, sample)

    def skipped_rows(self) -> list[tuple[int, str, int | None]]:
        """Number, reason and first row of the rows that the last reading skipped."""
        return self._reading.skipped_rows()

    def read_bytes(self) -> tuple[int, int]:
        """Number of bytes read from the current file, and its size."""
        return self._reading.read_bytes()

    def close(self) -> None:
        """Close all files."""
        self._stack.close()


def file_of(source: Source, table: Table) -> Path:
    """Path of the file that contains a table of a source."""
    return source.file_of(table) if isinstance(source, SideBySide) else source.path


def stem_of(path: Path) -> str:
    """Name of a file without its suffix, and without a final `.gz`."""
    return (path.with_suffix("") if path.suffix.lower() == ".gz" else path).stem


def open_recording(
    path: str | os.PathLike[str],
    beside: Sequence[str | os.PathLike[str]] = (),
    options: Options | None = None,
) -> Source:
    """Open a file, or several files recorded at the same time, as one source.

    Parameters
    ----------
    beside
        Further files; their clocks are aligned to that of `path`.

    Raises
    ------
    InputError
        If a file does not exist or is broken, its library is not installed, or two files have the
        same stem.
    """
    options = options or Options()
    if not beside:
        return open_source(path, options)
    if options.steady:
        remedy = "omit the other files, or steady"
        raise InputError(key="file.steady", problem="steady states have no clock", remedy=remedy)
    with ExitStack() as stack:
        sources = [stack.enter_context(open_source(file, options)) for file in (path, *beside)]
        stems = [stem_of(source.path) for source in sources]
        for at, source in enumerate(sources):
            if stems[at] in stems[:at]:
                problem = f"another file also has the name {stems[at]}"
                raise InputError(file=source.path, problem=problem, remedy="rename one of them")
        return SideBySide(sources, stack.pop_all(), options)


def _select_tables(sources: Sequence[Source], name: str | None) -> list[tuple[Table, ...]]:
    """Tables of each file with a given name; all tables of a file that has none of this name."""
    if name is None:
        return [source.tables for source in sources]
    named = [tuple(t for t in source.tables if t.name == name) for source in sources]
    if not any(named):
        available = ", ".join(t.name for source in sources for t in source.tables if t.name)
        problem = f'no file contains "{name}"'
        remedy = f"they contain: {available}" if available else "omit it"
        raise InputError(key="file.table", problem=problem, remedy=remedy)
    return [
        named_tables or source.tables for named_tables, source in zip(named, sources, strict=True)
    ]
