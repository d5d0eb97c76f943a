"""A file read through a map: every column in its unit, every clock as it was, onto the disk."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

import numpy as np
import numpy.typing as npt

from jbf.errors import InputError
from jbf.importing.cutting.piece import Piece
from jbf.importing.evaluation import Quantity, converted, evaluate
from jbf.importing.expression import Node, Reference, parse_expression, references
from jbf.importing.formats.dates import as_date
from jbf.importing.formats.table import Options, Source, Table, Values
from jbf.importing.mapping import Map
from jbf.importing.names import column_names, column_units, located
from jbf.importing.spool import Dropped, Recording, Stream
from jbf.importing.targets import wanted_unit
from jbf.importing.time_line import TimeLine
from jbf.importing.turns import unwrapped
from jbf.records.checks import LARGEST
from jbf.units.unit import ONE, Unit

Array = npt.NDArray[np.float64]
Report = Callable[[str, int, int], None]

CUT_COLUMN, KEPT_COLUMN = "cut", "kept"
"""Where a set point or the number of a run, and whether a row is kept, stand until the recording is
cut."""
LOADED = 0.1
"""Share of the usual load below which a machine counts as unloaded, in what is suggested."""
OF_CUTTING = (CUT_COLUMN, KEPT_COLUMN)
_RATE = "rate"
STEADY = "none: each row is a steady state"
"""What a ledger says of the clock of steady states."""


@dataclass(frozen=True)
class Channel:
    """One column of a run: its expression, the table it comes from, its time."""

    key: str
    text: str
    node: Node
    table: Table
    clock: str
    unit: Unit


def read_recording(
    source: Source, mapping: Map, folder: Path, report: Report | None = None
) -> Recording:
    """A source through a map, spooled into a folder.

    Raises
    ------
    InputError
        A column is not there, a unit does not fit, a cell or a time is wrong.
    """
    recording = Recording(_stem(source.path), source.path, "", steady=mapping.options.steady)
    try:
        channels = _channels(source, mapping)
        groups = Counter((channel.table.name, channel.clock) for channel in channels)
        for number, (name, clock) in enumerate(groups):
            own = [c for c in channels if (c.table.name, c.clock) == (name, clock)]
            _read_stream(source, mapping, own, folder / f"{number}.f64", recording, report)
        _check_segments(recording)
    except InputError as error:
        raise error.within(file=source.path) from None
    return recording


def _stem(path: Path) -> str:
    """A file's name without its end, and without `.gz` after that."""
    return (path.with_suffix("") if path.suffix.lower() == ".gz" else path).stem


def _channels(source: Source, mapping: Map) -> list[Channel]:
    tables = _tables(source, mapping.options)
    names = column_names(tables)
    known = [column.name for table in tables for column in table.columns]
    places = located(tables)
    wanted = {key: text for key, text in mapping.columns.items() if key != "time_s"}
    if mapping.cut.by and mapping.cut.column is not None:
        wanted[CUT_COLUMN] = mapping.cut.column
    if mapping.cut.keep is not None:
        wanted[KEPT_COLUMN] = mapping.cut.keep.difference
    found = []
    for key, text in wanted.items():
        section = {CUT_COLUMN: "cut.column", KEPT_COLUMN: "cut.keep"}.get(key, f"columns.{key}")
        try:
            node = parse_expression(text, names, known)
        except InputError as error:
            raise InputError(key=section, problem=error.problem, mend=error.mend) from None
        tables_of = {places[r.column][0].name for r in references(node)}
        if len(tables_of) != 1:
            problem = "takes columns with different clocks" if tables_of else "takes no column"
            mend = "take columns of one group; nothing is resampled here"
            raise InputError(key=section, problem=f"{text} {problem}", mend=mend)
        (of,) = tables_of
        table = next(t for t in tables if t.name == of)
        clock = _clock(key, table, tables, mapping, names, places)
        unit = ONE if key in OF_CUTTING else wanted_unit(key)
        found.append(Channel(key, text, node, table, clock, unit))
    return found


def _tables(source: Source, options: Options) -> tuple[Table, ...]:
    if options.table is None:
        return source.tables
    for table in source.tables:
        if table.name == options.table:
            return (table,)
    names = ", ".join(table.name for table in source.tables)
    problem = f'holds no "{options.table}"'
    raise InputError(file=source.path, problem=problem, mend=f"it holds: {names}")


