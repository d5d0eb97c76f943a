"""Interpolated samples: a slow channel interpolated linearly at the instants of a faster one.

Such a record is a polygonal line, up to the rounding of the last digit, and its corners are the
original readings. The period and the phase of the corners are searched such that the polygonal line
passes through every sample. Only the corners were measured; the samples between them were not.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jbf.arrays import Array
from jbf.records.findings.digits import last_digit, resolution
from jbf.records.findings.polygon import polygon, polygon_rms, refined
from jbf.records.findings.steps import step_of

WINDOW = 40
"""Window length of the first search, samples."""
LONG_WINDOW = 240
"""Window length of the search for shorter periods, samples.

If a polygon has nearly as many corners as samples, few degrees of freedom remain to test it.
"""
SHORT_PERIODS = (1.05, 1.3)
"""Range of periods for a channel with nearly the sampling rate of the record, samples."""
BEAT_COUNT, BEAT_OFFSETS = 4, np.linspace(-1.0, 1.0, 9)
"""Number of strongest beat frequencies that are tested, and offsets from each of them.

The offsets are in units of the reciprocal of the analysed length.
"""
SEGMENT_LENGTH = 960
"""Length of the analysed segment, samples."""
WINDOW_COUNT = 3
"""Number of windows along the record, and of further windows with the most non-zero differences.

The further windows are required because a coarsely quantised record has long constant segments.
"""
MAX_BEND_SHARE = 0.5
"""Share of non-zero second differences above which no further windows are selected."""
PERIODS = np.exp(
    np.concatenate(
        [np.arange(np.log(1.2), np.log(8.0), 0.005), np.arange(np.log(8.0), np.log(25.0), 0.02)]
    )
)
"""Periods that are searched, in samples; coarser if a window contains few periods."""
PHASES = np.arange(0.0, 1.0, 0.1)
"""Phases that are searched, in periods."""
REFINED_COUNT = 8
"""Number of the best candidates that are refined."""
MIN_DEGREES_OF_FREEDOM = 6
"""Smallest number of degrees of freedom of a window: samples minus corners."""
LIKELY, LIKELY_SHORT, EXACT = 0.25, 0.5, 0.005
"""Largest RMS residuals of a polygon, relative to the noise.

The limits are for refinement, for refinement at a short period (coarser grid relative to the window
length), and for acceptance.
"""
OTHER_PHASES, MAX_PHASE_RATIO = (0.31, 0.5, 0.69), 0.03
"""Other phases, in periods from the best one, and the largest ratio of the residuals.

The residual at the best phase must be below this share of the smallest residual at the others.
"""
MAX_NOISE_RATIO = 3.0
"""Upper bound of the noise estimate, relative to the median; limits the effect of large changes."""
MAX_ROUNDING_RATIO, MAX_ROUNDING_TO_NOISE = 3.0, 0.05
"""Largest residual due to rounding to the last digit.

The first limit is relative to the rounding error, the second to the noise.
"""
END_DIGITS = 20.0
"""Largest distance from an end of the range at which a corner is set to that end, in digits."""
LONG_LAG, MIN_ROUGHNESS = 13, 0.93
"""Lag, samples, and ratio of second differences above which adjacent samples are uncorrelated."""
ROUNDING = 1e-7
"""Noise relative to the range below which it is zero: rounding, and tolerance of the search."""
SMOOTH = 0.5
"""Largest ratio of third to second differences of a smooth curve; above one for noise."""
MANY_CORNERS, MOST_CORNERS = 0.9, 0.955
"""Ratios of the number of corners to the number of samples.

