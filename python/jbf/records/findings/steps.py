"""Quantisation: readings that are whole multiples of a step."""

from __future__ import annotations

import numpy as np

from jbf.arrays import Array, Mask
from jbf.records.findings.finding import Finding
from jbf.records.motion.roughness import noise_of
from jbf.records.run import Run

MOST_LEVELS = 0.2
"""Largest ratio of levels to samples for quantised readings."""
FEWEST_LEVELS = 4
"""Minimum number of levels of quantised readings; a law without noise may have three levels."""
GAP_TOLERANCE, MIN_GAP_SHARE = 0.03, 0.9
"""Largest deviation of gaps between levels from whole steps, and the share that must comply.

The deviation is relative to the gap, or to five steps if five steps are larger. The differences
between the levels of a law without noise are arbitrary.
"""
LEVEL_TOLERANCE = 1e-3
"""Corners closer than this share of the smallest possible step are one level."""
MIN_STEP_TO_NOISE = 0.5
"""Ratio to the noise below which steps are not reported."""


def step_of(values: Array, *, drawn: bool = False) -> float:
    """Quantisation step of readings; zero if they are not quantised.

    Parameters
    ----------
    drawn
        True for the corners of an interpolated record, known to the digits of its file.
    """
    if len(values) < FEWEST_LEVELS:
        return 0.0
    levels = _group_levels(values) if drawn else np.unique(values)
    if len(levels) < FEWEST_LEVELS or len(levels) > MOST_LEVELS * len(values):
        return 0.0
    gaps = np.diff(levels)
    # Gaps are multiples of the step at levels without samples, with small rounding residues.
    step = float(np.median(gaps[gaps <= 1.5 * np.median(gaps)]))
    times = gaps / step
    is_multiple = np.abs(times - np.round(times)) < GAP_TOLERANCE * np.maximum(times, 5.0)
    return step if is_multiple.mean() > MIN_GAP_SHARE else 0.0


def _group_levels(values: Array) -> Array:
    """Levels of a quantised record, ascending: the middle value of each group of close values."""
    ordered = np.sort(values)
    tolerance = LEVEL_TOLERANCE * float(np.ptp(ordered)) / (MOST_LEVELS * len(ordered))
    begins = np.flatnonzero(np.concatenate(([True], np.diff(ordered) > tolerance)))
    ends = np.append(begins[1:], len(ordered))
    middle: Array = ordered[(begins + ends - 1) // 2]
    return middle


def find_steps(run: Run, usable: Mask, *, drawn: bool = False) -> list[Finding]:
    """Report quantisation steps of the force that are comparable with its noise.

    Only usable readings are examined; `drawn` as in `step_of`.
    """
    assert run.friction is not None
    force = run.friction[usable]
    step = step_of(force, drawn=drawn)
    if step == 0.0 or step < MIN_STEP_TO_NOISE * max(noise_of(force), 1e-300):
        return []
    unit = run.quantities.force
    words = f"the {run.quantities.noun} has a quantisation step of {step:.3g} {unit}"
    return [Finding("steps", "friction_n", run.name, step, unit, "included in the noise", words)]
