"""A speed to cut by: the one that was recorded, or the change of the place over a window."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

from jbf.errors import InputError
from jbf.importing.spool import Recording, Stream
from jbf.importing.targets import MOTION

Array = npt.NDArray[np.float64]

_SPEEDS = tuple(key for key in MOTION if "velocity" in key or "speed" in key)
_PLACES = tuple(key for key in MOTION if key not in _SPEEDS)
_FEW = 1_000


class MotionSpeed:
    """The speed of a recording, block by block, smoothed over a window.

    Attributes
    ----------
    stream
        Where it is.
    """

    def __init__(self, recording: Recording, window_s: float) -> None:
        found = recording.stream_of(*_SPEEDS) or recording.stream_of(*_PLACES)
        if found is None:
            raise InputError(
                file=recording.path,
                problem="holds no value of a place or a speed",
                mend="name another column in the map",
            )
        self.stream: Stream = found[0]
        self.key = found[1]
        self.recorded = self.key in _SPEEDS
        self._column = self.stream.columns.index(self.key)
        first, end = max(self.stream.segments, key=lambda s: s[1] - s[0])
        times = self.stream.read(first, min(end, first + _FEW))[:, 0]
        step = float(np.median(np.diff(times))) if len(times) > 1 else 1.0
        self.half = max(1, round(0.5 * window_s / step))

    def blocks(self, segment: int) -> Iterator[tuple[int, Array, Array]]:
        """First row, times, and speeds of each block of a segment."""
        first, end = self.stream.segments[segment]
        for begin, inside, rows in self.stream.overlapping(first, end, self.half):
            times, values = rows[:, 0], _filled(rows[:, self._column])
            speed = values if self.recorded else _change(times, values, self.half)
            size = _block(end, begin, len(rows), inside, self.half)
            yield begin, times[inside : inside + size], speed[inside : inside + size]

    def smoothed(self, segment: int) -> Iterator[tuple[int, Array, Array]]:
        """The same with the mean size of the speed over the window in its place."""
        first, end = self.stream.segments[segment]
        for begin, inside, rows in self.stream.overlapping(first, end, 2 * self.half):
            times, values = rows[:, 0], _filled(rows[:, self._column])
            speed = np.abs(values if self.recorded else _change(times, values, self.half))
            mean = _mean(speed, self.half if self.recorded else 0)
            size = _block(end, begin, len(rows), inside, 2 * self.half)
            yield begin, times[inside : inside + size], mean[inside : inside + size]

    def top(self) -> float:
        """The largest size of the speed."""
        sizes = [
            float(np.max(speed, initial=0.0))
            for segment in range(len(self.stream.segments))
            for _, _, speed in self.smoothed(segment)
        ]
        return max(sizes, default=0.0)

    def noise(self) -> float:
        """The white noise of a recorded speed, by its second differences; the median of blocks."""
        if not self.recorded:
            return 0.0
        sizes = []
        for segment in range(len(self.stream.segments)):
            for _, _, speed in self.blocks(segment):
                second = np.diff(speed, 2)
                if second.size:
                    # 0.6745: a normal deviate's median size; 6: what second differences multiply.
                    sizes.append(float(np.median(np.abs(second))) / (0.6745 * 6.0**0.5))
        return float(np.median(sizes)) if sizes else 0.0


def _block(end: int, begin: int, rows: int, inside: int, margin: int) -> int:
    """Rows of the block proper."""
    after = rows - inside
    return after if begin + after >= end else after - margin


def _filled(values: Array) -> Array:
    """Gaps take the value before them."""
    bad = np.isnan(values)
    if not bad.any():
        return values
    good = np.flatnonzero(~bad)
    if not good.size:
        return np.zeros_like(values)
    place = np.maximum(np.searchsorted(good, np.arange(len(values)), side="right") - 1, 0)
    filled: Array = values[good[place]]
    return filled


def _change(times: Array, values: Array, half: int) -> Array:
    """Change of the place from `half` rows before to `half` after, over its time."""
    rows = np.arange(len(times))
    low, high = np.maximum(rows - half, 0), np.minimum(rows + half, len(times) - 1)
    elapsed = times[high] - times[low]
    change = values[high] - values[low]
    speed: Array = np.divide(change, elapsed, out=np.zeros_like(change), where=elapsed > 0.0)
    return speed


def _mean(values: Array, half: int) -> Array:
    if half == 0:
        return values
    total = np.concatenate(([0.0], np.cumsum(values)))
    rows = np.arange(len(values))
    low, high = np.maximum(rows - half, 0), np.minimum(rows + half + 1, len(values))
    mean: Array = (total[high] - total[low]) / (high - low)
    return mean
