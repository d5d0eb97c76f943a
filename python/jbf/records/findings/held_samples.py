"""Held samples: a channel that repeats exactly the same value while it should change."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from jbf.records.counts import count_of
from jbf.records.findings.finding import Finding
from jbf.records.findings.smooth_force import is_without_noise
from jbf.records.findings.steps import step_of
from jbf.records.motion.roughness import noise_of
from jbf.records.run import Run

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

LEAST = 5
"""Smallest number of equal readings in a row, where quantisation does not make them likely."""
CHANCE = 1e-6
"""Probability that a record contains a row of equal readings of this length by chance."""


def held(values: Array) -> Mask:
    """Mask of the readings that repeat the previous one, in rows that are too long for chance."""
    n = len(values)
    same = np.concatenate(([False], np.diff(values) == 0.0))
    edges = np.diff(np.concatenate(([0], same.astype(np.int8), [0])))
    # Only the beginnings are counted, so that one long row does not make long rows likely.
    begun = float(np.sum(edges == 1)) / max(n - int(same.sum()), 1)
    share = min(max(begun, _by_steps(values), 1e-4), 0.9999)
    # Rows of equal readings by quantisation: probability p^k for k in a row, at n places.
    least = max(LEAST, int(np.ceil(np.log(CHANCE / max(n, 1)) / np.log(share))))
    found = np.zeros(n, dtype=bool)
    for first, end in zip(np.flatnonzero(edges == 1), np.flatnonzero(edges == -1), strict=True):
        if end - first >= least - 1:
            found[first:end] = True
    return found


def _by_steps(values: Array) -> float:
    """Probability that noise keeps a reading in the middle of its quantisation step."""
    step, noise = step_of(values), noise_of(values)
    if step == 0.0:
        return 0.0
    # Quantisation adds a variance of the square of the step over 12.
    own = math.sqrt(max(noise**2 - step**2 / 12.0, 1e-4 * step**2))
    return math.erf(0.5 * step / own / math.sqrt(2.0))


def find_held(run: Run, explained: Mask) -> tuple[list[Finding], Mask]:
    """Find stretches in which the force does not change.

    Parameters
    ----------
    explained
        True at readings with another known defect.

    Returns
    -------
    findings : list of Finding
    mask : ndarray
        True at the held readings, shape (n,).
    """
    assert run.friction is not None
    force = run.friction
    mask = held(force) & ~explained
    if mask.any() and is_without_noise(force[~mask]):
        # A command that stays at its limit is real output of the drive.
        read = force[~explained]
        mask &= (force != np.max(read)) & (force != np.min(read))
    if not mask.any():
        return [], mask
    edges = np.diff(np.concatenate(([0], mask.astype(np.int8), [0])))
    starts, ends = np.flatnonzero(edges == 1), np.flatnonzero(edges == -1)
    spans = run.time_s[ends - 1] - run.time_s[np.maximum(starts - 1, 0)]
    longest = float(np.max(spans))
    words = (
        f"the {run.quantities.noun} is constant {count_of(len(starts), 'time')}, for up to "
        f"{longest:.2g} s (first at {run.time_s[starts[0]]:.2f} s)"
    )
    return [Finding("held_samples", "friction_n", run.name, longest, "s", "excluded", words)], mask
