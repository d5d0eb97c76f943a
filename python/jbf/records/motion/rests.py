"""Detection of the rests of a shaft or a slider, and of their ends."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from jbf.arrays import Array, Mask
from jbf.records.motion.roughness import noise_of

REST_SAMPLES = 3
"""Minimum number of consecutive zero speeds for a rest; fewer are a zero crossing."""
STILL_SAMPLES = 20
"""Minimum number of samples without an encoder step, at speeds of noise size, for a rest."""
STILL_STEPS = 1.5
"""Largest apparent displacement of the encoder during a rest, in steps."""
STILL_SHARE = 5e-3
"""Largest speed of a rest as a share of the top speed."""
REST_SPEED_SIGMAS = 5.0
"""Largest speed of a rest in standard deviations of the speed noise."""
MIN_MOTION_RATIO = 9.0
"""Minimum ratio of a speed in motion to the median in a rest: six standard deviations."""
MIN_DURATION_RATIO = 2.0
"""Minimum ratio of the duration of a rest to the time for which a reversal appears at rest."""


def resting_samples(velocity: Array) -> Mask:
    """Mask of the samples in sequences of at least `REST_SAMPLES` speeds of exactly zero."""
    zero = velocity == 0.0
    edges = np.diff(np.concatenate(([0], zero.astype(np.int8), [0])))
    rest = np.zeros(len(zero), dtype=bool)
    for first, end in zip(np.flatnonzero(edges == 1), np.flatnonzero(edges == -1), strict=True):
        if end - first >= REST_SAMPLES:
            rest[first:end] = True
    return rest


def still_samples(
    time_s: Array, path: Array, velocity: Array, step: float, hum: float = 0.0
) -> Mask:
    """Detect rests whose recorded speed is not exactly zero, shape (n,).

    In a rest of at least `STILL_SAMPLES` samples, the encoder stays within its step and the speed
    within `STILL_SHARE` of its top. If the noise of the speed exceeds this limit, the speed does
    not indicate a rest. The encoder must then stay within its step for long enough that the mean
    speed is below the limit.

    Slow reversals, which an encoder does not resolve either, are excluded.

    Parameters
    ----------
    path
        Recorded path, m.
    step
        The encoder step, m.
    hum
        Largest recorded speed, m/s, that is also treated as rest.
    """
    n = len(path)
    top = float(np.max(np.abs(velocity), initial=0.0))
    limit, noise = max(STILL_SHARE * top, hum), REST_SPEED_SIGMAS * noise_of(velocity)
    resting = _within_a_step(path, np.abs(velocity) <= limit, step, STILL_SAMPLES)
    if noise > limit > 0.0:
        longest = STILL_STEPS * step / (limit * float(np.median(np.diff(time_s))))
        samples = max(STILL_SAMPLES, int(np.ceil(min(longest, n))) + 1)
        resting |= _within_a_step(path, np.abs(velocity) <= noise, step, samples)
    edges = np.diff(np.concatenate(([0], resting.astype(np.int8), [0])))
    for first, end in zip(np.flatnonzero(edges == 1), np.flatnonzero(edges == -1), strict=True):
        if _reverses(time_s, velocity, int(first), int(end), step):
            resting[first:end] = False
            continue
        # A speed at the ends that exceeds the noise of the rest belongs to the motion.
        speed = np.abs(velocity[first:end])
        calm_at = np.flatnonzero(speed <= max(MIN_MOTION_RATIO * float(np.median(speed)), hum))
        resting[first : first + calm_at[0]] = False
        resting[first + calm_at[-1] + 1 : end] = False
    return resting


def _within_a_step(path: Array, slow: Mask, step: float, samples: int) -> Mask:
    """Mask of the slow samples whose path stays within the encoder step.

    These samples are in a window of `samples` slow samples over which the path varies by at most
    `STILL_STEPS` steps.
    """
    n = len(path)
    if n < samples or not slow.any():
        return np.zeros(n, dtype=bool)
    begins = (_ptp(path, samples) <= STILL_STEPS * step) & (_ptp(~slow, samples) == 0)
    begins &= slow[: len(begins)]
    ends = np.concatenate((np.zeros(samples), begins.astype(float)))
    covered = np.cumsum(np.concatenate((begins, np.zeros(samples)))) - np.cumsum(ends)
    within: Mask = covered[:n] > 0.5
    return within


def _ptp(values: npt.NDArray[Any], samples: int) -> Array:
    """Range (maximum minus minimum) of the values in each window, shape (n - samples + 1,)."""
    low: Array = values.astype(float)
    high = low
    width = 1
    while width < samples:
        # A window is the union of two narrower ones that may overlap.
        shift = min(width, samples - width)
        low, high = np.minimum(low[:-shift], low[shift:]), np.maximum(high[:-shift], high[shift:])
        width += shift
    span: Array = high - low
    return span


def _reverses(time_s: Array, velocity: Array, first: int, end: int, step: float) -> bool:
    """Whether one or two reversals explain an apparent rest.

    With the mean acceleration between the adjacent motions, a reversal would remain within the
    encoder step for about the same duration.
    """
    reach = min(end - first, STILL_SAMPLES)
    before, after = max(first - reach, 0), min(end + reach, len(time_s)) - 1
    v0, v1 = velocity[before], velocity[after]
    # A speed of the size of the rounding error is zero.
    slowest = 0.5 * STILL_SHARE * float(np.max(np.abs(velocity)))
    if min(abs(v0), abs(v1)) < slowest or v0 == v1 == 0.0:
        return False
    # Also covers a speed that touches zero, with two reversals or none.
    rate = (abs(v0) + abs(v1)) / (time_s[after] - time_s[before])
    still_s = 2.0 * np.sqrt(2.0 * STILL_STEPS * step / rate)
    return bool(time_s[end - 1] - time_s[first] < MIN_DURATION_RATIO * still_s)


def certain_rests(rest: Mask) -> Mask:
    """Mask of the inner part of each rest, without ends with possible motion of less than a count.

    Ends at the first or the last sample are not shortened.
    """
    certain: Mask = rest.copy()
    edges = np.diff(np.concatenate(([0], rest.astype(np.int8), [0])))
    for first, end in zip(np.flatnonzero(edges == 1), np.flatnonzero(edges == -1), strict=True):
        margin = min(int(end - first) // 3, STILL_SAMPLES)
        if first > 0:
            certain[first : first + margin] = False
        if end < len(rest):
            certain[end - margin : end] = False
    return certain


def rest_edges(rest: Mask, time_s: Array, velocity: Array, acceleration: Array) -> Mask:
    """Mask of the first and last samples of each rest that borders on motion.

    The shaft stops and starts between samples, so the state within one sample of it is unknown. A
    slow start begins before its speed is visible: the number of samples before it follows from the
    motion next to the rest.
    """
    at_edge = np.zeros(len(rest), dtype=bool)
    edges = np.diff(np.concatenate(([0], rest.astype(np.int8), [0])))
    for first, end in zip(np.flatnonzero(edges == 1), np.flatnonzero(edges == -1), strict=True):
        longest = min(int(end - first), STILL_SAMPLES)
        for moving, inward in ((first - 1, 1), (end, -1)):
            if not 0 <= moving < len(rest):
                continue
            v, a = velocity[moving], -inward * acceleration[moving]
            step_s = abs(time_s[moving + inward] - time_s[moving])
            ago = v / (a * step_s) if v * a > 0.0 else 0.0
            count = min(max(int(np.ceil(min(ago, longest))), 1), longest)
            inside = moving + inward * np.arange(1, count + 1)
            at_edge[inside] = True
    return at_edge


def backward_near_rest(rest: Mask, time_s: Array, velocity: Array, acceleration: Array) -> Mask:
    """Mask of the samples next to a rest that decelerate after it or accelerate towards it.

    Physically, the shaft accelerates after a rest and decelerates before one. Only speeds below the
    change of speed in one sampling interval are considered.
    """
    backward = np.zeros(len(rest), dtype=bool)
    step_s = np.gradient(time_s) if len(time_s) > 1 else np.zeros(len(time_s))
    small = np.abs(velocity) < np.abs(acceleration) * step_s
    growing = velocity * acceleration
    edges = np.diff(np.concatenate(([0], (~rest).astype(np.int8), [0])))
    for first, end in zip(np.flatnonzero(edges == 1), np.flatnonzero(edges == -1), strict=True):
        part = slice(first, end)
        if first > 0:
            slows = small[part] & (growing[part] < 0.0)
            backward[part] |= np.logical_and.accumulate(slows)
        if end < len(rest):
            speeds = (small[part] & (growing[part] > 0.0))[::-1]
            backward[part] |= np.logical_and.accumulate(speeds)[::-1]
    return backward


def uncertain_near_rest(rest: Mask, path: Array, velocity: Array, shift: float) -> Mask:
    """Mask of samples next to a rest within a displacement of `shift`, m, along the speed.

    A polynomial oscillates at the onset of a motion, and does not determine the first direction.
    """
    unsure = np.zeros(len(rest), dtype=bool)
    edges = np.diff(np.concatenate(([0], (~rest).astype(np.int8), [0])))
    for first, end in zip(np.flatnonzero(edges == 1), np.flatnonzero(edges == -1), strict=True):
        direction = np.sign(velocity[first:end])
        if first > 0:
            displaced = (path[first:end] - path[first - 1]) * direction > shift
            unsure[first:end] |= ~np.logical_or.accumulate(displaced)
        if end < len(rest):
            displaced = ((path[end] - path[first:end]) * direction > shift)[::-1]
            unsure[first:end] |= ~np.logical_or.accumulate(displaced)[::-1]
    return unsure


def without_swings(rest: Mask, velocity: Array, sign_known: Mask) -> None:
    """Set reversed velocities next to a rest to zero, in place.

    The samples between a rest and the nearest sample with a known sign are changed, since a shaft
    does not reverse directly before or after a rest.
    """
    edges = np.diff(np.concatenate(([0], (~rest).astype(np.int8), [0])))
    for first, end in zip(np.flatnonzero(edges == 1), np.flatnonzero(edges == -1), strict=True):
        sign_known_at = np.flatnonzero(sign_known[first:end])
        if not len(sign_known_at):
            continue
        v = velocity[first:end]
        if first > 0:
            start = v[: sign_known_at[0]]
            start[start * v[sign_known_at[0]] < 0.0] = 0.0
        if end < len(rest):
            stop = v[sign_known_at[-1] + 1 :]
            stop[stop * v[sign_known_at[-1]] < 0.0] = 0.0
