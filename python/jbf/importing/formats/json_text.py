"""JSON and JSON lines: records of numbers, or arrays of equal length.

Samples are searched at any depth: a list of records (one row each), or a mapping of arrays (one
column each). If a list holds several such mappings, one for each recording, their rows are
concatenated, and the column `run` numbers them. JSON lines are a list of records.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from jbf.errors import InputError
from jbf.importing.formats.arrays import ArraySource, slices
from jbf.importing.formats.messages import LONGEST, leaves_of, nanoseconds
from jbf.importing.formats.table import MAX_DAMAGED_SHARE, Options, Source, unique
from jbf.text_files import read_text

SETTINGS = ("config", "settings", "meta", "metadata", "header", "info", "sampling", "recording")
"""Keys of mappings that may state the sampling rate of neighbouring arrays."""
RATES = ("hz", "rate_hz", "fs", "fs_hz", "sample_rate", "sampling_rate", "sample_rate_hz")
"""Keys of a sampling rate, Hz."""
FEWEST = 3
"""Minimum number of samples for a list of numbers to be a column."""
Columns = dict[str, npt.NDArray[Any]]


def open_json(path: Path, options: Options) -> Source:
    """Open a file of JSON or of JSON lines as a source of tables."""
    content, torn = _content(path)
    source = ArraySource(path)
    entries = list(_tables(content, "", options.rate_hz))
    source.passed_over = torn
    names = unique([name for name, _, _ in entries])
    for called, (_, columns, rate_hz) in zip(names, entries, strict=True):
        rows = max(map(len, columns.values()))
        table_columns = {key: (slices(values), "") for key, values in columns.items()}
        source.add(called if len(entries) > 1 else "", table_columns, rows, rate_hz=rate_hz)
    if not source.tables:
        raise InputError(
            file=path, problem="contains no records and no numeric arrays", remedy="write CSV"
        )
    return source


def _content(path: Path) -> tuple[Any, list[tuple[int, str, int | None]]]:
    """Content of a JSON file (a list for JSON lines), and the invalid lines that were skipped."""
    text = read_text(path)
    try:
        return json.loads(text), []
    except json.JSONDecodeError as whole:
        records, torn = [], list[tuple[int, str]]()
        for number, line in enumerate(text.splitlines(), 1):
            if not line.strip():
                continue
            try:
                records.append(json.loads(line))
            except json.JSONDecodeError as error:
                torn.append((number, error.msg))
        if len(torn) > max(MAX_DAMAGED_SHARE * len(records), 1.0) or len(records) < FEWEST:
            row, reason = torn[0] if len(records) > len(torn) else (whole.lineno, whole.msg)
            raise InputError(
                file=path,
                row=row,
                problem=f"is not valid JSON ({reason})",
                remedy="correct it, or write CSV",
            ) from None
        why = [(len(torn), f"the line is truncated ({reason})", row) for row, reason in torn[:1]]
        return records, list(why)


def _tables(
    content: Any, name: str, rate_hz: float | None
) -> Iterator[tuple[str, Columns, float | None]]:
    """Yield name, columns and sampling rate (Hz) of each table in a JSON value."""
    if isinstance(content, Mapping):
        for holder in (*(content.get(key) for key in SETTINGS), content):
            rates = [holder.get(k) for k in RATES] if isinstance(holder, Mapping) else []
            rate_hz = next((float(r) for r in rates if r is not None and _is_number(r)), rate_hz)
        columns = _columns(content)
        if columns:
            yield name, columns, rate_hz
        for key, value in content.items():
            if key not in columns:
                yield from _tables(value, str(key) if not name else f"{name}.{key}", rate_hz)
    elif isinstance(content, list) and content and all(isinstance(r, Mapping) for r in content):
        recordings = [{} if _is_row(record) else _columns(record) for record in content]
        if all(recordings) and len({tuple(columns) for columns in recordings}) == 1:
            yield name, _concatenated(recordings), rate_hz
        elif any(recordings):
            for at, record in enumerate(content):
                yield from _tables(record, f"{name}[{at}]", rate_hz)
        else:
            columns = _columns_of_records(content)
            if columns and len(content) >= FEWEST:
                yield name, columns, rate_hz


def _columns(content: Mapping[str, Any]) -> Columns:
    """Numeric arrays of the most common length, by name; matrices are split into columns."""
    arrays: Columns = {}
    for key, value in content.items():
        if not isinstance(value, list) or len(value) < FEWEST:
            continue
        if all(map(_is_number, value)):
            arrays[key] = _numbers(value)
        elif all(isinstance(row, list) and row and all(map(_is_number, row)) for row in value):
            width = min(map(len, value))
            arrays |= {f"{key}[{k}]": _numbers([row[k] for row in value]) for k in range(width)}
    lengths = [len(values) for values in arrays.values()]
    common_length = max(lengths, key=lengths.count, default=0)
    return {key: values for key, values in arrays.items() if len(values) == common_length}


def _is_row(record: Mapping[str, Any]) -> bool:
    """Whether a record is one sample: it has scalar numbers, and its arrays are short."""
    arrays = [value for value in record.values() if isinstance(value, list)]
    scalars = {k: v for k, v in record.items() if not isinstance(v, list) and k not in RATES}
    return max(map(len, arrays), default=0) <= LONGEST and any(True for _ in leaves_of(scalars))


def _concatenated(recordings: Sequence[Columns]) -> Columns:
    """Concatenate recordings with equal columns, and number them in the column `run`."""
    joined: Columns = {
        key: np.concatenate([columns[key] for columns in recordings]) for key in recordings[0]
    }
    counts = [len(next(iter(columns.values()))) for columns in recordings]
    if len(recordings) > 1:
        joined["run" if "run" not in joined else "recording"] = np.repeat(
            np.arange(1.0, len(counts) + 1.0), counts
        )
    return joined


def _columns_of_records(records: Sequence[Any]) -> Columns:
    """Columns of a list of records; NaN where a record lacks a value."""
    rows = [dict(leaves_of(record)) for record in records]
    keys = dict.fromkeys(key for row in rows for key in row)
    return {key: _numbers([row.get(key) for row in rows]) for key in keys}


def _is_number(value: Any) -> bool:
    return value is None or (isinstance(value, int | float) and not isinstance(value, bool))


def _numbers(values: Sequence[Any]) -> npt.NDArray[Any]:
    numbers = [
        nanoseconds(value) / 1e9
        if isinstance(value, Mapping)
        else np.nan
        if value is None
        else value
        for value in values
    ]
    array = np.array(numbers)
    return array if array.dtype.kind == "i" else np.array(numbers, dtype=np.float64)
