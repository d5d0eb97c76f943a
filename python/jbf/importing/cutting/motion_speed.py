"""Speed for the cutting methods: recorded, or the change of position over a window."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from jbf.arrays import Array
from jbf.errors import InputError
from jbf.importing.spool import Recording, Stream
from jbf.importing.targets import MOTION

_SPEEDS = tuple(key for key in MOTION if "velocity" in key or "speed" in key)
_PLACES = tuple(key for key in MOTION if key not in _SPEEDS)
_FEW = 1_000


class MotionSpeed:
    """Speed of a recording, read block by block over a smoothing window.

    Attributes
    ----------
    stream
        Stream that contains the speed or position.
    """

    def __init__(self, recording: Recording, window_s: float) -> None:
        motion_stream = recording.stream_of(*_SPEEDS) or recording.stream_of(*_PLACES)
        if motion_stream is None:
            raise InputError(
                file=recording.path,
                problem="contains no position and no speed",
                remedy="name another column in the map",
            )
        self.stream: Stream = motion_stream[0]
        self.key = motion_stream[1]
        self.recorded = self.key in _SPEEDS
        self._column = self.stream.columns.index(self.key)
        first, end = max(self.stream.segments, key=lambda s: s[1] - s[0])
        times = self.stream.read(first, min(end, first + _FEW))[:, 0]
        step = float(np.median(np.diff(times))) if len(times) > 1 else 1.0
        self.half = max(1, round(0.5 * window_s / step))

    def blocks(self, segment: int) -> Iterator[tuple[int, Array, Array]]:
        """Yield index of the first row, times and speeds of each block of a segment."""
        first, end = self.stream.segments[segment]
        for begin, inside, rows in self.stream.overlapping(first, end, self.half):
            times, values = rows[:, 0], _filled(rows[:, self._column])
            speed = values if self.recorded else _change(times, values, self.half)
            size = _block(end, begin, len(rows), inside, self.half)
            yield begin, times[inside : inside + size], speed[inside : inside + size]

    def smoothed(self, segment: int) -> Iterator[tuple[int, Array, Array]]:
        """Yield index of the first row, times and smoothed absolute speed of each block."""
        first, end = self.stream.segments[segment]
        for begin, inside, rows in self.stream.overlapping(first, end, 2 * self.half):
            times, values = rows[:, 0], _filled(rows[:, self._column])
            speed = np.abs(values if self.recorded else _change(times, values, self.half))
            mean = _mean(speed, self.half if self.recorded else 0)
            size = _block(end, begin, len(rows), inside, 2 * self.half)
            yield begin, times[inside : inside + size], mean[inside : inside + size]

    def top(self) -> float:
        """Largest smoothed absolute speed of the recording."""
        sizes = [
            float(np.max(speed, initial=0.0))
            for segment in range(len(self.stream.segments))
            for _, _, speed in self.smoothed(segment)
        ]
        return max(sizes, default=0.0)

    def noise(self) -> float:
        """White noise of a recorded speed, from second differences (median over blocks)."""
        if not self.recorded:
            return 0.0
        sizes = []
        for segment in range(len(self.stream.segments)):
            for _, _, speed in self.blocks(segment):
                second = np.diff(speed, 2)
                if second.size:
                    # 0.6745: median of |N(0, 1)|; sqrt(6): noise gain of second differences.
                    sizes.append(float(np.median(np.abs(second))) / (0.6745 * 6.0**0.5))
        return float(np.median(sizes)) if sizes else 0.0


def _block(end: int, begin: int, rows: int, inside: int, margin: int) -> int:
    """Number of rows of a block without its margins."""
    after = rows - inside
    return after if begin + after >= end else after - margin


def _filled(values: Array) -> Array:
    """Fill each gap in an array with the value before it."""
    bad = np.isnan(values)
    if not bad.any():
        return values
    finite = np.flatnonzero(~bad)
    if not finite.size:
        return np.zeros_like(values)
    place = np.maximum(np.searchsorted(finite, np.arange(len(values)), side="right") - 1, 0)
    filled: Array = values[finite[place]]
    return filled


def _change(times: Array, values: Array, half: int) -> Array:
    """Mean rate of change of a position from `half` rows before to `half` rows after each row."""
    rows = np.arange(len(times))
    low, high = np.maximum(rows - half, 0), np.minimum(rows + half, len(times) - 1)
    elapsed = times[high] - times[low]
    change = values[high] - values[low]
    speed: Array = np.divide(change, elapsed, out=np.zeros_like(change), where=elapsed > 0.0)
    return speed


def _mean(values: Array, half: int) -> Array:
    """Moving mean over `half` rows on either side."""
    if half == 0:
        return values
    total = np.concatenate(([0.0], np.cumsum(values)))
    rows = np.arange(len(values))
    low, high = np.maximum(rows - half, 0), np.minimum(rows + half + 1, len(values))
    mean: Array = (total[high] - total[low]) / (high - low)
    return mean
