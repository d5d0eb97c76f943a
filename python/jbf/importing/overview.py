"""Reduction of a recording to minimum and maximum in a few hundred intervals, for plots."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jbf.arrays import Array
from jbf.importing.cutting.load_steps import LOADS
from jbf.importing.formats.table import BLOCK
from jbf.importing.spool import Recording, Stream
from jbf.importing.targets import FRICTION, MOTION

_POINTS = 1_200


@dataclass(frozen=True, eq=False)
class Overview:
    """Reduced data of a recording for a plot.

    Attributes
    ----------
    file
        Name of the file.
    starts_s
        Time added to the times of each segment of increasing time, s, so that segments follow one
        another.
    curves
        Time, minimum and maximum by column, each of shape (points,).
    """

    file: str
    starts_s: tuple[float, ...]
    curves: dict[str, tuple[Array, Array, Array]]


def overview(recording: Recording) -> Overview:
    """Reduce the friction, motion and load of a recording for a plot."""
    starts, offset = [], 0.0
    stream = recording.streams[0]
    for first, end in stream.segments:
        begin = stream.at(first)
        starts.append(offset - begin if offset else 0.0)
        offset = max(offset, begin + starts[-1]) + stream.at(end - 1) - begin
    curves = {}
    for keys in (FRICTION, MOTION, LOADS):
        stream_and_column = recording.stream_of(*keys)
        if stream_and_column is not None:
            curves[stream_and_column[1]] = _curve(*stream_and_column, starts)
    return Overview(recording.path.name, tuple(starts), curves)


def _curve(stream: Stream, key: str, starts: list[float]) -> tuple[Array, Array, Array]:
    """Time, minimum and maximum of a column in each interval, shape (points,) each."""
    column = stream.columns.index(key)
    size = max(stream.rows // _POINTS, 1)
    points: list[tuple[float, float, float]] = []
    for (first, end), start in zip(stream.segments, starts, strict=True):
        for rows in stream.blocks(first, end, size=size * max(1, BLOCK // size)):
            for at in range(0, len(rows), size):
                part = rows[at : at + size]
                values = part[np.isfinite(part[:, column]), column]
                if values.size:
                    points.append((part[0, 0] + start, float(values.min()), float(values.max())))
        points.append((np.nan, np.nan, np.nan))
    times, low, high = np.array(points).T
    return times, low, high
