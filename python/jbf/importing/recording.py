"""Reading of a file through a map: converted columns in temporary files, with their times."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from jbf.arrays import Array
from jbf.errors import InputError
from jbf.importing.alignment import Alignment, align
from jbf.importing.channels import (
    CUTTING_COLUMNS,
    KEPT_COLUMN,
    RATE,
    SIGNAL_COLUMN,
    Channel,
    channels_of,
    tables_of,
)
from jbf.importing.clock_offset import span, usual_step
from jbf.importing.cutting.piece import Piece
from jbf.importing.evaluation import converted, evaluate
from jbf.importing.expression import Reference, parse_expression, references
from jbf.importing.file_clock import FileClock
from jbf.importing.formats.table import Source, Values
from jbf.importing.mapping import Map
from jbf.importing.names import column_names, column_units, columns_by_name
from jbf.importing.side_by_side import SideBySide, file_of, stem_of
from jbf.importing.spool import Dropped, Recording, Stream
from jbf.importing.time_line import TimeLine
from jbf.importing.turns import unwrapped
from jbf.records.checks import LARGEST

Report = Callable[[str, int, int], None]

UNLOADED_SHARE = 0.1
"""Share of the typical load below which a machine counts as unloaded; used in suggestions."""
STEADY = "none: steady states"
"""Text in the ledger in place of a clock, for steady states."""


def read_recording(
    source: Source, mapping: Map, folder: Path, report: Report | None = None
) -> Recording:
    """Read an open file through a map, and store its columns in temporary files in a folder.

    Raises
    ------
    InputError
        If a column does not exist, a unit does not fit, or a cell or a time is invalid.
    """
    recording = Recording(stem_of(source.path), source.path, "", steady=mapping.options.steady)
    try:
        channels = channels_of(source, mapping)
        if isinstance(source, SideBySide):
            recording.beside = source.files[1:]
            recording.alignments = aligned(source, mapping, channels, folder, recording.clocks)
        groups = Counter((channel.table.name, channel.clock) for channel in channels)
        for number, (name, clock) in enumerate(groups):
            stream_channels = [c for c in channels if (c.table.name, c.clock) == (name, clock)]
            _read_stream(
                source, mapping, stream_channels, folder / f"{number}.f64", recording, report
            )
        _check_segments(recording)
        if isinstance(source, SideBySide):
            keep_common_span(recording)
    except InputError as error:
        raise error.within(file=source.path) from None
    return recording


def aligned(
    source: SideBySide,
    mapping: Map,
    channels: Sequence[Channel],
    folder: Path,
    clocks: dict[Path, FileClock] | None = None,
) -> list[Alignment]:
    """Align the clocks of files that were recorded at the same time.

    Parameters
    ----------
    folder
        Folder for temporary files of the signals.
    clocks
        Clock of each file, corrected in place; by default new clocks.

    Raises
    ------
    InputError
        As `alignment.align`.
    """
    clocks = {} if clocks is None else clocks
    clocks |= {file: FileClock(rounded=True) for file in source.files if file not in clocks}

    def read_signal(channel: Channel) -> Stream:
        scratch = Recording("", source.path, "", clocks=clocks)
        file = folder / f"signal-{stem_of(source.file_of(channel.table))}.f64"
        file.unlink(missing_ok=True)
        _read_stream(source, mapping, [channel], file, scratch, None)
        return scratch.streams[0]

    return align(source, mapping, channels, clocks, read_signal)


def _read_stream(
    source: Source,
    mapping: Map,
    channels: list[Channel],
    file: Path,
    recording: Recording,
    report: Report | None,
) -> None:
    path = file_of(source, channels[0].table)
    try:
        _spool(source, mapping, channels, file, recording, report)
    except InputError as error:
        raise error.within(file=path) from None
    if isinstance(source, SideBySide) and len(recording.streams[-1].segments) > 1:
        problem = "its time restarts, but files recorded together need one stretch each"
        raise InputError(file=path, problem=problem, remedy="save its stretches as separate files")


def _spool(
    source: Source,
    mapping: Map,
    channels: list[Channel],
    file: Path,
    recording: Recording,
    report: Report | None,
) -> None:
    table, clock = channels[0].table, channels[0].clock
    options, keep = mapping.options, mapping.cut.keep
    tables = tables_of(source, options)
    names, units, places = column_names(tables), column_units(tables), columns_by_name(tables)
    rate = 1.0 if options.steady else options.rate_hz or table.rate_hz
    time_node = None if clock == RATE else parse_expression(clock, names)
    nodes = [c.node for c in channels] + ([] if time_node is None else [time_node])
    used = list(dict.fromkeys(r.column for node in nodes for r in references(node)))
    words = _Words(recording)
    stream = Stream(("time_s", *(c.key for c in channels)), file)
    path = file_of(source, table)
    line = TimeLine(lambda row: source.row_of(table, row))
    file.touch()
    for block in source.blocks(table, [places[name][1] for name in used]):
        values: dict[str, Values] = {name: block[places[name][1]] for name in used}
        count = len(next(iter(values.values())))
        if time_node is None:
            assert rate is not None
            time = np.arange(line.seen, line.seen + count) / rate
            time = recording.clock_of(path).corrected(time)
        else:
            time = recording.seconds(path, time_node, values, units)
        columns = [np.broadcast_to(time, (count,))]
        for channel in channels:
            column = _values(channel, values, units, words)
            if channel.key == KEPT_COLUMN:
                assert keep is not None
                column = keep.holds(column)
            columns.append(np.broadcast_to(column, (count,)))
        rows = np.column_stack(columns)
        kept_rows = rows[line.keep(rows[:, 0])]
        _check_sizes(stream.columns, kept_rows)
        stream.append(kept_rows)
        if report is not None:
            done, total = source.read_bytes()
            if not total:
                done, total = line.seen, table.rows or 0
            report(f"reading {path.name}", done, total)
    stream.segments = line.segments(stream.rows)
    if stream.rows == 0:
        raise InputError(
            problem="contains no samples", remedy="name another file, or correct the map"
        )
    dropped = [Dropped(*skipped) for skipped in source.skipped_rows()] + line.dropped()
    if stream.needed:
        incomplete = sum(int((~stream.complete(block)).sum()) for block in stream.blocks())
        dropped.append(Dropped(incomplete, "a value is missing"))
    recording.dropped += [replace(d, file=_further_name(path, recording)) for d in dropped]
    stream.source = path
    recording.notes += unwrapped(stream)
    recording.streams.append(stream)
    if path == recording.path:
        recording.start = recording.start or table.start
    for at in stream.empty:
        key = stream.columns[at]
        recording.notes.append(f"{key} contains no value and is not imported")
    recording.channels += [
        _describe(c, stream, units, rate, recording)
        for at, c in enumerate(channels, 1)
        if at not in stream.empty and c.key != KEPT_COLUMN
    ]


def _values(
    channel: Channel, values: Mapping[str, Values], units: Mapping[str, str], words: _Words
) -> Array:
    """Values of a channel in a block of rows, converted to the unit of the channel."""
    if channel.key in (*CUTTING_COLUMNS, SIGNAL_COLUMN):
        read = [values[reference.column] for reference in references(channel.node)]
        if channel.key == KEPT_COLUMN and any(column.dtype == object for column in read):
            remedy = "use a numeric column in the comparison"
            raise InputError(key="cut.keep", problem="is a column of words", remedy=remedy)
        if isinstance(channel.node, Reference):
            column = values[channel.node.column]
            return words.codes(column) if column.dtype == object else column
        return np.asarray(evaluate(channel.node, values, units).value, dtype=np.float64)
    for reference in references(channel.node):
        if values[reference.column].dtype == object:
            raise InputError(
                column=reference.column,
                problem="contains words, not numbers",
                remedy="name another column",
            )
    try:
        return converted(evaluate(channel.node, values, units), channel.unit, channel.key)
    except InputError as error:
        if error.column is None and error.key is None:
            key = f"columns.{channel.key}"
            raise InputError(key=key, problem=error.problem, remedy=error.remedy) from None
        raise


class _Words:
    """Numeric codes for the words of text columns, in the order of their first occurrence."""

    def __init__(self, recording: Recording) -> None:
        self.labels = recording.labels

    def codes(self, words: Values) -> Array:
        for word in dict.fromkeys(words.tolist()):
            if word not in self.labels:
                self.labels.append(word)
        code_of_word = {word: float(code) for code, word in enumerate(self.labels)}
        return np.array([code_of_word[word] for word in words.tolist()], dtype=np.float64)


def _check_sizes(columns: tuple[str, ...], rows: Array) -> None:
    """Raise an InputError for implausibly large values, as from a division by zero."""
    beyond = np.abs(rows) > LARGEST
    if beyond.any():
        row, column = np.argwhere(beyond)[0]
        raise InputError(
            key=f"columns.{columns[column]}",
            problem=f"{rows[row, column]:g} is not plausible",
            remedy="correct the unit, or the expression",
        )


def check_loads(recording: Recording, pieces: Iterable[Piece], mapping: Map) -> None:
    """Raise an InputError if a run has a load that is not above zero.

    Raises
    ------
    InputError
        With the file, and the time and value of the first such load.
    """
    load_stream = recording.stream_of("load_n")
    if load_stream is None:
        return
    stream, key = load_stream
    at = stream.columns.index(key)
    for piece in pieces:
        first, end = stream.rows_between(piece.segment, piece.from_s, piece.to_s)
        for block in stream.blocks(first, end):
            low = block[:, at] <= 0.0
            if not low.any():
                continue
            time, load = block[low][0][[0, at]]
            typical = float(np.nanmedian(np.abs(stream.read(first, end)[:, at])))
            condition = f"{mapping.columns['load_n']} > {UNLOADED_SHARE * typical:.2g} [N]"
            raise InputError(
                file=recording.path,
                key="columns.load_n",
                problem=f"a load of {load:g} N at {time:g} s is not above zero",
                remedy=f"keep = '{condition}' under [cut] removes such rows; otherwise "
                "correct its sign or zero",
            )


def _describe(
    channel: Channel,
    stream: Stream,
    units: Mapping[str, str],
    rate: float | None,
    recording: Recording,
) -> dict[str, object]:
    """Ledger entry of one channel: its expression, units, clock and gaps."""
    read = [
        {"column": r.column, "unit": units.get(r.column, "") if r.unit is None else r.unit}
        for r in references(channel.node)
    ]
    times = stream.read(0, min(stream.rows, 20_000))[:, 0]
    steps = np.diff(times)
    median_step = float(np.median(steps[steps > 0.0])) if (steps > 0.0).any() else None
    clock = f"{rate:g} Hz, stated" if channel.clock == RATE else channel.clock.replace("`", "")
    if recording.steady:
        clock = STEADY
    further = _further_name(stream.source, recording)
    return {
        "channel": channel.key,
        **({"file": further} if further else {}),
        "made_of": channel.text,
        "read": read,
        "unit": channel.unit.text,
        "clock": clock,
        "rate_hz": None
        if median_step is None or recording.steady
        else float(f"{1.0 / median_step:.6g}"),
        "samples": stream.rows,
    }


def _further_name(file: Path | None, recording: Recording) -> str | None:
    """Name of a further file; None for the main file."""
    return None if file is None or file == recording.path else file.name


def keep_common_span(recording: Recording) -> None:
    """Remove the rows of each stream at times that another file does not cover.

    Raises
    ------
    InputError
        If no time is covered by all files.
    """
    spans = []
    for stream in recording.streams:
        step = usual_step(stream)
        first, last = span(stream)
        spans.append((first - step, last + step))
    begin, end = max(first for first, _ in spans), min(last for _, last in spans)
    last_to_start = recording.streams[[first for first, _ in spans].index(begin)]
    early = recording.streams[[last for _, last in spans].index(end)]
    if begin >= end:
        problem = (
            f"it begins {begin - end:.4g} s after the end of {_name(early)}: their "
            "times do not overlap"
        )
        remedy = "correct the offset or the signal under [align], or omit a file"
        raise InputError(file=last_to_start.source, problem=problem, remedy=remedy)
    for stream in recording.streams:
        low, high = stream.rows_between(0, begin, end)
        skipped = stream.rows - (high - low)
        if high == low:
            problem = (
                f"it has no samples from {begin:.4g} s to {end:.4g} s, where the files overlap"
            )
            raise InputError(file=stream.source, problem=problem, remedy="omit it")
        if skipped:
            stream.segments = [(low, high)]
            why = "another file does not cover their time"
            recording.dropped.append(Dropped(skipped, why, file=_name(stream)))


def _name(stream: Stream) -> str:
    """Name of the file of a stream; empty if unknown."""
    return "" if stream.source is None else stream.source.name


def _check_segments(recording: Recording) -> None:
    counts = {len(stream.segments) for stream in recording.streams}
    if len(counts) > 1:
        raise InputError(
            problem="time restarts in some channels only",
            remedy="give the channels one clock, or import the stretches as separate files",
        )
