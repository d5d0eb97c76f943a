"""Unwrapping of angles that restart at each turn."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from jbf.arrays import Array
from jbf.importing.spool import Stream

_ANGLES = ("angle_rad", "motor_angle_rad")
_TURN = 2.0 * math.pi


def unwrapped(stream: Stream) -> list[str]:
    """Unwrap each angle of a stream that is limited to one turn; return notes on the changes."""
    notes = []
    for key in _ANGLES:
        if key not in stream.columns:
            continue
        column = stream.columns.index(key)
        low, high, jumps, last = math.inf, -math.inf, 0, math.nan
        for block in stream.blocks():
            values = block[:, column][np.isfinite(block[:, column])]
            if not values.size:
                continue
            low, high = min(low, float(values.min())), max(high, float(values.max()))
            jumps += int((np.abs(np.diff(values, prepend=last)) > math.pi).sum())
            last = float(values[-1])
        if jumps and high - low <= _TURN * (1.0 + 1e-6):
            stream.rewrite(column, _unwrapped_blocks(stream, column))
            notes.append(
                f"{key} restarted {jumps} times after a revolution: whole revolutions were added"
            )
    return notes


def _unwrapped_blocks(stream: Stream, column: int) -> Iterator[Array]:
    """Yield the unwrapped values of a column, block by block."""
    turns, last = 0.0, math.nan
    starts = {first for first, _ in stream.segments}
    row = 0
    for block in stream.blocks():
        values = block[:, column]
        continuous = np.empty_like(values)
        for at, value in enumerate(values.tolist()):
            if row + at in starts:
                turns, last = 0.0, math.nan
            if value - last > math.pi:
                turns -= 1.0
            elif last - value > math.pi:
                turns += 1.0
            continuous[at] = value + turns * _TURN
            if value == value:
                last = value
        row += len(values)
        yield continuous
