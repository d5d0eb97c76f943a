"""Gaps: rows that are missing."""

from __future__ import annotations

import numpy as np

from jbf.records.counts import count_of
from jbf.records.findings.finding import Finding
from jbf.records.run import Run

EVEN = 0.5
"""Steps of an even record differ from the usual one by less than this share, but for gaps."""
MOSTLY = 0.9
"""Share of the steps that must be the usual one for a longer one to be a gap."""

STRETCH = 4
"""Window, in steps, in which the jitter of a stamp cancels."""


def find_gaps(run: Run) -> list[Finding]:
    """Rows missing from an evenly sampled record. Nothing is filled in: a model steps over them."""
    steps = np.diff(run.time_s)
    usual = float(np.median(steps))
    even = np.abs(steps - usual) < EVEN * usual
    if even.mean() < MOSTLY:
        return []
    # A missing row makes every stretch that contains it longer by one step. Jitter makes a step
    # longer and its neighbours shorter.
    missing = np.rint(steps / usual) - 1.0
    for length in range(2, min(STRETCH, len(steps)) + 1):
        window = np.lib.stride_tricks.sliding_window_view(steps, length).sum(axis=1) / usual
        more = np.pad(np.rint(window) - length, length - 1, constant_values=np.inf)
        least = np.lib.stride_tricks.sliding_window_view(more, length).min(axis=1)
        missing = np.minimum(missing, least)
    count = int(missing[missing > 0].sum())
    if count == 0:
        return []
    longest = float(steps[missing > 0].max())
    words = f"{count_of(count, 'row is', 'rows are')} missing, {longest:.2g} s at the longest"
    return [Finding("gaps", "time_s", run.name, longest, "s", "stepped over", words)]