Above the first ratio, a stricter roughness test applies to the corners. The second is the largest
permitted ratio, since corners at a higher ratio would be the samples themselves.
"""


@dataclass(frozen=True)
class Native:
    """Original readings of an interpolated record: instants, s, and values, shape (m,)."""

    time_s: Array
    values: Array
    period_s: float


def find_native(time: Array, values: Array) -> Native | None:
    """Recover the original readings of an interpolated channel; None if it is not interpolated."""
    n = len(time)
    if n < 2 * WINDOW or _as_rough_as_noise(values) or is_smooth(values):
        return None
    step = float(np.median(np.diff(time)))
    rounding = max(ROUNDING * float(np.ptp(values)), 4.0 * last_digit(values))
    for first in _search_windows(values, rounding):
        part = slice(first, first + WINDOW)
        t, y = time[part], values[part]
        noise = _noise(y, rounding)
        if noise == 0.0 or np.ptp(t) > 1.2 * WINDOW * step:
            continue
        for candidate in _coarse_search(t, y, step, noise):
            period, phase = refined(t, y, *candidate)
            if polygon(t, y, period, phase)[0] < _exact(values, noise):
                native = _extended_polygon(time, values, first, WINDOW, period, phase, noise)
                if native is not None:
                    return native
    return _of_short_period(time, values, step)


def find_native_of(time: Array, values: Array, period_s: float) -> Native | None:
    """Recover the original readings with a known period; None if it does not fit.

    The period is that of another run of the same logger.
    """
    if len(time) < 2 * WINDOW or is_smooth(values):
        return None
    noise = _noise(values, max(ROUNDING * float(np.ptp(values)), 4.0 * last_digit(values)))
    if noise == 0.0:
        return None
    fits = [refined(time, values, period_s, p * period_s, near=True) for p in PHASES.tolist()]
    best = min(fits, key=lambda fit: polygon(time, values, *fit)[0])
    return _fit_polygon(time, values, *best, noise)


def _noise(values: Array, rounding: float) -> float:
    """Standard deviation of white noise in a window; zero for a straight line.

    The estimate is robust to a single large jump and to straight segments.
    """
    bends = np.abs(np.diff(values, 2))
    rms = float(np.sqrt(np.mean(bends**2) / 6.0))
    if rms <= rounding:
        return 0.0
    median_noise = float(np.median(bends[bends > rounding])) / 0.6745 / np.sqrt(6.0)
    return float(min(rms, MAX_NOISE_RATIO * median_noise))


def _exact(values: Array, noise: float) -> float:
    """Largest RMS residual at which a polygon is accepted: a share of the noise, or rounding."""
    digits = MAX_ROUNDING_RATIO * resolution(values) / np.sqrt(12.0)
    return float(max(EXACT * noise, min(digits, MAX_ROUNDING_TO_NOISE * noise)))


def _search_windows(values: Array, rounding: float) -> list[int]:
    """Index of the first sample of each window in which a polygon is searched.

    The windows are spread over the record; further ones are where the values change most often.
    """
    last = len(values) - WINDOW
    bends = np.abs(np.diff(values, 2)) > rounding
    along: list[int] = np.linspace(0, last, WINDOW_COUNT).astype(int).tolist()
    if bends.mean() > MAX_BEND_SHARE:
        return along
    # Number of non-zero second differences in the window that begins at each sample.
    often = np.convolve(bends, np.ones(WINDOW - 2), "valid")[: last + 1]
    for _ in range(WINDOW_COUNT):
        busiest = int(np.argmax(often))
        along.append(busiest)
        often[max(busiest - WINDOW, 0) : busiest + WINDOW] = -1.0
    return list(dict.fromkeys(along))


def _of_short_period(time: Array, values: Array, step: float) -> Native | None:
    """Recover the readings of a channel with nearly the sampling rate of the record."""
    n = len(time)
    if n < 2 * LONG_WINDOW:
        return None
    first = (n - LONG_WINDOW) // 2
    t, y = time[first : first + LONG_WINDOW], values[first : first + LONG_WINDOW]
    # Median, since relative to the RMS the residual of filtered jumps would also be small.
    noise = float(np.median(np.abs(np.diff(y, 2))) / 0.6745 / np.sqrt(6.0))
    if noise <= ROUNDING * float(np.ptp(values)) or np.ptp(t) > 1.2 * LONG_WINDOW * step:
        return None
    periods, phases = _grid(_beats(time, values, step))
    each = polygon_rms(t, y, periods, phases)
    # The residual of any such polygon is small for a record that was smoothed by a filter.
    median_residual = float(np.median(each))
    best = np.argsort(each, kind="stable")[:REFINED_COUNT]
    for residual, period, phase in np.stack([each, periods, phases])[:, best].T.tolist():
        if residual > LIKELY_SHORT * noise:
            break
        period, phase = refined(t, y, period, phase)
        if polygon(t, y, period, phase)[0] < _exact(values, min(noise, median_residual)):
            native = _extended_polygon(time, values, first, LONG_WINDOW, period, phase, noise)
            if native is not None:
                return native
    return None


def _beats(time: Array, values: Array, step: float) -> Array:
    """Candidate periods of interpolation, s, from the modulation of the noise variance.

    The noise variance of an interpolated sample is smallest in the middle between two readings.
    """
    n = min(len(time), SEGMENT_LENGTH)
    first = (len(time) - n) // 2
    place = (time[first + 1 : first + n - 1] - time[first]) / step
    rough = np.abs(np.diff(values[first : first + n], 2))
    rank = np.argsort(np.argsort(rough, kind="stable"), kind="stable") / len(rough) - 0.5
    lowest, highest = (1.0 - 1.0 / period for period in SHORT_PERIODS)
    frequency = np.arange(lowest, highest, 0.5 / n)
    power = np.abs(np.exp(-2j * np.pi * frequency[:, None] * place) @ rank)
    best = np.argsort(-power, kind="stable")[:BEAT_COUNT]
    beat = (frequency[best, None] + BEAT_OFFSETS / n).ravel()
    return np.asarray(step / (1.0 - beat))


def _grid(periods: Array) -> tuple[Array, Array]:
    """All combinations of periods and phases of the search grid, s."""
    each = np.repeat(periods, len(PHASES))
    return each, np.tile(PHASES, len(periods)) * each


def _as_rough_as_noise(values: Array) -> bool:
    """Whether adjacent samples are uncorrelated, which excludes interpolation."""
    adjacent = np.median(np.abs(values[2:] - 2.0 * values[1:-1] + values[:-2]))
    distant = np.median(
        np.abs(values[2 * LONG_LAG :] - 2.0 * values[LONG_LAG:-LONG_LAG] + values[: -2 * LONG_LAG])
    )
    return bool(adjacent > MIN_ROUGHNESS * distant)


def is_smooth(values: Array, share: float = SMOOTH) -> bool:
    """Whether a record has no noise, so that a polygon fits it without interpolation."""
    second, third = np.abs(np.diff(values, 2)), np.abs(np.diff(values, 3))
    return bool(np.quantile(third, 0.7) < share * np.quantile(second, 0.7))


def _extended_polygon(
    time: Array,
    values: Array,
    first: int,
    length: int,
    period: float,
    phase: float,
    noise: float,
) -> Native | None:
    """Extend the polygon of a window of `length` samples to the whole record; None if it fails."""
    n = len(time)
    begin = first
    while length < n:
        # The accuracy of the period is proportional to the length of the segment.
        length = min(4 * length, n)
        origin = time[begin]
        begin = max(min(first - length // 2, n - length), 0)
        phase += origin - time[begin]
        part = slice(begin, begin + length)
        period, phase = refined(time[part], values[part], period, phase)
    period, phase = _longest(time, values, period, phase, noise)
    if _fit_polygon(time, values, period, phase, noise) is None:
        return None
    period, phase = refined(time, values, period, phase, near=True)
    return _fit_polygon(time, values, period, phase, noise)


def _longest(
    time: Array, values: Array, period: float, phase: float, noise: float
) -> tuple[float, float]:
    """Longest multiple of a period, with its phase, at which the polygon still fits.

    Corners at a fraction of the true period fit equally well, but are not readings.
    """
    for times in (17, 13, 11, 7, 5, 3, 2):
        for k in range(times):
            longer = (times * period, phase + k * period)
            residual, _, _ = polygon(time, values, *longer)
            if residual < MAX_ROUNDING_TO_NOISE * noise:
                # Refine again, since the error of the shorter period is multiplied as well.
                longer = refined(time, values, *longer, near=True)
                residual, _, _ = polygon(time, values, *longer)
            if residual < _exact(values, noise):
                return _longest(time, values, *longer, noise)
    return period, phase


def _fit_polygon(
    time: Array, values: Array, period: float, phase: float, noise: float
) -> Native | None:
    """Fit a polygon of given period and phase to a record; None if the residual is too large."""
    residual, knots, corners = polygon(time, values, period, phase)
    inside = (knots >= time[0]) & (knots <= time[-1]) & np.isfinite(corners)
    if residual > _exact(values, noise) or inside.sum() > MOST_CORNERS * len(time):
        return None
    # The residual is small at every phase for a record that was smoothed by a filter.
    elsewhere = [polygon(time, values, period, phase + s * period)[0] for s in OTHER_PHASES]
    if residual > MAX_PHASE_RATIO * min(elsewhere):
        return None
    read = _at_ends(corners[inside], values)
    native = Native(knots[inside], read, period)
    if step_of(read, drawn=True) > 0.0:
        return native
    # Corners on a smooth curve or a plateau belong to a record without noise. If the number of
    # corners is nearly that of the samples, a polygon fits any curve.
    curved = SMOOTH if inside.sum() < MANY_CORNERS * len(time) else 2.0 * SMOOTH
    flat = np.quantile(np.abs(np.diff(read, 2)), 0.7) <= ROUNDING * np.ptp(read)
    return None if flat or is_smooth(read, curved) else native


def _at_ends(read: Array, values: Array) -> Array:
    """Set corners near an end of the range, within the accuracy of the digits, to that end."""
    tolerance = max(END_DIGITS * last_digit(values), ROUNDING * float(np.ptp(values)))
    for end in (float(np.min(values)), float(np.max(values))):
        read = np.where(np.abs(read - end) < tolerance, end, read)
    return read


def _coarse_search(t: Array, y: Array, step: float, noise: float) -> list[tuple[float, float]]:
    """Find periods and phases, s, of polygons that nearly fit a window, best first.

    Several candidates are returned, because a wrong candidate may have the smallest residual on
    this grid if the number of corners is close to the number of samples.
    """
    long_enough = len(t) - np.ceil(np.ptp(t) / (PERIODS * step)) - 2 >= MIN_DEGREES_OF_FREEDOM
    periods, phases = _grid(PERIODS[long_enough] * step)
    each = polygon_rms(t, y, periods, phases)
    best = [k for k in np.argsort(each, kind="stable").tolist() if each[k] < LIKELY * noise]
    phase_of_period = {periods[k]: phases[k] for k in reversed(best)}
    return [(period, phase_of_period[period]) for period in dict.fromkeys(periods[best].tolist())][
        :REFINED_COUNT
    ]
