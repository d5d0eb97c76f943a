"""Reduction of a record to the resolution of a screen: minimum and maximum per pixel.

Short peaks are preserved, because the drawn range contains all measured values.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from jbf.arrays import Array


@dataclass(frozen=True)
class Stretch:
    """Section of a record, in groups of samples with one group per pixel.

    Attributes
    ----------
    first, end
        First sample, and end (exclusive).
    pixels
        Number of groups.
    """

    first: int
    end: int
    pixels: int

    @property
    def stride(self) -> int:
        """Number of samples per pixel; one if each sample can be shown."""
        return max(-(-(self.end - self.first) // self.pixels), 1)

    @classmethod
    def between(cls, time_s: Array, from_s: float, to_s: float, pixels: int) -> Stretch:
        """Section of a record between two instants.

        One more sample at each end makes lines continuous.
        """
        first = max(int(np.searchsorted(time_s, from_s)) - 1, 0)
        end = min(int(np.searchsorted(time_s, to_s, side="right")) + 1, len(time_s))
        return cls(first, max(end, first), max(pixels, 1))


def stretch_of(time_s: Array, span: tuple[float | None, float | None], pixels: int) -> Stretch:
    """Section of a record for an interval, s, in which None is an open end."""
    begin, end = span
    return Stretch.between(
        time_s,
        float(time_s[0] if begin is None else begin),
        float(time_s[-1] if end is None else end),
        pixels,
    )


def thinned(time_s: Array, columns: Mapping[str, Array], stretch: Stretch) -> dict[str, Array]:
    """Reduce a section of a record to two points per pixel, unless it has few samples.

    Returns
    -------
    dict
        `time_s`, and each column with the smallest and the largest value of each group in turn;
        NaN where a group has no finite value.
    """
    part = slice(stretch.first, stretch.end)
    stride = stretch.stride
    if stride <= 2:
        return {"time_s": time_s[part], **{k: v[part] for k, v in columns.items()}}
    starts = np.arange(stretch.first, stretch.end, stride)
    # Both points of a pixel lie in its middle half, smallest first: a line through them is a bar.
    last = np.minimum(starts + stride, stretch.end) - 1
    begin, end = time_s[starts], time_s[last]
    quarter = 0.25 * (end - begin)
    reduced = {"time_s": np.column_stack([begin + quarter, end - quarter]).ravel()}
    for name, values in columns.items():
        low = np.fmin.reduceat(values[part], starts - stretch.first)
        high = np.fmax.reduceat(values[part], starts - stretch.first)
        reduced[name] = np.column_stack([low, high]).ravel()
    return reduced


def ranges_of(mask: npt.NDArray[np.bool_], limit: int = 400) -> list[tuple[int, int]]:
    """First sample and end (exclusive) of each interval in which a mask is True.

    Intervals with the smallest gaps are merged until at most `limit` remain.
    """
    edges = np.flatnonzero(np.diff(np.concatenate([[False], mask, [False]]).astype(np.int8)))
    first, end = edges[::2], edges[1::2]
    if len(first) > limit:
        gaps = first[1:] - end[:-1]
        wide = np.sort(np.argpartition(-gaps, limit - 1)[: limit - 1])
        first, end = first[np.append(0, wide + 1)], end[np.append(wide, len(end) - 1)]
    return [(int(a), int(b)) for a, b in zip(first, end, strict=True)]
