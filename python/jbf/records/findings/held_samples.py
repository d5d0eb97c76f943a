"""Held samples: a channel that stands still, to the digit, while it should move."""

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
"""So many equal readings in a row, where a converter's steps do not make them likely, are held."""
CHANCE = 1e-6
"""Probability that a record shows so long a row of equal readings by chance."""


def held(values: Array) -> Mask:
    """True at readings that repeat the one before, in rows too long for chance."""
    n = len(values)
    same = np.concatenate(([False], np.diff(values) == 0.0))
    edges = np.diff(np.concatenate(([0], same.astype(np.int8), [0])))
    # A long row is one that began: it does not make long rows likely.
    begun = float(np.sum(edges == 1)) / max(n - int(same.sum()), 1)
    share = min(max(begun, _by_steps(values), 1e-4), 0.9999)
    # A converter's own rows of equal readings: p^k of k in a row, at n places.
    least = max(LEAST, int(np.ceil(np.log(CHANCE / max(n, 1)) / np.log(share))))
    found = np.zeros(n, dtype=bool)
    for first, end in zip(np.flatnonzero(edges == 1), np.flatnonzero(edges == -1), strict=True):
        if end - first >= least - 1:
            found[first:end] = True
    return found


def _by_steps(values: Array) -> float:
    """Probability that noise leaves a reading in the middle of a converter's step where it is."""
    step, noise = step_of(values), noise_of(values)
    if step == 0.0:
        return 0.0
    # Rounding adds a twelfth of the square of the step.
    own = math.sqrt(max(noise**2 - step**2 / 12.0, 1e-4 * step**2))
    return math.erf(0.5 * step / own / math.sqrt(2.0))


def find_held(run: Run, explained: Mask) -> tuple[list[Finding], Mask]:
    """Stretches in which the force stands still, and where they are.

    Parameters
    ----------
    explained
        True at readings of which something else is known to be wrong.
    """
    assert run.friction_n is not None
    force = run.friction_n
    mask = held(force) & ~explained
    if mask.any() and is_without_noise(force[~mask]):
        # A command that stands at its limit is what the drive did.
        read = force[~explained]
        mask &= (force != np.max(read)) & (force != np.min(read))
    if not mask.any():
        return [], mask
    edges = np.diff(np.concatenate(([0], mask.astype(np.int8), [0])))
    starts, ends = np.flatnonzero(edges == 1), np.flatnonzero(edges == -1)
    spans = run.time_s[ends - 1] - run.time_s[np.maximum(starts - 1, 0)]
    longest = float(np.max(spans))
    words = (
        f"the {run.quantities.noun} stands still {count_of(len(starts), 'time')}, "
        f"for up to {longest:.2g} s "
        f"(first at {run.time_s[starts[0]]:.2f} s)"
    )
    return [Finding("held_samples", "friction_n", run.name, longest, "s", "set aside", words)], mask
