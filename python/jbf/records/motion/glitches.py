"""Outliers of a motion: single positions, or single speeds that contradict the path."""

from __future__ import annotations

import numpy as np

from jbf.arrays import Array, Mask
from jbf.records.counts import count_of
from jbf.records.findings.ends import end_outliers, ends_finding
from jbf.records.findings.finding import Finding
from jbf.records.lagrange import weights_at_zero
from jbf.records.motion.position import Position
from jbf.records.motion.roughness import step_of

MIN_SIGMAS = 8.0
"""Minimum deviation of a sample, in local standard deviations."""
MIN_COUNTS = 3.0
"""Minimum deviation, in encoder counts; rounding deviates by less than 1.5 counts from a cubic."""
MIN_NEIGHBOUR_RATIO = 0.825
"""Minimum opposite deviation of the adjacent samples, relative to the effect of an outlier on them.

That effect is two thirds of the deviation at even steps. At a corner or a step the ratio is three
quarters.
"""
MIN_JUMP_RATIO = 0.4
"""Minimum deviation relative to the change of the speed across the sample times a time step."""
MIN_CHANGES = 3.0
"""Minimum deviation of a speed, relative to the usual change; above the deviation at corners."""
MIN_CHANGE_RATIO = 0.5
"""Minimum ratio of the smaller to the larger of the two changes at an outlier of a speed."""
WINDOW = 41
"""Window of the local noise and of the usual change, samples."""
MAX_OUTLIER_SHARE = 0.02
"""Largest share of outliers; with more of them, the record has large noise instead."""
MAX_OUTLIER_SHARE_WITHOUT_PATH = 0.003
"""Largest share of outliers of a speed without a path; a real slip may be as short."""
LEAST_SAMPLES = 60
EXCLUDED = "excluded from the motion"


def mend_position(name: str, time: Array, position: Position) -> tuple[Position, Finding | None]:
    """Interpolate the path across its outliers."""
    path = position.path_m
    threshold, mask = MIN_COUNTS * step_of(path), np.zeros(len(path), dtype=bool)
    while mask.sum() <= MAX_OUTLIER_SHARE * len(path):
        # Of two adjacent outliers, the second is detected once the first is excluded.
        valid = np.flatnonzero(~mask)
        further = valid[_path_outliers(time[valid], path[valid], threshold)]
        if not len(further):
            break
        mask[further] = True
    if not 0 < mask.sum() <= MAX_OUTLIER_SHARE * len(path):
        return position, None
    mended = _interpolated(time, path, mask)
    size = float(np.max(np.abs(path - mended))) / position.arm_m
    words = _words("position", time, mask, f"{size:.3g} {position.unit}")
    finding = Finding("glitches", position.column, name, size, position.unit, EXCLUDED, words)
    return position.along(mended), finding


def mend_speed(
    name: str, time: Array, speed: Array, path: Array | None, unit: str = "m/s"
) -> tuple[Array, Finding | None]:
    """Interpolate the speed across its outliers; if there is a path, only where it disagrees."""
    n = len(speed)
    if n < LEAST_SAMPLES:
        return speed, None
    before, after = _differences(np.diff(speed))
    typical = _local_median(np.abs(np.diff(speed)))
    deviation = _smaller_difference(before, after)
    deviation[deviation <= MIN_CHANGES * np.maximum(typical[:-1], typical[1:])] = 0.0
    bend = _local_median(np.abs(before + after)) / 0.6745 / np.sqrt(6.0)
    deviation[deviation <= MIN_SIGMAS * bend] = 0.0
    mask = np.concatenate(([False], deviation != 0.0, [False]))
    # In a record without noise, every corner would exceed the threshold.
    if np.median(np.abs(before + after)) == 0.0:
        return speed, None
    if path is not None and mask.any():
        mended = _interpolated(time, speed, mask)
        mask &= _displacement_error(time, path, speed) > 2.0 * _displacement_error(
            time, path, mended
        )
    if (
        not 0
        < mask.sum()
        <= (MAX_OUTLIER_SHARE_WITHOUT_PATH if path is None else MAX_OUTLIER_SHARE) * n
    ):
        return speed, None
    mended = _interpolated(time, speed, mask)
    size = float(np.max(np.abs(speed - mended)))
    words = _words("speed", time, mask, f"{size:.3g} {unit}")
    return mended, Finding("glitches", "velocity_m_s", name, size, unit, EXCLUDED, words)


def mend_path_ends(
    name: str, time: Array, position: Position
) -> tuple[Position, Mask, list[Finding]]:
    """Extrapolate the path across outliers at its ends; also return their mask and the findings."""
    path = position.path_m
    mask = end_outliers(time, path, 3)
    mended = _interpolated(time, path, mask)
    deviation = (path - mended) / position.arm_m
    finding = ends_finding(
        position.column, "position", name, mask, deviation, position.unit, EXCLUDED
    )
    return (position.along(mended) if finding else position), mask, [finding] if finding else []


