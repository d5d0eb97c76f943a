"""Cuts at steps of the load between two constant levels."""

from __future__ import annotations

import numpy as np

from jbf.errors import InputError
from jbf.importing.cutting.piece import Cut
from jbf.importing.spool import Recording, Stream

LOADS = ("load_n", "load_n_m", "pressure_pa")
_PARTS = 20
"""Number of rows whose median gives one point of the load curve."""
_STEP = 0.05
"""Minimum size of a step, as a share of the larger level."""
_SIGMAS = 8.0
"""Minimum size of a step, in standard deviations of the differences between neighbouring points."""


def cut_at_load_steps(recording: Recording) -> list[Cut]:
    """Cuts at each step of `load_n`, `load_n_m` or `pressure_pa`.

    Raises
    ------
    InputError
        If none of these columns was recorded.
    """
    load_stream = recording.stream_of(*LOADS)
    if load_stream is None:
        raise InputError(
            key="cut.by",
            problem="load_step requires load_n, load_n_m or pressure_pa",
            remedy="name the column under [columns]",
        )
    stream, key = load_stream
    return [
        cut
        for segment in range(len(stream.segments))
        for cut in _steps(stream, segment, stream.columns.index(key))
    ]


def _steps(stream: Stream, segment: int, column: int) -> list[Cut]:
    """Cuts at the steps of one load column within a segment."""
    first, end = stream.segments[segment]
    parts = [
        np.nanmedian(block[at : at + _PARTS, column])
        for block in stream.blocks(first, end, size=_PARTS * 2_000)
        for at in range(0, len(block), _PARTS)
        if np.isfinite(block[at : at + _PARTS, column]).any()
    ]
    level = np.array(parts)
    if len(level) < 4:
        return []
    noise = float(np.median(np.abs(np.diff(level)))) / 0.6745
    cuts: list[Cut] = []
    since = 0
    for at in range(1, len(level) - 1):
        before = float(np.median(level[since:at]))
        threshold = max(_STEP * max(abs(before), abs(float(level[at]))), _SIGMAS * noise)
        # The new level must persist: the point at the step itself lies between the levels.
        after = level[at : at + 2]
        if np.all(np.abs(after - before) > threshold) and abs(after[1] - after[0]) < threshold:
            row = _edge(stream, first, end, at, column, before, float(after[1]))
            why = f"the load changes from {before:.4g} to {after[1]:.4g}"
            cuts.append(Cut(segment, stream.at(row - 1), stream.at(row), why))
            since = at
    return cuts


def _edge(
    stream: Stream, first: int, end: int, part: int, column: int, before: float, after: float
) -> int:
    """First row of a load step that is nearer to the new level than to the old one."""
    low = max(first + (part - 1) * _PARTS, first + 1)
    values = stream.read(low, min(first + (part + 1) * _PARTS, end))[:, column]
    nearer = np.abs(values - after) < np.abs(values - before)
    return low + (int(np.argmax(nearer)) if nearer.any() else _PARTS)
