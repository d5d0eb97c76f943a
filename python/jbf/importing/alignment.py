"""Align the clocks of files that were recorded at the same time: section `[align]` of a map.

    force = "drive/trigger ~ force/trigger"    two records of one signal, each an expression
    force = 3.217                              seconds that are added to the times of force.csv

The key is the stem of the file name. The two records may differ in gain, sign and zero. If the
times of both files are dates, the dates align the files; an entry then corrects that alignment.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from jbf.errors import InputError
from jbf.importing.channels import RATE, SIGNAL_COLUMN, Channel, clock_of, tables_of
from jbf.importing.clock_drift import refine
from jbf.importing.clock_offset import find_offset
from jbf.importing.expression import Node, parse_expression, references
from jbf.importing.file_clock import FileClock
from jbf.importing.formats.table import Table, Values
from jbf.importing.mapping import Map
from jbf.importing.names import column_names, column_units, columns_by_name
from jbf.importing.side_by_side import SideBySide, stem_of
from jbf.importing.spool import Stream
from jbf.units.unit import ONE

ReadSignal = Callable[[Channel], Stream]
"""Function that stores a channel with its times in a temporary file and returns the stream."""
QUESTION = (
    "these files have separate clocks: write a common signal (`drive/pos ~ force/pos`) "
    "or the offset in seconds; 0 if they started together"
)
_SIDES = re.compile(r"((?:`[^`]*`|[^`~])+)~((?:`[^`]*`|[^`~])+)")
_ZONE = re.compile(r"(Z|[+-]\d\d:?\d\d)$")


@dataclass(frozen=True)
class Alignment:
    """Alignment of the clock of one file with the clock of the main file.

    Attributes
    ----------
    file, main
        The two files.
    by
        Method: `signal`, `stated` or `dates`.
    offset_s
        Time added to the times of the file, s. With a drift, it applies at the time `pivot_s`.
    drift_ppm
        Relative rate error of the clock of the file (positive if slow), ppm; 0 if not significant.
    dates_s
        Part of `offset_s` that follows from the dates, s.
    signal, offset_std_s, correlation
        Common signal, standard error of the offset (s) and correlation; for the method `signal`.
    """

    file: Path
    main: Path
    by: str
    offset_s: float
    drift_ppm: float = 0.0
    pivot_s: float = 0.0
    dates_s: float | None = None
    signal: str = ""
    offset_std_s: float | None = None
    correlation: float | None = None

    def to_dict(self) -> dict[str, Any]:
        """Return the alignment as plain values, for the ledger."""
        content: dict[str, Any] = {"by": self.by, "offset_s": self.offset_s}
        if self.signal:
            content["signal"] = self.signal
            content["drift_ppm"] = self.drift_ppm
            content["pivot_s"] = self.pivot_s
            content["offset_std_s"] = self.offset_std_s
            content["correlation"] = self.correlation
        if self.dates_s is not None:
            content["dates_s"] = self.dates_s
        return content | {"text": str(self)}

    @property
    def brief(self) -> str:
        """One-line description of the offset and the drift."""
        beyond = self.offset_s - (self.dates_s or 0.0)
        direction = "behind" if beyond >= 0.0 else "ahead of"
        digits = int(np.clip(2 - np.floor(np.log10(self.offset_std_s or 1e-2)), 1, 6))
        text = f"{abs(beyond):.{digits}f} s {direction} {self.main.name}'s"
        if self.drift_ppm:
            slow = "slow" if self.drift_ppm > 0.0 else "fast"
            text += f" at mid-record and {abs(self.drift_ppm):.3g} ppm {slow}"
        return text

    def __str__(self) -> str:
        if self.by == "dates":
            return f"aligned to {self.main.name} by their dates"
        if self.by == "stated":
            return f"its clock is {self.brief}, as stated in the map; corrected"
        signal = self.signal.replace("`", "")
        error = f", standard error {self.offset_std_s:.1g} s" if self.offset_std_s else ""
        how = f"by {signal}: correlation {abs(self.correlation or 0.0):.3f}{error}"
        return f"its clock is {self.brief} ({how}); corrected"


def align(
    source: SideBySide,
    mapping: Map,
    channels: Sequence[Channel],
    clocks: Mapping[Path, FileClock],
    read_signal: ReadSignal,
) -> list[Alignment]:
    """Align the clocks of all files from which columns are used with that of the main file.

    Parameters
    ----------
    channels
        Channels of the map.
    clocks
        Clock of each file; corrected in place.
    read_signal
        Function that reads a signal with its times, which include the corrections made so far.

    Raises
    ------
    InputError
        If there is no information to align a file, or its signal does not determine the offset.
    """
    _check_keys(source, mapping)
    alignments = []
    for file in source.files[1:]:
        if any(source.file_of(channel.table) == file for channel in channels):
            try:
                alignments.append(_aligned(source, mapping, channels, clocks, read_signal, file))
            except InputError as error:
                raise error.within(file=file) from None
    return alignments


def _check_keys(source: SideBySide, mapping: Map) -> None:
    """Raise an InputError for an `[align]` entry that names no further file."""
    stems = [stem_of(file) for file in source.files[1:]]
    for key in mapping.align:
        if key not in stems:
            remedy = f"the further files are: {', '.join(stems)}"
            raise InputError(
                file=mapping.path,
                key=f"align.{key}",
                problem="is not one of the further files",
                remedy=remedy,
            )


def _aligned(
    source: SideBySide,
    mapping: Map,
    channels: Sequence[Channel],
    clocks: Mapping[Path, FileClock],
    read_signal: ReadSignal,
    file: Path,
) -> Alignment:
    main, clock = source.path, clocks[file]
    instants = [_date_ns(source, mapping, channels, clocks[path], path) for path in (main, file)]
    dates_s = None
    if instants[0] is not None and instants[1] is not None:
        dates_s = (instants[1] - instants[0]) / 1e9
    clock.offset_s = dates_s or 0.0
    stem = stem_of(file)
    requested = mapping.align.get(stem)
    if requested is None:
        if dates_s is None:
            problem = f"its clock is separate from that of {main.name}"
            remedy = (
                f'write {stem} = "A ~ B" (a common signal) under [align] in the map, or the offset '
                "in seconds"
            )
            raise InputError(problem=problem, remedy=remedy)
        return Alignment(file, main, "dates", dates_s, dates_s=dates_s)
    if not isinstance(requested, str):
        clock.offset_s += requested
        return Alignment(file, main, "stated", clock.offset_s, dates_s=dates_s)
    by_main, by_file = _signals(source, mapping, channels, file, requested)
    streams = read_signal(by_main), read_signal(by_file)
    try:
        fit = refine(*streams, find_offset(*streams))
    except InputError as error:
        raise InputError(
            file=file, key=f"align.{stem}", problem=error.problem, remedy=error.remedy
        ) from None
    finally:
        for stream in streams:
            stream.file.unlink(missing_ok=True)
    # The times of the streams already contain the alignment by dates.
    clock.pivot_s = fit.pivot_s - clock.offset_s
    clock.offset_s += fit.offset_s
    clock.drift = fit.drift
    return Alignment(
        file,
        main,
        "signal",
        clock.offset_s,
        1e6 * fit.drift,
        clock.pivot_s,
        dates_s,
        requested,
        fit.offset_std_s,
        fit.correlation,
    )


def _signals(
    source: SideBySide, mapping: Map, channels: Sequence[Channel], file: Path, text: str
) -> tuple[Channel, Channel]:
    """Find the records of a common signal, `text`, in the main file and in the other file."""
    key = f"align.{stem_of(file)}"
    sides = _SIDES.fullmatch(text)
    remedy = f'write such as "{stem_of(source.path)}/trigger ~ {stem_of(file)}/trigger"'
    if sides is None:
        problem = f"{text!r} is not a pair of signals"
        raise InputError(file=mapping.path, key=key, problem=problem, remedy=remedy)
    tables = tables_of(source, mapping.options)
    names, places = column_names(tables), columns_by_name(tables)
    all_columns = [f"{table.name}/{column.name}" for table in tables for column in table.columns]
    channel_of_file: dict[Path, Channel] = {}
    for side in sides.groups():
        try:
            node = parse_expression(side.strip(), names, all_columns)
        except InputError as error:
            raise InputError(
                file=mapping.path, key=key, problem=error.problem, remedy=error.remedy
            ) from None
        used = {places[reference.column][0].name for reference in references(node)}
        if len(used) == 1:
            table = next(t for t in tables if t.name in used)
            path = source.file_of(table)
            clock = _clock_of_table(source, mapping, channels, table)
            channel_of_file[path] = Channel(SIGNAL_COLUMN, side.strip(), node, table, clock, ONE)
    if source.path not in channel_of_file or file not in channel_of_file:
        problem = f"needs a signal of {source.path.name} and one of {file.name}"
        raise InputError(file=mapping.path, key=key, problem=problem, remedy=remedy)
    return channel_of_file[source.path], channel_of_file[file]


def _clock_of_table(
    source: SideBySide, mapping: Map, channels: Sequence[Channel], table: Table
) -> str:
    for channel in channels:
        if channel.table.name == table.name:
            return channel.clock
    tables = tables_of(source, mapping.options)
    return clock_of(
        SIGNAL_COLUMN, table, tables, mapping, column_names(tables), columns_by_name(tables)
    )


def _date_ns(
    source: SideBySide,
    mapping: Map,
    channels: Sequence[Channel],
    clock: FileClock,
    file: Path,
) -> int | None:
    """Date at which the times of a file begin, ns since 1970; None if the times are not dates."""
    channel = next((c for c in channels if source.file_of(c.table) == file), None)
    if channel is None:
        return None
    table = channel.table
    if channel.clock == RATE:
        return _nanoseconds(table.start)
    tables = tables_of(source, mapping.options)
    names, units, places = column_names(tables), column_units(tables), columns_by_name(tables)
    node = parse_expression(channel.clock, names)
    used = [reference.column for reference in references(node)]
    blocks = source.blocks(table, [places[name][1] for name in used])
    block = next(blocks, None)
    if block is None:
        return None
    values: dict[str, Values] = {name: block[places[name][1]] for name in used}
    clock.seconds(node, values, units)
    if clock.origin_s:
        return int(clock.origin_s) * 10**9
    return _nanoseconds(table.start) if _counts_from_start(table, node, places) else None


def _counts_from_start(table: Table, node: Node, places: Mapping[str, tuple[Table, str]]) -> bool:
    """Whether the times of a clock expression count from the start date of their table.

    This requires that the expression `node` refers to one column only, which is the clock of the
    table or its only column of dates.
    """
    columns = [table.column(places[r.column][1]) for r in references(node)]
    if len(columns) != 1:
        return False
    # With a second column of dates or times of day, the table's date may belong to either column.
    instants = [column for column in table.columns if column.kind == "instant"]
    return columns[0].name == table.clock or instants == columns


def _nanoseconds(date: str | None) -> int | None:
    """Convert an ISO date to ns since 1970; None if there is no date."""
    if not date:
        return None
    zone = _ZONE.search(date) if "T" in date or " " in date else None
    try:
        instant = int(np.datetime64(date[: zone.start()] if zone else date, "ns").astype(np.int64))
    except ValueError:
        return None
    if zone is None or zone[1] == "Z":
        return instant
    digits = zone[1][1:].replace(":", "")
    seconds = 3600 * int(digits[:2]) + 60 * int(digits[2:])
    return instant - (seconds if zone[1][0] == "+" else -seconds) * 10**9