def mend_speed_ends(
    name: str, time: Array, speed: Array, path: Array | None, unit: str
) -> tuple[Array, Mask, list[Finding]]:
    """Extrapolate the speed across outliers at its ends; with a path, only if the path disagrees.

    Also returns their mask and the findings.
    """
    mask = end_outliers(time, speed, 1)
    mended = _interpolated(time, speed, mask)
    if path is not None and mask.any():
        missed = _displacement_error(time, path, speed) > 2.0 * _displacement_error(
            time, path, mended
        )
        if not missed[mask].all():
            mask[:], mended = False, speed
    finding = ends_finding("velocity_m_s", "speed", name, mask, speed - mended, unit, EXCLUDED)
    return mended, mask, [finding] if finding else []


def _path_outliers(time: Array, path: Array, threshold: float) -> Mask:
    """Mask of the samples that deviate from a cubic through two adjacent samples on either side."""
    n = len(path)
    mask = np.zeros(n, dtype=bool)
    if n < LEAST_SAMPLES:
        return mask
    t = np.stack([time[k : n - 4 + k] - time[2 : n - 2] for k in (0, 1, 3, 4)])
    y = np.stack([path[k : n - 4 + k] - path[2 : n - 2] for k in (0, 1, 3, 4)])
    weights = weights_at_zero(t)
    deviation = -np.sum(weights * y, axis=0)
    size = np.abs(deviation)
    outlying = size > np.maximum(MIN_SIGMAS * _local_median(size) / 0.6745, threshold)
    # An outlier causes opposite deviations at the adjacent samples, by its weight in their cubics.
    for neighbour, weight in (
        (np.pad(deviation, (1, 0))[:-1], np.pad(weights[2], (1, 0))[:-1]),
        (np.pad(deviation, (0, 1))[1:], np.pad(weights[1], (0, 1))[1:]),
    ):
        outlying &= (-neighbour * deviation > MIN_NEIGHBOUR_RATIO * weight * size**2) & (
            np.abs(neighbour) < size
        )
    # At a jump of the speed, the steps on both sides differ by three times the deviation.
    outlying &= size > MIN_JUMP_RATIO * np.abs((y[3] - y[2]) - (y[1] - y[0]))
    mask[2:-2] = outlying
    return mask


def _differences(change: Array) -> tuple[Array, Array]:
    """Difference of each inner sample from the previous one, and from the next one."""
    return change[:-1], -change[1:]


def _smaller_difference(before: Array, after: Array) -> Array:
    """The smaller of two differences, or zero if their signs differ or magnitudes do not match."""
    smaller, larger = (
        np.minimum(np.abs(before), np.abs(after)),
        np.maximum(np.abs(before), np.abs(after)),
    )
    deviation = np.where(
        (before * after > 0.0) & (smaller > MIN_CHANGE_RATIO * larger), smaller, 0.0
    )
    # Samples next to an outlier deviate from it as well, so only the largest deviation is kept.
    largest = np.maximum(np.pad(deviation, (1, 0))[:-1], np.pad(deviation, (0, 1))[1:])
    excess: Array = np.where(deviation > largest, deviation, 0.0)
    return excess


def _median(values: Array, window: int) -> Array:
    """Running median over a window of samples."""
    from scipy import ndimage  # importing takes most of a second

    median: Array = ndimage.median_filter(values, window, mode="reflect")
    return median


def _local_median(sizes: Array) -> Array:
    """Largest median of sizes in the centred, preceding and following windows of each sample.

    Next to a rest, half of the centred window has no noise.
    """
    from scipy import ndimage

    largest: Array = ndimage.maximum_filter1d(_median(sizes, WINDOW), WINDOW, mode="reflect")
    return largest


def _displacement_error(time: Array, path: Array, speed: Array) -> Array:
    """Displacement, m, by which path and speed disagree both before and after each sample."""
    gap = np.abs(np.diff(path) - 0.5 * (speed[1:] + speed[:-1]) * np.diff(time))
    both: Array = np.pad(gap, (1, 0)) + np.pad(gap, (0, 1))
    return both


def _interpolated(time: Array, values: Array, mask: Mask) -> Array:
    """Replace masked samples by a cubic through the two valid ones on either side."""
    mended: Array = values.copy()
    valid = np.flatnonzero(~mask)
    for i in np.flatnonzero(mask):
        k = int(np.searchsorted(valid, i))
        support = valid[max(k - 2, 0) : k + 2]
        t, y = time[support] - time[i], values[support]
        # A cubic within the record, a straight line at its ends.
        mended[i] = np.dot(weights_at_zero(t), y)
    return mended


def _words(what: str, time: Array, mask: Mask, size: str) -> str:
    """Text of the finding on outliers: their number, time and size."""
    index = np.flatnonzero(mask)
    first = ", ".join(f"{t:.2f} s" for t in time[index[:3]])
    singles = count_of(len(index), "outlier")
    return f"{singles} in the {what}, up to {size} (first at {first})"
