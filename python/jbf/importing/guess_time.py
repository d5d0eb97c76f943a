"""Detection of the time column of a table, and of its unit."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from jbf.importing.columns import Header, parse_header
from jbf.importing.expression import OPEN, written
from jbf.importing.formats.messages import NANOSECONDS, SECONDS
from jbf.importing.formats.table import Column, Table, Values
from jbf.importing.guessed import Entry, Question
from jbf.importing.plausible import MAX_RATIO, PAIRS, speed_ratio
from jbf.importing.targets import wanted_unit
from jbf.units.table import TIME
from jbf.units.unit import parse_unit

_FROM_S, _TO_S = 9.5e8, 4.1e9
"""Seconds since 1970 of the years 2000 and 2100."""
MIN_FORWARD_SHARE, MIN_TESTED_ROWS = 0.9, 4
"""Minimum share of increasing steps of a clock, and number of rows below which it is not tested."""
SHORTEST_S = 1e-6
"""Smallest plausible sampling interval of a friction recording, s."""
_PART = re.compile(r"(?:.*[^a-z])?(?P<part>[a-z]+)", re.IGNORECASE)
"""Path of a column whose last word may be a part of a stamp, such as `header.stamp.secs`."""
_HEADER_STAMP = re.compile(r"header\W+stamp", re.IGNORECASE)
"""Stamp of the measurement in a message; it precedes the times of the log and other stamps."""
Found = tuple[Entry | None, list[Question]]


def guess_time(table: Table, head: Mapping[str, Values]) -> Found:
    """Propose the map entry for the time of a table, with open questions about it."""
    if table.clock is not None:
        return Entry("time_s", written(table.clock), "clock of the format"), []
    exact = [c for c in table.columns if c.name == "time_s" and c.kind == "number"]
    if exact:
        return Entry("time_s", written("time_s"), "name of a jbf column"), []
    pairs = _stamps_in_two_columns(table, head)
    in_pairs = {name for pair in pairs for name in pair}
    numbers = [
        c
        for c in table.columns
        if _is_time(c) and _runs_forward(head[c.name]) and c.name not in in_pairs
    ]
    in_headers = [pair for pair in pairs if _HEADER_STAMP.search(pair[0])]
    if len(in_headers) == 1 or (len(pairs) == 1 and not numbers):
        seconds, nanoseconds = (in_headers or pairs)[0]
        text = f"{written(seconds)} [s] + {written(nanoseconds)} [ns]"
        return Entry("time_s", text, "seconds and nanoseconds of a stamp"), []
    if pairs:
        return _one_of([*(c.name for c in numbers), *(" + ".join(pair) for pair in pairs)])
    stamps = [c for c in numbers if _HEADER_STAMP.search(c.name)]
    numbers = stamps if len(stamps) == 1 else numbers
    instants = [
        c for c in table.columns if c.kind == "instant" and _steps(head[c.name]) is not None
    ]
    with_unit = [c for c in numbers if _time_unit(c)]
    if len(numbers) == 1 and with_unit:
        return _of_number(numbers[0], _steps(head[numbers[0].name]))
    if not numbers and instants:
        finest = min(instants, key=lambda c: _steps(head[c.name]) or np.inf)
        return Entry("time_s", written(finest.name), "dates or times of day"), []
    if len(instants) == 1 and not with_unit:
        return Entry("time_s", written(instants[0].name), "dates or times of day"), []
    if len(numbers) == 1:
        epoch = _since_1970(numbers[0], head[numbers[0].name])
        return (epoch, []) if epoch else _of_number(numbers[0], _steps(head[numbers[0].name]))
    if numbers:
        return _one_of([c.name for c in numbers])
    if table.rate_hz is not None:
        return None, []
    question = (
        "no column contains it; name the column, or set rate_hz (samples per second) "
        "under [file], or steady = true for steady states (a Stribeck curve)"
    )
    return None, [Question("time_s", question)]


def _one_of(candidates: Sequence[str]) -> Found:
    """Open question which of several time columns is that of the recording."""
    names = ", ".join(candidates)
    question = f"which of these is it: {names}? Those of other channels belong under [clocks]"
    return Entry("time_s", OPEN, f"one of: {names}", sure=False), [Question("time_s", question)]


def _stamps_in_two_columns(table: Table, head: Mapping[str, Values]) -> list[tuple[str, str]]:
    """Pairs of columns with the seconds and the nanoseconds of a time stamp, as in ROS logs."""
    parts: dict[tuple[str, bool], str] = {}
    for column in table.columns:
        match = _PART.fullmatch(column.name)
        part = "" if match is None or column.kind != "number" else match["part"].lower()
        if part in (*SECONDS, *NANOSECONDS):
            lead = column.name[: -len(part)]
            parts.setdefault((lead, part in SECONDS), column.name)
    pairs = [(name, parts.get((lead, False))) for (lead, whole), name in parts.items() if whole]
    return [
        (seconds, nanoseconds)
        for seconds, nanoseconds in pairs
        if nanoseconds is not None and _runs_forward(head[seconds] + head[nanoseconds] / 1e9)
    ]


def time_by_motion(
    entries: Mapping[str, Entry], tables: Sequence[Table], heads: Mapping[str, Values]
) -> Entry | None:
    """Determine an open time unit by the agreement of speed and change of position.

    Returns the entry if exactly one unit fits, else None. Position and speed without units are
    assumed to be in corresponding units, such as rad and rad/s. The ratio of other pairs of units
    is not 1000, the factor between units of time.
    """
    time = entries.get("time_s")
    if time is None or time.sure or not time.expression.endswith(f"[{OPEN}]"):
        return None
    fitting = {}
    for pair in PAIRS:
        if not all(key in entries for key in pair):
            continue
        certain = [entries[key].sure for key in pair]
        if any(certain) != all(certain):
            continue
        assumed = {key: _with_column_unit(entries[key]) for key in pair}
        for unit in ("s", "ms", "us", "min"):
            text = time.expression.replace(OPEN, unit)
            trial = replace(
                time, expression=text, why=f"speed and position agree in {unit}", sure=True
            )
            ratio = speed_ratio({**entries, **assumed, "time_s": trial}, pair, tables, heads)
            if ratio is not None and 1.0 / MAX_RATIO < ratio < MAX_RATIO:
                fitting[unit] = trial
    return fitting.popitem()[1] if len(fitting) == 1 else None


def _with_column_unit(entry: Entry) -> Entry:
    """Map entry with its open unit replaced by the unit of its run column."""
    unit = wanted_unit(entry.key).text
    return replace(entry, expression=entry.expression.replace(f"[{OPEN}]", f"[{unit}]"))


def is_doubtful_time(header: Header) -> bool:
    """Whether a header is a time in `m`, which may mean minutes or milliseconds."""
    return header.kind == "time" and header.unit == "m"


def _is_time(column: Column) -> bool:
    """Whether the header or the kind of a column is that of a time."""
    if column.kind != "number":
        return False
    header = parse_header(column.name, column.unit)
    unit = parse_unit(header.unit)
    if header.setpoint:
        return False
    if is_doubtful_time(header):
        return True
    if header.kind == "time":
        return unit is None or unit.dimensions == TIME or header.sure
    return header.kind is None and unit is not None and unit.dimensions == TIME


def _time_unit(column: Column) -> bool:
    """Whether the unit of a column is a unit of time."""
    unit = parse_unit(parse_header(column.name, column.unit).unit)
    return unit is not None and unit.dimensions == TIME


def _of_number(column: Column, step: float | None = None) -> Found:
    """Map entry and questions for a numeric time column; `step` is its median step."""
    header = parse_header(column.name, column.unit)
    if _time_unit(column):
        in_name = parse_header(column.name).unit
        text = written(column.name) + ("" if in_name else f" [{column.unit}]")
        unit = parse_unit(header.unit)
        if step is not None and unit is not None and step * unit.in_si < SHORTEST_S:
            question = (
                f"the times of {text} would be {step * unit.in_si:.2g} s apart, which "
                "is not plausible: write its unit after the column"
            )
            open_text = f"{written(header.name)} [{OPEN}]"
            entry = Entry("time_s", open_text, "by name", sure=False)
            return entry, [Question(column.name, question)]
        return Entry("time_s", text, "by name and unit"), []
    if header.unit:
        question = (
            f"{header.unit} is not a unit of time; write one such as [min] or [ms] after the column"
        )
    else:
        question = "it has no unit; write [s], [ms] or [us] after the column"
        if step is not None:
            question += f" (it increases by {step:.4g} per row)"
    entry = Entry("time_s", f"{written(column.name)} [{OPEN}]", "by name", sure=False)
    return entry, [Question(column.name, question)]


def _since_1970(column: Column, values: Values) -> Entry | None:
    """Map entry for a time column without a unit whose values count from 1970; None otherwise.

    The magnitude of the values must fit the years 2000 to 2100 in one of s, ms, us and ns.
    """
    times = np.asarray(values, dtype=np.float64)
    times = times[np.isfinite(times)]
    if parse_header(column.name, column.unit).unit or not times.size:
        return None
    for unit, size in (("s", 1.0), ("ms", 1e3), ("us", 1e6), ("ns", 1e9)):
        if _FROM_S * size < times.min() and times.max() < _TO_S * size:
            why = f"{unit} since 1970, from the magnitude"
            return Entry("time_s", f"{written(column.name)} [{unit}]", why)
    return None


def _runs_forward(values: Values) -> bool:
    """Whether a column may be a time: it increases, except where a recording restarts."""
    times = np.asarray(values, dtype=np.float64)
    steps = np.diff(times[np.isfinite(times)])
    steps = steps[steps != 0.0]
    if len(times) < MIN_TESTED_ROWS:
        return True
    return bool(len(steps) and np.mean(steps > 0.0) > MIN_FORWARD_SHARE)


def _steps(values: Values) -> float | None:
    """Median step of an increasing column; None if it does not increase."""
    steps = np.diff(np.asarray(values, dtype=np.float64))
    grows = steps[steps > 0.0]
    return float(np.median(grows)) if grows.size > 0.5 * max(steps.size, 1) else None
