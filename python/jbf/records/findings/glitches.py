"""Outliers: single samples that deviate from both adjacent samples."""

from __future__ import annotations

import numpy as np

from jbf.arrays import Array, Mask
from jbf.records.counts import count_of
from jbf.records.findings.ends import end_outliers, ends_finding
from jbf.records.findings.finding import Finding
from jbf.records.run import Run

MIN_SIGMAS = 8.0
"""Minimum deviation from both neighbours, to the same side, in local standard deviations."""
MIN_CHANGES = 3.0
"""Smallest deviation relative to the median change between adjacent samples.

The deviation at a corner of a smooth force is smaller.
"""
WINDOW = 41
"""Window of the local noise, samples."""
MIN_NOISE_RATIO = 0.8
"""Lower bound of the local noise, relative to the median; required near constant readings."""
MAX_OUTLIER_SHARE = 0.02
"""Largest share of outliers; with more of them, the record has large noise instead."""
LEAST_SAMPLES = 100
SLOW_SHARE, MARGIN_SAMPLES = 0.02, 3
"""Speed limit of slow motion, relative to the top speed, and a distance in samples.

Within this distance of a reversal or of a start from rest, the friction may have a real peak.
"""


def glitches(values: Array) -> Mask:
    """Mask of outliers: samples that deviate from both adjacent samples in the same direction."""
    n = len(values)
    outliers = np.zeros(n, dtype=bool)
    if n < LEAST_SAMPLES:
        return outliers
    from scipy import ndimage  # importing takes most of a second

    change = np.diff(values)
    before, after = change[:-1], -change[1:]
    deviation = np.where(before * after > 0.0, np.minimum(np.abs(before), np.abs(after)), 0.0)
    bend = np.abs(before + after)
    # The second difference of white noise has sqrt(6) times its standard deviation.
    local = ndimage.median_filter(bend, WINDOW, mode="reflect") / 0.6745 / np.sqrt(6.0)
    typical = float(np.median(bend)) / 0.6745 / np.sqrt(6.0)
    step = ndimage.median_filter(np.abs(change), WINDOW, mode="reflect")
    corner = MIN_CHANGES * np.maximum(step[:-1], step[1:])
    outliers[1:-1] = deviation > np.maximum(
        MIN_SIGMAS * np.maximum(local, MIN_NOISE_RATIO * typical), corner
    )
    if typical == 0.0 or outliers.sum() > MAX_OUTLIER_SHARE * n:
        outliers[:] = False
    return outliers


def find_glitches(run: Run, velocity: Array) -> tuple[list[Finding], Mask]:
    """Find the outliers of the force, except for peaks at reversals and at starts from rest.

    Returns
    -------
    findings : list of Finding
    mask : ndarray
        True at the outliers, shape (n,).
    """
    assert run.friction is not None
    mask = glitches(run.friction) & ~_breakaway(velocity)
    at_ends = _end_outliers(run, velocity, mask)
    deviation = run.friction - _interpolated_force(run, mask | at_ends)
    unit = run.quantities.force
    ends = ends_finding("friction_n", "force", run.name, at_ends, deviation, unit, "excluded")
    end_findings = [] if ends is None else [ends]
    if not mask.any():
        return end_findings, at_ends
    index = np.flatnonzero(mask)
    middle = 0.5 * (run.friction[index - 1] + run.friction[index + 1])
    size = float(np.max(np.abs(run.friction[index] - middle)))
    first = ", ".join(f"{t:.2f} s" for t in run.time_s[index[:3]])
    singles = count_of(len(index), "outlier in the force", "outliers in the force")
    words = f"{singles}, up to {size:.3g} {unit} (first at {first})"
    single = Finding("glitches", "friction_n", run.name, size, unit, "excluded", words)
    return [single, *end_findings], mask | at_ends


def _end_outliers(run: Run, velocity: Array, mask: Mask) -> Mask:
    """Detect further outliers at the ends of the record, except at reversals and starts."""
    assert run.friction is not None
    outliers, valid = np.zeros(len(mask), dtype=bool), ~mask
    outliers[valid] = end_outliers(run.time_s[valid], run.friction[valid], 1)
    return outliers & ~_breakaway(velocity)


def _interpolated_force(run: Run, mask: Mask) -> Array:
    """Interpolate the force across the masked outliers."""
    assert run.friction is not None
    interpolated: Array = np.interp(run.time_s, run.time_s[~mask], run.friction[~mask])
    return interpolated


def _breakaway(velocity: Array) -> Mask:
    """Mask of the samples next to a reversal or to the end of a rest, where breakaway occurs."""
    top = float(np.max(np.abs(velocity), initial=0.0))
    direction = np.where(np.abs(velocity) > SLOW_SHARE * top, np.sign(velocity), 0.0)
    # In a slow reversal, the sign changes many samples from both ends of the slow segment.
    turns = np.flatnonzero((np.diff(direction) != 0.0) | (velocity[1:] * velocity[:-1] < 0.0))
    near_breakaway = np.zeros(len(direction), dtype=bool)
    for offset in range(1 - MARGIN_SAMPLES, MARGIN_SAMPLES + 1):
        near_breakaway[np.clip(turns + offset, 0, len(direction) - 1)] = True
    return near_breakaway
