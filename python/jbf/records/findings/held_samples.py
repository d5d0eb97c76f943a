"""Held samples: a channel that stands still, to the digit, while it should move."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from jbf.records.findings.finding import Finding
from jbf.records.run import Run

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

LEAST = 5
"""So many equal readings in a row, where a converter's steps do not make them likely, are held."""
CHANCE = 1e-6
"""Probability that a record shows so long a row of equal readings by chance."""


def held(values: Array) -> Mask:
    """True at readings that repeat the one before, in rows too long for chance."""
    n = len(values)
    same = np.concatenate(([False], np.diff(values) == 0.0))
    share = min(max(float(np.mean(same)), 1e-4), 0.99)
    # A converter's own rows of equal readings: p^k of k in a row, at n places.
    least = max(LEAST, int(np.ceil(np.log(CHANCE / max(n, 1)) / np.log(share))))
    edges = np.diff(np.concatenate(([0], same.astype(np.int8), [0])))
    found = np.zeros(n, dtype=bool)
    for first, end in zip(np.flatnonzero(edges == 1), np.flatnonzero(edges == -1), strict=True):
        if end - first >= least - 1:
            found[first:end] = True
    return found


def find_held(run: Run) -> tuple[list[Finding], Mask]:
    """Stretches in which the force stands still, and where they are."""
    assert run.friction_n is not None
    mask = held(run.friction_n)
    if not mask.any():
        return [], mask
    edges = np.diff(np.concatenate(([0], mask.astype(np.int8), [0])))
    starts, ends = np.flatnonzero(edges == 1), np.flatnonzero(edges == -1)
    spans = run.time_s[ends - 1] - run.time_s[np.maximum(starts - 1, 0)]
    longest = float(np.max(spans))
    words = (
        f"the force stands still {len(starts)} times, for up to {longest:.2g} s "
        f"(first at {run.time_s[starts[0]]:.2f} s)"
    )
    return [Finding("held_samples", "friction_n", run.name, longest, "s", "set aside", words)], mask
