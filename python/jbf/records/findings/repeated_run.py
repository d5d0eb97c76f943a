"""Duplicate runs: the same recording under another name.

The copy may differ in the time origin, or in the angle by full turns of the shaft. A copy adds no
information, and would double the weight of the recording.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from jbf.arrays import Array
from jbf.records.findings.finding import Finding
from jbf.records.run import Run

FREE_ORIGIN_COLUMNS = ("time_s", "angle_rad", "position_m")
"""Columns whose origin may differ."""
ROUNDING_TOLERANCE = 1e-6
"""Tolerance for rounding in these columns, relative to their range."""


def copies(runs: Sequence[Run]) -> dict[int, int]:
    """Map the index of each run that duplicates an earlier run to the index of that run."""
    first_of_copy: dict[int, int] = {}
    for i, run in enumerate(runs):
        for first in range(i):
            if first not in first_of_copy and same_recording(runs[first], run):
                first_of_copy[i] = first
                break
    return first_of_copy


def same_recording(a: Run, b: Run) -> bool:
    """Whether two runs are the same recording, sample by sample."""
    columns_a, columns_b = a.columns(), b.columns()
    if a.friction is None or len(a) != len(b) or set(columns_a) != set(columns_b):
        return False
    return all(_same(name, columns_a[name], columns_b[name]) for name in columns_a)


def _same(name: str, a: Array, b: Array) -> bool:
    if name not in FREE_ORIGIN_COLUMNS:
        return bool(np.array_equal(a, b, equal_nan=True))
    a, b = a - a[0], b - b[0]
    return bool(np.allclose(a, b, rtol=0.0, atol=ROUNDING_TOLERANCE * float(np.ptp(a))))


def repeated(first: Run, again: Run) -> Finding:
    """Finding that the run `again` is identical to the run `first`."""
    words = f"identical to run {first.name} in every sample"
    size = float(len(again))
    return Finding("repeated_run", "friction_n", again.name, size, "samples", "left out", words)
