"""TDMS, by npTDMS: channels with a waveform's increment have a clock of their own."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from nptdms import TdmsFile

from jbf.errors import InputError
from jbf.importing.formats.arrays import ArraySource, Slice
from jbf.importing.formats.table import Options, Source

CLOCK = "time"
Group = tuple[str, int, float | None, float]
"""Name, samples, seconds from sample to sample, first instant."""


def open_tdms(path: Path, options: Options) -> Source:
    """Open a TDMS file."""
    file = TdmsFile.open(path)
    source = ArraySource(path, file.close)
    found: dict[Group, dict[str, tuple[Slice, str]]] = {}
    starts: dict[Group, str | None] = {}
    for group in file.groups():
        for channel in group.channels():
            if len(channel) < 2 or channel.data_type is None:
                continue
            told = channel.properties
            step = told.get("wf_increment")
            key: Group = (
                group.name,
                len(channel),
                float(step) if step else None,
                float(told.get("wf_start_offset", 0.0)),
            )
            unit = str(told.get("unit_string", "") or told.get("NI_UnitDescription", ""))
            found.setdefault(key, {})[channel.name] = (_read(channel), unit)
            start = told.get("wf_start_time")
            starts.setdefault(key, None if start is None else str(start))
    names = [key[0] for key in found]
    for key, columns in found.items():
        name, length, step_s, first_s = key
        clock = None
        if step_s is not None:
            clock = CLOCK
            columns = {CLOCK: (_even(step_s, first_s), "s"), **columns}
        if names.count(name) > 1:
            name = f"{name} {length} samples" + ("" if step_s is None else f" of {step_s:g} s")
        source.add(name if len(found) > 1 else "", columns, length, clock, starts[key])
    if not source.tables:
        raise InputError(file=path, problem="holds no channels of numbers", mend="name another")
    return source


def _read(channel: Any) -> Slice:
    return lambda first, end: channel.read_data(offset=first, length=end - first)


def _even(step_s: float, first_s: float) -> Slice:
    # A division where the rate is whole: 1/50 s is no number, 50 Hz is.
    rate = round(1.0 / step_s)
    whole = rate > 0 and 1.0 / rate == step_s
    return lambda first, end: (
        first_s + np.arange(first, end) / rate
        if whole
        else first_s + np.arange(first, end) * step_s
    )
