"""Rows that repeat the one before: a logger asks oftener than its link has something new.

Motion and force then stand still together and jump together, while the drive moves on. Such a row
is no reading: its stamp is later than what it says.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from jbf.records.checks import SLOW
from jbf.records.findings.finding import Finding
from jbf.records.motion.roughness import step_of
from jbf.records.run import Run

Mask = npt.NDArray[np.bool_]

COUNTS = 2.0
"""Counts of the encoder that a drive must go by from one row to the next to be seen to move."""
LEAST_ROWS = 40
"""Rows that must repeat the one before while the drive moves,"""
LEAST_SHARE = 0.02
"""share of the rows in motion that they must be,"""
TOGETHER = 0.9
"""and share of the repeated positions in motion that must be whole rows."""
LONGER = 2.0
"""Rows that repeat for so many times as long as any does in motion are those of a rest."""


def repeated_rows(run: Run) -> Mask | None:
    """True at rows that repeat the one before; None where the record has none to speak of."""
    place = run.angle_rad if run.angle_rad is not None else run.position_m
    if place is None or not run.speed_recorded or run.read:
        return None
    place = np.unwrap(place) if place is run.angle_rad else place
    steps, way = np.diff(run.time_s), np.abs(np.diff(place))
    by_speed = np.abs(run.velocity_m_s[:-1]) * steps
    # Whatever the speed's unit is: the way in all is the way in all.
    unit = float(np.sum(way)) / max(float(np.sum(by_speed)), 1e-300)
    moving = unit * by_speed > COUNTS * step_of(place)
    same = np.ones(len(steps), dtype=bool)
    for name, column in run.columns().items():
        if name not in ("time_s", SLOW):
            same &= np.diff(column) == 0.0
    rows, stood = int(np.sum(same & moving)), int(np.sum((way == 0.0) & moving))
    if rows < max(LEAST_ROWS, LEAST_SHARE * moving.sum(), TOGETHER * stood):
        return None
    return np.concatenate(([False], same & ~_of_rests(run, same, moving)))


def _of_rests(run: Run, same: Mask, moving: Mask) -> Mask:
    """True at repeats that last longer than the link is ever silent: nothing new is their news."""
    edges = np.diff(np.concatenate(([0], same.astype(np.int8), [0])))
    firsts, ends = np.flatnonzero(edges == 1), np.flatnonzero(edges == -1)
    lasted = run.time_s[ends] - run.time_s[firsts]
    silent = max(
        last
        for last, first, end in zip(lasted, firsts, ends, strict=True)
        if np.any(moving[first:end])
    )
    found = np.zeros(len(same), dtype=bool)
    for last, first, end in zip(lasted, firsts, ends, strict=True):
        if last > LONGER * silent:
            found[first:end] = True
    return found


def as_read(run: Run) -> Run:
    """The run without such rows, which then says so."""
    again = repeated_rows(run)
    if again is None:
        return run
    share = 100.0 * float(np.mean(again))
    words = (
        f"{share:.2g} % of the rows repeat the one before while {run.quantities.mover} moves on: "
        "the logger asks oftener than it is answered"
    )
    found = Finding("repeated_rows", "time_s", run.name, share, "%", "left out", words)
    return replace(run.select(~again), reading=(*run.reading, found))
