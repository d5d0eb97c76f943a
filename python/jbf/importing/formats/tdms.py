"""TDMS files, read by npTDMS; channels with a waveform increment have their own times."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from nptdms import TdmsFile

from jbf.errors import InputError
from jbf.importing.formats.arrays import ArraySource, Slice
from jbf.importing.formats.table import Options, Source

CLOCK = "time"
Group = tuple[str, int, float | None, float, str]
"""Name, number of samples, sampling interval (s), first time (s), and date of the origin."""


def open_tdms(path: Path, options: Options) -> Source:
    """Open a TDMS file as a source of tables."""
    file = TdmsFile.open(path)
    source = ArraySource(path, file.close)
    groups: dict[Group, dict[str, tuple[Slice, str]]] = {}
    starts: dict[Group, np.datetime64] = {}
    for group in file.groups():
        for channel in group.channels():
            if len(channel) < 2 or channel.data_type is None:
                continue
            properties = channel.properties
            step = properties.get("wf_increment")
            key: Group = (
                group.name,
                len(channel),
                float(step) if step else None,
                float(properties.get("wf_start_offset", 0.0)),
                str(properties.get("wf_start_time", "") if step else ""),
            )
            unit = str(
                properties.get("unit_string", "") or properties.get("NI_UnitDescription", "")
            )
            groups.setdefault(key, {})[channel.name] = (_read(channel), unit)
            if key[4]:
                starts[key] = np.datetime64(properties["wf_start_time"])
    names = [key[0] for key in groups]
    first = min(starts.values(), default=None)
    for key, columns in groups.items():
        name, length, step_s, first_s, _ = key
        clock = None
        if key in starts and first is not None:
            # Preserve the time differences between waveforms with different start times.
            first_s += float((starts[key] - first) / np.timedelta64(1, "ns")) / 1e9
        if step_s is not None:
            clock = CLOCK
            columns = {CLOCK: (_even(step_s, first_s), "s"), **columns}
        if names.count(name) > 1:
            # Add the channels to the name, since they are unique in a group.
            name = f"{name}: {', '.join(c for c in columns if c != CLOCK)}"
        date = None if key not in starts else str(first)
        source.add(name if len(groups) > 1 else "", columns, length, clock, date)
    if not source.tables:
        raise InputError(
            file=path, problem="contains no numeric channels", remedy="name another file"
        )
    return source


def _read(channel: Any) -> Slice:
    return lambda first, end: channel.read_data(offset=first, length=end - first)


def _even(step_s: float, first_s: float) -> Slice:
    # Divide by a whole rate: 50 Hz is exact in floating point, 1/50 s is not.
    rate = round(1.0 / step_s)
    integer_rate = rate > 0 and 1.0 / rate == step_s
    return lambda first, end: (
        first_s + np.arange(first, end) / rate
        if integer_rate
        else first_s + np.arange(first, end) * step_s
    )
