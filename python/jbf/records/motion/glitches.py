"""Glitches of a motion: a single position far off the path on both sides, a single speed that the
path does not know of."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from jbf.records.counts import count_of
from jbf.records.findings.ends import ends_finding, loose_ends
from jbf.records.findings.finding import Finding
from jbf.records.lagrange import weights_at_zero
from jbf.records.motion.position import Position
from jbf.records.motion.roughness import step_of

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

FAR = 8.0
"""Local standard deviations that a sample must be off,"""
COUNTS = 3.0
"""and counts of the encoder, whose rounding is less than one and a half off a cubic,"""
BESIDE = 0.825
"""and the samples beside, the other way, so much of what it makes of them (two thirds at even
steps): of a corner, or a step, they are three quarters of that."""
JUMP = 0.4
"""and so much of the change of the speed from before to after, times a step."""
CHANGES = 3.0
"""Of a speed: times the change that is usual between neighbours, which a corner never is,"""
ALIKE = 0.5
"""and the way there and the way back differ by no more than this factor."""
WINDOW = 41
"""Samples over which the local noise, and the usual change, are taken."""
RARE = 0.02
"""A record in which more samples than this are far off has large noise, not glitches."""
RARE_ALONE = 0.003
"""The same where no path confirms what a speed says: a slip of the shaft may be as short."""
LEAST_SAMPLES = 60
ASIDE = "left out of the motion"


def mend_position(name: str, time: Array, position: Position) -> tuple[Position, Finding | None]:
    """The path without its glitches, each put where its neighbours say."""
    path = position.path_m
    least, mask = COUNTS * step_of(path), np.zeros(len(path), dtype=bool)
    while mask.sum() <= RARE * len(path):
        # Two that stand side by side: without the one the other is single.
        good = np.flatnonzero(~mask)
        more = good[_off(time[good], path[good], least)]
        if not len(more):
            break
        mask[more] = True
    if not 0 < mask.sum() <= RARE * len(path):
        return position, None
    mended = _between(time, path, mask)
    size = float(np.max(np.abs(path - mended))) / position.arm_m
    words = _words("position", time, mask, f"{size:.3g} {position.unit}")
    found = Finding("glitches", position.column, name, size, position.unit, ASIDE, words)
    return position.along(mended), found


def mend_speed(
    name: str, time: Array, speed: Array, path: Array | None, unit: str = "m/s"
) -> tuple[Array, Finding | None]:
    """The speed without its glitches; with a path only those that the path does not share."""
    n = len(speed)
    if n < LEAST_SAMPLES:
        return speed, None
    before, after = _both_sides(np.diff(speed))
    usual = _around(np.abs(np.diff(speed)))
    off = _least(before, after)
    off[off <= CHANGES * np.maximum(usual[:-1], usual[1:])] = 0.0
    bend = _around(np.abs(before + after)) / 0.6745 / np.sqrt(6.0)
    off[off <= FAR * bend] = 0.0
    mask = np.concatenate(([False], off != 0.0, [False]))
    # To the filter of a record without noise every corner is far off.
    if np.median(np.abs(before + after)) == 0.0:
        return speed, None
    if path is not None and mask.any():
        mended = _between(time, speed, mask)
        mask &= _missed(time, path, speed) > 2.0 * _missed(time, path, mended)
    if not 0 < mask.sum() <= (RARE_ALONE if path is None else RARE) * n:
        return speed, None
    mended = _between(time, speed, mask)
    size = float(np.max(np.abs(speed - mended)))
    words = _words("speed", time, mask, f"{size:.3g} {unit}")
    return mended, Finding("glitches", "velocity_m_s", name, size, unit, ASIDE, words)


def mend_path_ends(
    name: str, time: Array, position: Position
) -> tuple[Position, Mask, list[Finding]]:
    """The path with ends that are off on the line that comes next to them, and which they are."""
    path = position.path_m
    mask = loose_ends(time, path, 3)
    mended = _between(time, path, mask)
    off = (path - mended) / position.arm_m
    found = ends_finding(position.column, "position", name, mask, off, position.unit, ASIDE)
    return (position.along(mended) if found else position), mask, [found] if found else []


def mend_speed_ends(
    name: str, time: Array, speed: Array, path: Array | None, unit: str
) -> tuple[Array, Mask, list[Finding]]:
    """The same of a speed; with a path only where that does not go so fast."""
    mask = loose_ends(time, speed, 1)
    mended = _between(time, speed, mask)
    if path is not None and mask.any():
        missed = _missed(time, path, speed) > 2.0 * _missed(time, path, mended)
        if not missed[mask].all():
            mask[:], mended = False, speed
    found = ends_finding("velocity_m_s", "speed", name, mask, speed - mended, unit, ASIDE)
    return mended, mask, [found] if found else []


def _off(time: Array, path: Array, least: float) -> Mask:
    """True at samples far off a cubic through two neighbours on either side."""
    n = len(path)
    found = np.zeros(n, dtype=bool)
    if n < LEAST_SAMPLES:
        return found
    t = np.stack([time[k : n - 4 + k] - time[2 : n - 2] for k in (0, 1, 3, 4)])
    y = np.stack([path[k : n - 4 + k] - path[2 : n - 2] for k in (0, 1, 3, 4)])
    weights = weights_at_zero(t)
    off = -np.sum(weights * y, axis=0)
    size = np.abs(off)
    far = size > np.maximum(FAR * _around(size) / 0.6745, least)
    # The cubics of its neighbours have its weight: they are off the other way by that share of it.
    for beside, weight in (
        (np.pad(off, (1, 0))[:-1], np.pad(weights[2], (1, 0))[:-1]),
        (np.pad(off, (0, 1))[1:], np.pad(weights[1], (0, 1))[1:]),
    ):
        far &= (-beside * off > BESIDE * weight * size**2) & (np.abs(beside) < size)
    # Where the speed itself jumps, the steps on both sides differ by three times that.
    far &= size > JUMP * np.abs((y[3] - y[2]) - (y[1] - y[0]))
    found[2:-2] = far
    return found


def _both_sides(change: Array) -> tuple[Array, Array]:
    """How far each inner sample is above the one before, and above the one after."""
    return change[:-1], -change[1:]


def _least(before: Array, after: Array) -> Array:
    """The smaller of both, where they are of one sign and about as large; zero elsewhere."""
    less, more = (
        np.minimum(np.abs(before), np.abs(after)),
        np.maximum(np.abs(before), np.abs(after)),
    )
    off = np.where((before * after > 0.0) & (less > ALIKE * more), less, 0.0)
    # What is beside a glitch is off as seen from it.
    most = np.maximum(np.pad(off, (1, 0))[:-1], np.pad(off, (0, 1))[1:])
    found: Array = np.where(off > most, off, 0.0)
    return found


def _median(values: Array, window: int) -> Array:
    from scipy import ndimage  # most of a second to import

    found: Array = ndimage.median_filter(values, window, mode="reflect")
    return found


def _around(sizes: Array) -> Array:
    """The usual size round each sample, over a window that lies about it or to either side: beside
    a rest half a window is quiet."""
    from scipy import ndimage

    found: Array = ndimage.maximum_filter1d(_median(sizes, WINDOW), WINDOW, mode="reflect")
    return found


def _missed(time: Array, path: Array, speed: Array) -> Array:
    """How far path and speed disagree on both sides of each sample, m."""
    gap = np.abs(np.diff(path) - 0.5 * (speed[1:] + speed[:-1]) * np.diff(time))
    both: Array = np.pad(gap, (1, 0)) + np.pad(gap, (0, 1))
    return both


def _between(time: Array, values: Array, mask: Mask) -> Array:
    """Masked samples on a cubic through the two good ones on either side."""
    mended: Array = values.copy()
    good = np.flatnonzero(~mask)
    for i in np.flatnonzero(mask):
        k = int(np.searchsorted(good, i))
        near = good[max(k - 2, 0) : k + 2]
        t, y = time[near] - time[i], values[near]
        # A cubic within the record, a line at its ends.
        mended[i] = np.dot(weights_at_zero(t), y)
    return mended


def _words(what: str, time: Array, mask: Mask, size: str) -> str:
    index = np.flatnonzero(mask)
    first = ", ".join(f"{t:.2f} s" for t in time[index[:3]])
    singles = count_of(len(index), "single sample")
    return f"{singles} of the {what} off by up to {size} (at {first})"
