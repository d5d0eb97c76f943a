"""Repeated rows: the polling rate of a logger exceeds the update rate of its link.

Motion and force are then constant over several rows and change in the same row, although the drive
moves continuously. A repeated row is not a reading: its time stamp is later than its values.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from jbf.arrays import Mask
from jbf.records.angles import continuous
from jbf.records.checks import SLOW
from jbf.records.findings.finding import Finding
from jbf.records.motion.roughness import step_of
from jbf.records.run import Run

MIN_COUNTS = 2.0
"""Minimum travel from one row to the next for a drive to be in motion, in encoder counts."""
LEAST_ROWS = 40
"""Minimum number of repeated rows in motion."""
LEAST_SHARE = 0.02
"""Minimum share of repeated rows among the rows in motion."""
MIN_COMPLETE_SHARE = 0.9
"""Minimum share of rows with all values repeated among the repeated positions in motion."""
MIN_REST_RATIO = 2.0
"""Minimum duration of a repetition for a rest, relative to the longest repetition in motion."""


def repeated_rows(run: Run) -> Mask | None:
    """Mask of the rows that repeat the previous one; None if there are too few."""
    place = run.angle_rad if run.angle_rad is not None else run.position_m
    if place is None or not run.speed_recorded or run.read:
        return None
    place = continuous(place) if place is run.angle_rad else place
    steps, path_steps = np.diff(run.time_s), np.abs(np.diff(place))
    by_speed = np.abs(run.velocity[:-1]) * steps
    # The ratio of the total displacements cancels the unit of the speed.
    unit = float(np.sum(path_steps)) / max(float(np.sum(by_speed)), 1e-300)
    moving = unit * by_speed > MIN_COUNTS * step_of(place)
    same = np.ones(len(steps), dtype=bool)
    for name, column in run.columns().items():
        if name not in ("time_s", SLOW):
            same &= np.diff(column) == 0.0
    rows, stood = int(np.sum(same & moving)), int(np.sum((path_steps == 0.0) & moving))
    if rows < max(LEAST_ROWS, LEAST_SHARE * moving.sum(), MIN_COMPLETE_SHARE * stood):
        return None
    return np.concatenate(([False], same & ~_of_rests(run, same, moving)))


def _of_rests(run: Run, same: Mask, moving: Mask) -> Mask:
    """Mask of repeated rows during rests, which are longer than repetitions in motion."""
    edges = np.diff(np.concatenate(([0], same.astype(np.int8), [0])))
    firsts, ends = np.flatnonzero(edges == 1), np.flatnonzero(edges == -1)
    lasted = run.time_s[ends] - run.time_s[firsts]
    silent = max(
        last
        for last, first, end in zip(lasted, firsts, ends, strict=True)
        if np.any(moving[first:end])
    )
    rests = np.zeros(len(same), dtype=bool)
    for last, first, end in zip(lasted, firsts, ends, strict=True):
        if last > MIN_REST_RATIO * silent:
            rests[first:end] = True
    return rests


def as_read(run: Run) -> Run:
    """Remove repeated rows from a run, and report them in a finding."""
    again = repeated_rows(run)
    if again is None:
        return run
    share = 100.0 * float(np.mean(again))
    words = (
        f"{share:.2g} % of the rows repeat the previous one while {run.quantities.mover} moves: "
        "the logger is faster than its source"
    )
    finding = Finding("repeated_rows", "time_s", run.name, share, "%", "left out", words)
    return replace(run.select(~again), reading=(*run.reading, finding))
