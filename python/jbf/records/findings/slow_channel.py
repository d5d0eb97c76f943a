"""A slow channel that repeats its last reading until the next: rows of equal samples at a rate.

The first sample of each row is a reading, made since the sample before. Over a record, the beat of
the two clocks tells when to a fraction of a sample.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from jbf.records.findings.interpolated import Native

Array = npt.NDArray[np.float64]

LEAST_ROWS = 40
LEAST_SHARE = 0.02
"""Share of the samples that must repeat the one before."""
EVEN = 1e-3
"""Samples are evenly spaced where they are off an even grid by less than this share of a step."""
WITHIN = 1.02
"""Steps within which all rows must begin, as seen from a steady clock: random rows wander."""


def find_repeated(time: Array, values: Array) -> Native | None:
    """The readings of a slow channel that stands still between them; None where it is none."""
    step = float(np.median(np.diff(time)))
    if np.max(np.abs(np.diff(time) / step - 1.0)) > EVEN:
        return None
    first = np.flatnonzero(np.diff(values) != 0.0) + 1
    rows = len(first)
    if rows < LEAST_ROWS or len(values) - rows < LEAST_SHARE * len(values) + 1:
        return None
    begins, count = time[first], np.arange(rows)
    period = float(np.polyfit(count, begins, 1)[0])
    # A finer look: rows at both ends hold the clock to a fraction of a step.
    spread, period = min(
        (float(np.ptp(begins - p * count)), float(p))
        for p in period + np.linspace(-2.0, 2.0, 81) * step / rows
    )
    if spread > WITHIN * step:
        return None
    early = begins - period * count
    # Each reading is at most a step before its row begins.
    phase = 0.5 * (float(np.max(early)) - step + float(np.min(early)))
    ticks: Array = phase + period * count.astype(np.float64)
    return Native(ticks, values[first], period)
