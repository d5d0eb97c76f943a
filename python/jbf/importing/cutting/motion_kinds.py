"""Cuts where the kind of motion changes.

Kinds are rest, steady speed, changing speed in one direction, and motion to and fro.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from jbf.importing.cutting.motion_speed import MotionSpeed
from jbf.importing.cutting.piece import Cut
from jbf.importing.cutting.rests import REST_SPEED_SHARE, REST_SPEED_SIGMAS
from jbf.importing.cutting.settings import CutSettings
from jbf.importing.spool import Recording

WINDOW_S = 1.0
"""Shortest window that is classified, s; `rest_s` applies if it is longer."""
STEADY = 0.02
"""Largest range of a steady speed, as a share of its median."""
MIN_WINDOWS = 3
"""Minimum number of consecutive windows of a kind; fewer belong to the kind before."""


def cut_at_motion_kinds(recording: Recording, settings: CutSettings) -> list[Cut]:
    """Cuts at each lasting change of the kind of motion."""
    window_s = max(settings.rest_s, WINDOW_S)
    motion = MotionSpeed(recording, 0.1 * window_s)
    threshold = (REST_SPEED_SHARE if settings.still is None else settings.still) * motion.top()
    noise = motion.noise()
    threshold = max(threshold, REST_SPEED_SIGMAS * noise)
    cuts: list[Cut] = []
    for segment, (first, _) in enumerate(motion.stream.segments):
        kinds: list[str] = []
        begins: list[int] = []
        per = max(4, round(window_s / 0.1 / window_s * 2.0 * motion.half))
        for begin, _, speed in motion.blocks(segment):
            for at in range(0, len(speed), per):
                part = speed[at : at + per]
                if len(part) >= per // 2:
                    kinds.append(_kind(part, threshold, noise))
                    begins.append(begin + at)
        for at, kind in _lasting_kinds(_to_and_fro(kinds)):
            row = begins[at]
            if row > first:
                stream = motion.stream
                cuts.append(Cut(segment, stream.at(row - 1), stream.at(row), f"motion: {kind}"))
    return cuts


def _kind(speed: np.ndarray, threshold: float, noise: float) -> str:
    """Kind of motion of one window, from its speeds."""
    size = float(np.median(np.abs(speed)))
    if size <= threshold:
        return "rest"
    if (speed > threshold).any() and (speed < -threshold).any():
        return "to and fro"
    if float(np.ptp(speed)) <= max(STEADY * size, 6.0 * noise):
        return f"steady {'forward' if speed.mean() > 0.0 else 'back'}"
    return f"changing {'forward' if speed.mean() > 0.0 else 'back'}"


def _to_and_fro(kinds: list[str]) -> list[str]:
    """Reclassify windows of one direction between two reversals as motion to and fro."""
    classified = list(kinds)
    turns = [i for i, kind in enumerate(kinds) if kind == "to and fro"]
    for first_turn, second_turn in pairwise(turns):
        between = kinds[first_turn + 1 : second_turn]
        if all(kind.startswith("changing") for kind in between):
            classified[first_turn + 1 : second_turn] = ["to and fro"] * len(between)
    return classified


def _lasting_kinds(kinds: list[str]) -> list[tuple[int, str]]:
    """Index of the first window and name of each lasting kind of motion."""
    lasting: list[tuple[int, str]] = []
    last = None
    at = 0
    while at < len(kinds):
        end = at
        while end < len(kinds) and kinds[end] == kinds[at]:
            end += 1
        if end - at >= MIN_WINDOWS and kinds[at] != last:
            if last is not None:
                lasting.append((at, kinds[at]))
            last = kinds[at]
        at = end
    return lasting