def _clock(
    key: str,
    table: Table,
    tables: tuple[Table, ...],
    mapping: Map,
    names: Mapping[str, str],
    places: Mapping[str, tuple[Table, str]],
) -> str:
    """The expression of a column's time; `rate` where its rate alone is known."""
    if mapping.options.steady:
        return _RATE
    text = mapping.clocks.get(key, mapping.columns.get("time_s"))
    if text is not None:
        node = parse_expression(text, names)
        if {places[r.column][0].name for r in references(node)} == {table.name}:
            return text
        if key in mapping.clocks:
            problem = "is in another group than its column"
            raise InputError(key=f"clocks.{key}", problem=problem, mend="name a time beside it")
    if table.clock is not None:
        return f"`{table.name}/{table.clock}`"
    if text is None and (mapping.options.rate_hz or table.rate_hz):
        return _RATE
    if text is not None:
        problem = f"has no clock: time_s is in another group than [{table.name}]"
        raise InputError(
            key=f"columns.{key}", problem=problem, mend=f"name its time under [clocks] as {key}"
        )
    raise InputError(
        key="columns.time_s",
        problem="is missing",
        mend="name the file's column of times, or say rate_hz under [file]",
    )


def _read_stream(
    source: Source,
    mapping: Map,
    channels: list[Channel],
    file: Path,
    recording: Recording,
    report: Report | None,
) -> None:
    table, clock = channels[0].table, channels[0].clock
    options, keep = mapping.options, mapping.cut.keep
    tables = _tables(source, options)
    names, units, places = column_names(tables), column_units(tables), located(tables)
    rate = 1.0 if options.steady else options.rate_hz or table.rate_hz
    time_node = None if clock == _RATE else parse_expression(clock, names)
    nodes = [c.node for c in channels] + ([] if time_node is None else [time_node])
    used = list(dict.fromkeys(r.column for node in nodes for r in references(node)))
    words = _Words(recording)
    stream = Stream(("time_s", *(c.key for c in channels)), file)
    line = TimeLine(lambda row: source.row_of(table, row))
    file.touch()
    for block in source.blocks(table, [places[name][1] for name in used]):
        values: dict[str, Values] = {name: block[places[name][1]] for name in used}
        count = len(next(iter(values.values())))
        if time_node is None:
            assert rate is not None
            time = np.arange(line.seen, line.seen + count) / rate
        else:
            time = _seconds(time_node, values, units, recording)
        columns = [np.broadcast_to(time, (count,))]
        for channel in channels:
            column = _values(channel, values, units, words)
            if channel.key == KEPT_COLUMN:
                assert keep is not None
                column = keep.holds(column)
            columns.append(np.broadcast_to(column, (count,)))
        rows = np.column_stack(columns)
        kept = rows[line.keep(rows[:, 0])]
        _check_sizes(stream.columns, kept)
        stream.append(kept)
        if report is not None:
            done, total = source.read_bytes()
            if not total:
                done, total = line.seen, table.rows or 0
            report(f"reading {source.path.name}", done, total)
    stream.segments = line.segments(stream.rows)
    if stream.rows == 0:
        raise InputError(problem="holds no samples", mend="name another file, or correct the map")
    recording.dropped += [Dropped(*found) for found in source.left_out()]
    recording.dropped += line.dropped()
    if stream.needed:
        lacking = sum(int((~stream.complete(block)).sum()) for block in stream.blocks())
        recording.dropped.append(Dropped(lacking, "a value is missing"))
    recording.notes += unwrapped(stream)
    recording.streams.append(stream)
    recording.start = recording.start or table.start
    for at in stream.empty:
        key = stream.columns[at]
        recording.notes.append(f"{key} holds no value and is left out")
    recording.channels += [
        _described(c, stream, units, rate, recording.steady)
        for at, c in enumerate(channels, 1)
        if at not in stream.empty and c.key != KEPT_COLUMN
    ]


EPOCH_S = (1e8, 1e10)
"""Times within are seconds since 1970."""


def _seconds(
    node: Node, values: Mapping[str, Values], units: Mapping[str, str], recording: Recording
) -> Array:
    """Times, s; of seconds since 1970 the whole ones before the first are taken off, before
    anything is rounded."""
    wanted = wanted_unit("time_s")
    found = evaluate(node, values, units)
    time = converted(found, wanted, "time_s")
    if recording.origin_s is None:
        known = time[np.isfinite(time)]
        late = known.size > 0 and EPOCH_S[0] < known[0] < EPOCH_S[1]
        recording.origin_s = float(np.floor(known[0])) if late else 0.0
        if late:
            recording.start = as_date(int(recording.origin_s) * 10**9)
            recording.notes.append(f"times count from {recording.origin_s:.0f} s after 1970")
    if not recording.origin_s:
        return time
    if isinstance(node, Reference) and found.unit.pi == 0:
        first = float(Fraction(int(recording.origin_s)) / found.unit.ratio)
        return converted(Quantity(found.value - first, found.unit), wanted, "time_s")
    return time - recording.origin_s


