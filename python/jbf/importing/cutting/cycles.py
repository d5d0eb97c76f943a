"""Cuts at the cycles of a reciprocating motion, or into parts of equal duration."""

from __future__ import annotations

import numpy as np

from jbf.importing.cutting.motion_speed import MotionSpeed
from jbf.importing.cutting.piece import Cut
from jbf.importing.cutting.rests import REST_SPEED_SHARE, REST_SPEED_SIGMAS
from jbf.importing.cutting.settings import CutSettings
from jbf.importing.spool import Recording

WINDOW_S = 0.05
"""Window over which the speed is computed from a position, s."""


def cut_at_cycles(recording: Recording, settings: CutSettings) -> list[Cut]:
    """Cuts at the start of each cycle of a forward and a return stroke."""
    motion = MotionSpeed(recording, WINDOW_S)
    share = REST_SPEED_SHARE if settings.still is None else settings.still
    threshold = max(share * motion.top(), REST_SPEED_SIGMAS * motion.noise())
    stream, cuts = motion.stream, list[Cut]()
    for segment, (first, _) in enumerate(stream.segments):
        last_back: int | None = None
        for begin, _, speed in motion.blocks(segment):
            direction = np.where(speed > threshold, 1, np.where(speed < -threshold, -1, 0))
            for at in np.flatnonzero(direction):
                if direction[at] < 0:
                    last_back = begin + int(at)
                elif last_back is not None:
                    row = (last_back + begin + int(at) + 1) // 2
                    if row > first:
                        cuts.append(Cut(segment, stream.at(row - 1), stream.at(row), "a cycle"))
                    last_back = None
    return cuts


def cut_into_parts(recording: Recording, count: int) -> list[Cut]:
    """Cuts that divide each segment of increasing time into `count` parts of equal duration."""
    stream, cuts = recording.streams[0], list[Cut]()
    for segment, (first, end) in enumerate(stream.segments):
        from_s, to_s = stream.at(first), stream.at(end - 1)
        for part in range(1, count):
            at_s = from_s + (to_s - from_s) * part / count
            row, _ = stream.rows_between(segment, at_s, to_s)
            if first < row < end:
                cuts.append(Cut(segment, stream.at(row - 1), stream.at(row), f"part {part + 1}"))
    return cuts
