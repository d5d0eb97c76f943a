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


def find_gaps(run: Run) -> list[Finding]:
    """Rows missing from an evenly sampled record. Nothing is filled in: a model steps over them."""
    steps = np.diff(run.time_s)
    usual = float(np.median(steps))
    even = np.abs(steps - usual) < EVEN * usual
    if even.mean() < MOSTLY:
        return []
    missing = np.round(steps / usual).astype(int) - 1
    count = int(missing[missing > 0].sum())
    if count == 0:
        return []
    longest = float(steps.max())
    words = f"{count_of(count, 'row is', 'rows are')} missing, {longest:.2g} s at the longest"
    return [Finding("gaps", "time_s", run.name, longest, "s", "stepped over", words)]
