"""Held samples: a channel repeats the same value during a change of the measured quantity."""

from __future__ import annotations

import math

import numpy as np

from jbf.arrays import Array, Mask
from jbf.records.counts import count_of
from jbf.records.findings.finding import Finding
from jbf.records.findings.smooth_force import is_without_noise
from jbf.records.findings.steps import step_of
from jbf.records.motion.roughness import noise_of
from jbf.records.run import Run

LEAST = 5
"""Smallest length of a held sequence, if quantisation does not make longer sequences likely."""
CHANCE = 1e-6
"""Probability that a record contains a sequence of equal readings of this length by chance."""


def held_mask(values: Array) -> Mask:
    """Mask of readings equal to the previous one, in sequences that are improbable by chance."""
    n = len(values)
    same = np.concatenate(([False], np.diff(values) == 0.0))
    edges = np.diff(np.concatenate(([0], same.astype(np.int8), [0])))
    # Count beginnings only, so that one long sequence does not increase the probability.
    begun = float(np.sum(edges == 1)) / max(n - int(same.sum()), 1)
    share = min(max(begun, _by_steps(values), 1e-4), 0.9999)
    # Equal readings due to quantisation: probability p^k for a length k, at n positions.
    shortest = max(LEAST, int(np.ceil(np.log(CHANCE / max(n, 1)) / np.log(share))))
    mask = np.zeros(n, dtype=bool)
    for first, end in zip(np.flatnonzero(edges == 1), np.flatnonzero(edges == -1), strict=True):
        if end - first >= shortest - 1:
            mask[first:end] = True
    return mask


def _by_steps(values: Array) -> float:
    """Probability that noise leaves a quantised reading unchanged, in the middle of a step."""
    step, noise = step_of(values), noise_of(values)
    if step == 0.0:
        return 0.0
    # The variance of the quantisation error is step^2 / 12.
    noise_sd = math.sqrt(max(noise**2 - step**2 / 12.0, 1e-4 * step**2))
    return math.erf(0.5 * step / noise_sd / math.sqrt(2.0))


def find_held(run: Run, explained: Mask) -> tuple[list[Finding], Mask]:
    """Report segments in which the force is held (constant although the motion changes).

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
    mask = held_mask(force) & ~explained
    if mask.any() and is_without_noise(force[~mask]):
        # A command at its limit is the true output of the drive, not a recording artefact.
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
