"""Glitches: single samples far off what the samples on both sides agree on."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from jbf.records.counts import count_of
from jbf.records.findings.ends import ends_finding, loose_ends
from jbf.records.findings.finding import Finding
from jbf.records.run import Run

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

FAR = 8.0
"""Local standard deviations that a sample must be off both its neighbours, to the same side."""
CHANGES = 3.0
"""Times the usual change between neighbours that it must be off: no corner of a smooth force is."""
WINDOW = 41
"""Samples over which the local noise is taken."""
LOUD = 0.8
"""Least local noise, as a share of the usual: beside readings that stand still there is none."""
RARE = 0.02
"""A record in which more samples than this are far off has large noise, not glitches."""
LEAST_SAMPLES = 100
SLOW, BESIDE = 0.02, 3
"""Where the speed turns round or rises from rest (a share of its top), so many samples to either
side may hold a peak of the friction itself."""


def glitches(values: Array) -> Mask:
    """True at samples that stick out: a jump, up or down, has its neighbours to either side."""
    n = len(values)
    found = np.zeros(n, dtype=bool)
    if n < LEAST_SAMPLES:
        return found
    from scipy import ndimage  # most of a second to import

    change = np.diff(values)
    before, after = change[:-1], -change[1:]
    off = np.where(before * after > 0.0, np.minimum(np.abs(before), np.abs(after)), 0.0)
    bend = np.abs(before + after)
    # White noise bends by sqrt(6) of its standard deviation.
    local = ndimage.median_filter(bend, WINDOW, mode="reflect") / 0.6745 / np.sqrt(6.0)
    usual = float(np.median(bend)) / 0.6745 / np.sqrt(6.0)
    step = ndimage.median_filter(np.abs(change), WINDOW, mode="reflect")
    corner = CHANGES * np.maximum(step[:-1], step[1:])
    found[1:-1] = off > np.maximum(FAR * np.maximum(local, LOUD * usual), corner)
    if usual == 0.0 or found.sum() > RARE * n:
        found[:] = False
    return found


def find_glitches(run: Run, velocity_m_s: Array) -> tuple[list[Finding], Mask]:
    """Glitches of the force, and where they are; a peak at a reversal or a start is none."""
    assert run.friction_n is not None
    mask = glitches(run.friction_n) & ~_breakaway(velocity_m_s)
    loose = _loose_ends(run, velocity_m_s, mask)
    off = run.friction_n - _next_to(run, mask | loose)
    unit = run.quantities.force
    ends = ends_finding("friction_n", "force", run.name, loose, off, unit, "set aside")
    more = [] if ends is None else [ends]
    if not mask.any():
        return more, loose
    index = np.flatnonzero(mask)
    middle = 0.5 * (run.friction_n[index - 1] + run.friction_n[index + 1])
    size = float(np.max(np.abs(run.friction_n[index] - middle)))
    first = ", ".join(f"{t:.2f} s" for t in run.time_s[index[:3]])
    singles = count_of(
        len(index), "single sample of the force is", "single samples of the force are"
    )
    words = f"{singles} off by up to {size:.3g} {unit} (at {first})"
    single = Finding("glitches", "friction_n", run.name, size, unit, "set aside", words)
    return [single, *more], mask | loose


def _loose_ends(run: Run, velocity_m_s: Array, mask: Mask) -> Mask:
    """Ends of the force that are off, beside those that stick out within; but for a start."""
    assert run.friction_n is not None
    loose, good = np.zeros(len(mask), dtype=bool), ~mask
    loose[good] = loose_ends(run.time_s[good], run.friction_n[good], 1)
    return loose & ~_breakaway(velocity_m_s)


def _next_to(run: Run, mask: Mask) -> Array:
    """The force as the samples say that do not stick out."""
    assert run.friction_n is not None
    said: Array = np.interp(run.time_s, run.time_s[~mask], run.friction_n[~mask])
    return said


def _breakaway(velocity_m_s: Array) -> Mask:
    """True at samples beside a reversal or an end of a rest."""
    top = float(np.max(np.abs(velocity_m_s), initial=0.0))
    way = np.where(np.abs(velocity_m_s) > SLOW * top, np.sign(velocity_m_s), 0.0)
    # In a slow reversal the sign turns far from both ends of what is slow.
    turns = np.flatnonzero((np.diff(way) != 0.0) | (velocity_m_s[1:] * velocity_m_s[:-1] < 0.0))
    beside = np.zeros(len(way), dtype=bool)
    for off in range(1 - BESIDE, BESIDE + 1):
        beside[np.clip(turns + off, 0, len(way) - 1)] = True
    return beside
