"""A record in as many points as a screen can show: the least and the largest of each pixel.

No excursion is lost, however short: what is drawn covers what was measured.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Stretch:
    """Samples from `first` to before `end`, in `pixels` groups of `stride`."""

    first: int
    end: int
    pixels: int

    @property
    def stride(self) -> int:
        """Samples a pixel; one where each can be shown."""
        return max(-(-(self.end - self.first) // self.pixels), 1)

    @classmethod
    def between(cls, time_s: Array, from_s: float, to_s: float, pixels: int) -> Stretch:
        """The samples between two instants, with one more at either end so that lines go on."""
        first = max(int(np.searchsorted(time_s, from_s)) - 1, 0)
        end = min(int(np.searchsorted(time_s, to_s, side="right")) + 1, len(time_s))
        return cls(first, max(end, first), max(pixels, 1))


def thinned(time_s: Array, columns: Mapping[str, Array], stretch: Stretch) -> dict[str, Array]:
    """Time and columns in two points a pixel, or as they are where they are few.

    Returns
    -------
    dict
        `time_s`, and each column with its least and its largest value of each group in turn; nan
        where a group has no number.
    """
    part = slice(stretch.first, stretch.end)
    stride = stretch.stride
    if stride <= 2:
        return {"time_s": time_s[part], **{k: v[part] for k, v in columns.items()}}
    starts = np.arange(stretch.first, stretch.end, stride)
    # Both points of a pixel stand in its middle half, least first: a line through them is a bar.
    last = np.minimum(starts + stride, stretch.end) - 1
    begin, close = time_s[starts], time_s[last]
    quarter = 0.25 * (close - begin)
    found = {"time_s": np.column_stack([begin + quarter, close - quarter]).ravel()}
    for name, values in columns.items():
        low = np.fmin.reduceat(values[part], starts - stretch.first)
        high = np.fmax.reduceat(values[part], starts - stretch.first)
        found[name] = np.column_stack([low, high]).ravel()
    return found


def ranges_of(mask: npt.NDArray[np.bool_], most: int = 400) -> list[tuple[int, int]]:
    """Where a mask is true: first sample and the one after the last, of each stretch.

    Stretches with the least between them are joined until there are no more than `most`.
    """
    edges = np.flatnonzero(np.diff(np.concatenate([[False], mask, [False]]).astype(np.int8)))
    first, end = edges[::2], edges[1::2]
    if len(first) > most:
        gaps = first[1:] - end[:-1]
        wide = np.sort(np.argpartition(-gaps, most - 1)[: most - 1])
        first, end = first[np.append(0, wide + 1)], end[np.append(wide, len(end) - 1)]
    return [(int(a), int(b)) for a, b in zip(first, end, strict=True)]
