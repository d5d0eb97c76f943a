"""Gaps in the time stamps, due to missing rows."""

from __future__ import annotations

import numpy as np

from jbf.records.counts import count_of
from jbf.records.findings.finding import Finding
from jbf.records.run import Run

STEP_TOLERANCE = 0.5
"""Largest relative deviation of a time step from the median in an evenly sampled record."""
MIN_REGULAR_SHARE = 0.9
"""Share of the steps that must be close to the median for a longer step to be a gap."""

JITTER_WINDOW = 4
"""Window, in steps, over which the jitter of a time stamp cancels."""


def find_gaps(run: Run) -> list[Finding]:
    """Report missing rows of an evenly sampled record; they are not filled in.

    The state of a model is integrated across the gap.
    """
    steps = np.diff(run.time_s)
    median_step = float(np.median(steps))
    even = np.abs(steps - median_step) < STEP_TOLERANCE * median_step
    if even.mean() < MIN_REGULAR_SHARE:
        return []
    # A missing row lengthens every window that contains it by one step. Jitter lengthens one step
    # and shortens its neighbours.
    missing = np.rint(steps / median_step) - 1.0
    for length in range(2, min(JITTER_WINDOW, len(steps)) + 1):
        window = np.lib.stride_tricks.sliding_window_view(steps, length).sum(axis=1) / median_step
        extra = np.pad(np.rint(window) - length, length - 1, constant_values=np.inf)
        smallest = np.lib.stride_tricks.sliding_window_view(extra, length).min(axis=1)
        missing = np.minimum(missing, smallest)
    count = int(missing[missing > 0].sum())
    if count == 0:
        return []
    longest = float(steps[missing > 0].max())
    words = f"{count_of(count, 'row is', 'rows are')} missing; longest gap {longest:.2g} s"
    return [Finding("gaps", "time_s", run.name, longest, "s", "bridged", words)]