def _values(
    channel: Channel, values: Mapping[str, Values], units: Mapping[str, str], words: _Words
) -> Array:
    if channel.key in OF_CUTTING:
        read = [values[reference.column] for reference in references(channel.node)]
        if channel.key == KEPT_COLUMN and any(column.dtype == object for column in read):
            mend = "compare a column of numbers"
            raise InputError(key="cut.keep", problem="takes a column of words", mend=mend)
        if isinstance(channel.node, Reference):
            column = values[channel.node.column]
            return words.codes(column) if column.dtype == object else column
        return np.asarray(evaluate(channel.node, values, units).value, dtype=np.float64)
    for reference in references(channel.node):
        if values[reference.column].dtype == object:
            raise InputError(
                column=reference.column, problem="holds words, not numbers", mend="name another"
            )
    try:
        return converted(evaluate(channel.node, values, units), channel.unit, channel.key)
    except InputError as error:
        if error.column is None and error.key is None:
            key = f"columns.{channel.key}"
            raise InputError(key=key, problem=error.problem, mend=error.mend) from None
        raise


class _Words:
    """Numbers for words, in the order in which they come."""

    def __init__(self, recording: Recording) -> None:
        self.labels = recording.labels

    def codes(self, words: Values) -> Array:
        for word in dict.fromkeys(words.tolist()):
            if word not in self.labels:
                self.labels.append(word)
        known = {word: float(code) for code, word in enumerate(self.labels)}
        return np.array([known[word] for word in words.tolist()], dtype=np.float64)


def _check_sizes(columns: tuple[str, ...], rows: Array) -> None:
    """Refuse what no machine does, such as what a division by zero makes; nan is a gap."""
    beyond = np.abs(rows) > LARGEST
    if beyond.any():
        row, column = np.argwhere(beyond)[0]
        raise InputError(
            key=f"columns.{columns[column]}",
            problem=f"{rows[row, column]:g} is beyond what any machine does",
            mend="correct the unit, or the expression",
        )


def check_loads(recording: Recording, pieces: Iterable[Piece], mapping: Map) -> None:
    """Refuse a run with a load that is not above zero.

    Raises
    ------
    InputError
        Names the run and the instant.
    """
    found = recording.stream_of("load_n")
    if found is None:
        return
    stream, key = found
    at = stream.columns.index(key)
    for piece in pieces:
        first, end = stream.rows_between(piece.segment, piece.from_s, piece.to_s)
        for block in stream.blocks(first, end):
            low = block[:, at] <= 0.0
            if not low.any():
                continue
            time, load = block[low][0][[0, at]]
            usual = float(np.nanmedian(np.abs(stream.read(first, end)[:, at])))
            least = f"{mapping.columns['load_n']} > {LOADED * usual:.2g} [N]"
            raise InputError(
                file=recording.path,
                key="columns.load_n",
                problem=f"a load of {load:g} N at {time:g} s is not above zero",
                mend=f"keep = '{least}' under [cut] leaves such rows out; or turn its sign, or "
                "take its zero off",
            )


def _described(
    channel: Channel,
    stream: Stream,
    units: Mapping[str, str],
    rate: float | None,
    steady: bool,
) -> dict[str, object]:
    read = [
        {"column": r.column, "unit": units.get(r.column, "") if r.unit is None else r.unit}
        for r in references(channel.node)
    ]
    times = stream.read(0, min(stream.rows, 20_000))[:, 0]
    steps = np.diff(times)
    usual = float(np.median(steps[steps > 0.0])) if (steps > 0.0).any() else None
    clock = f"{rate:g} Hz, stated" if channel.clock == _RATE else channel.clock.strip("`")
    if steady:
        clock = STEADY
    return {
        "channel": channel.key,
        "made_of": channel.text,
        "read": read,
        "unit": channel.unit.text,
        "clock": clock,
        "rate_hz": None if usual is None or steady else float(f"{1.0 / usual:.6g}"),
        "samples": stream.rows,
    }


def _check_segments(recording: Recording) -> None:
    counts = {len(stream.segments) for stream in recording.streams}
    if len(counts) > 1:
        raise InputError(
            problem="time starts again in some channels and not in others",
            mend="give the channels one clock, or import the stretches as files of their own",
        )
