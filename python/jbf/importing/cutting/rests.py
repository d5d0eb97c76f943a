"""Cuts at rests: each motion becomes a run, with a short part of the adjacent rests."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from jbf.importing.cutting.motion_speed import MotionSpeed
from jbf.importing.cutting.piece import Cut
from jbf.importing.cutting.settings import CutSettings
from jbf.importing.spool import Recording

WINDOW = 0.05
"""Averaging window of the absolute speed, as a share of the shortest rest."""
REST_SPEED_SHARE = 5e-3
"""Largest speed of a rest, as a share of the top speed."""
REST_SPEED_SIGMAS = 2.0
"""Largest speed of a rest, in standard deviations of the speed's white noise.

The larger of this and `REST_SPEED_SHARE` applies.
"""


def cut_at_rests(recording: Recording, settings: CutSettings) -> list[Cut]:
    """Cuts at each rest of sufficient duration, without the parts of the rest that are kept."""
    motion = MotionSpeed(recording, WINDOW * settings.rest_s)
    top = motion.top()
    share = REST_SPEED_SHARE if settings.still is None else settings.still
    threshold = share * top
    if settings.still is None:
        threshold = max(threshold, REST_SPEED_SIGMAS * motion.noise())
    cuts = []
    for segment, (first, end) in enumerate(motion.stream.segments):
        for begin, stop in _rests(motion, segment, threshold):
            from_s, to_s = motion.stream.at(begin), motion.stream.at(stop - 1)
            if to_s - from_s < settings.rest_s:
                continue
            keep = min(settings.keep_rest_s, 0.5 * (to_s - from_s))
            last, _ = motion.stream.rows_between(segment, from_s + keep, to_s)
            # The start of a rest belongs to the motion before it, its end to the motion after it.
            last = begin if begin == first else min(last, stop - 1)
            _, after = motion.stream.rows_between(segment, from_s, to_s - keep)
            after = end - 1 if stop == end else max(after, last + 1)
            why = f"a rest of {to_s - from_s:.3g} s"
            if last < min(after, end - 1) or begin == first or stop == end:
                cuts.append(
                    Cut(segment, motion.stream.at(last), motion.stream.at(min(after, end - 1)), why)
                )
    return cuts


def _rests(motion: MotionSpeed, segment: int, threshold: float) -> Iterator[tuple[int, int]]:
    """Yield first row and end row (exclusive) of each rest of a segment."""
    began: int | None = None
    row = motion.stream.segments[segment][0]
    for first, _, speed in motion.smoothed(segment):
        at_rest = speed <= threshold
        edges = np.flatnonzero(np.diff(np.concatenate(([began is not None], at_rest))))
        for edge in edges:
            row = first + int(edge)
            if began is None:
                began = row
            else:
                yield began, row
                began = None
        row = first + len(speed)
    if began is not None:
        yield began, row
