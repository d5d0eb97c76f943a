"""Steps: readings that are whole multiples of a converter's step."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from jbf.records.findings.finding import Finding
from jbf.records.motion.roughness import noise_of
from jbf.records.run import Run

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

MOST_LEVELS = 0.2
"""Readings that come in fewer levels than this share of the samples come in steps."""
FEWEST_LEVELS = 4
"""Readings of fewer levels are those of a law without noise: forth, back and rest."""
CRUMBS, ALL = 0.03, 0.9
"""Share by which levels may be off a whole number of steps apart (or of five), and share of those
that are not: the levels of a law without noise are any distance apart."""
CRUMB = 1e-3
"""Corners nearer than this share of the smallest step that may be are one level."""
MATTERS = 0.5
"""Steps below this share of the noise are not worth a word."""


def step_of(values: Array, *, drawn: bool = False) -> float:
    """The step in which readings come; zero where they come in none.

    Parameters
    ----------
    drawn
        They are the corners of a record drawn as lines, known to the digits of its file.
    """
    if len(values) < FEWEST_LEVELS:
        return 0.0
    levels = _near_levels(values) if drawn else np.unique(values)
    if len(levels) < FEWEST_LEVELS or len(levels) > MOST_LEVELS * len(values):
        return 0.0
    apart = np.diff(levels)
    # Levels that nobody visited leave multiples; digits of the file leave crumbs.
    step = float(np.median(apart[apart <= 1.5 * np.median(apart)]))
    times = apart / step
    whole = np.abs(times - np.round(times)) < CRUMBS * np.maximum(times, 5.0)
    return step if whole.mean() > ALL else 0.0


def _near_levels(values: Array) -> Array:
    """The levels among values that are nearly on them, ascending: the middle value of each."""
    ordered = np.sort(values)
    near = CRUMB * float(np.ptp(ordered)) / (MOST_LEVELS * len(ordered))
    begins = np.flatnonzero(np.concatenate(([True], np.diff(ordered) > near)))
    ends = np.append(begins[1:], len(ordered))
    middle: Array = ordered[(begins + ends - 1) // 2]
    return middle


def find_steps(run: Run, usable: Mask, *, drawn: bool = False) -> list[Finding]:
    """Steps of the force that are as large as its noise, where its readings can be used; `drawn`
    as in `step_of`."""
    assert run.friction_n is not None
    force = run.friction_n[usable]
    step = step_of(force, drawn=drawn)
    if step == 0.0 or step < MATTERS * max(noise_of(force), 1e-300):
        return []
    unit = run.quantities.force
    words = f"the {run.quantities.noun} comes in steps of {step:.3g} {unit}"
    return [Finding("steps", "friction_n", run.name, step, unit, "counted as noise", words)]
