"""Interpolated samples: a slow channel drawn as straight lines onto the instants of a faster one.

Between the instants at which the force was read, such a record is a polygon, to the last digit. The
readings are its corners: their period and phase are searched so that a polygon with corners there
goes through every sample. Nothing is resampled: the corners are what was read, and the samples in
between never were.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import numpy.typing as npt
from scipy import linalg

Array = npt.NDArray[np.float64]

WINDOW = 40
"""Samples of a first look."""
LONGER = 240
"""Samples of a look for shorter periods: nearly as many corners as samples leave a polygon little
to be tested by."""
SHORT = np.exp(np.arange(np.log(1.05), np.log(1.3), 0.0005))
"""Periods looked for there, in samples."""
LOOKS = 3
"""First looks, along the record."""
PERIODS = np.exp(
    np.concatenate(
        [np.arange(np.log(1.2), np.log(8.0), 0.005), np.arange(np.log(8.0), np.log(25.0), 0.02)]
    )
)
"""Periods looked for, in samples: a window of few periods tells them less sharply."""
PHASES = np.arange(0.0, 1.0, 0.1)
"""Phases looked for, in periods."""
FOLLOWED = 8
"""Of them followed."""
LEAST_FREE = 6
"""Samples of a window beyond its corners."""
LIKELY, LIKELY_SHORT, EXACT = 0.25, 0.5, 0.005
"""What a polygon leaves, as shares of the noise: for a second look, for one at a short period
(whose grid is coarser for so long a window), and to be believed."""
ELSEWHERE, CLEARLY = (0.31, 0.5, 0.69), 0.03
"""Phases, in periods off the best, at which a polygon must leave more, and the share of that which
the best may leave."""
IN_VAIN = 4
"""Halvings of a search after which it has come nearer, or does not."""
FAR, ROUGH = 13, 0.93
"""Samples apart, and a ratio of bends, by which a record is as rough as noise."""
ROUNDING = 1e-7
"""Share of the whole range below which noise is none: that of digits, and of the search."""
SMOOTH = 0.5
"""Third over second differences of a curve; noise, drawn as lines or not, has more than one."""
AT_ONCE = 2**13
"""Samples of polygons that are solved at once."""
EVEN = 1e-3
"""Samples are evenly spaced where they are off an even grid by less than this share of a step."""
MANY_CORNERS, MOST_CORNERS = 0.9, 0.955
"""Corners a sample: from the first on they must be rougher than a curve; more than the second would
be the samples themselves."""


@dataclass(frozen=True)
class Native:
    """The readings behind an interpolated record: instants, s, and values, shape (m,)."""

    time_s: Array
    values: Array
    period_s: float


def find_native(time: Array, values: Array) -> Native | None:
    """The readings of a slow channel behind its samples; None where the samples are its own."""
    n = len(time)
    if n < 2 * WINDOW or _as_rough_as_noise(values) or is_smooth(values):
        return None
    step = float(np.median(np.diff(time)))
    for first in np.linspace(0, n - WINDOW, LOOKS).astype(int).tolist():
        part = slice(first, first + WINDOW)
        t, y = time[part], values[part]
        noise = float(np.sqrt(np.mean(np.diff(y, 2) ** 2) / 6.0))
        if noise <= ROUNDING * float(np.ptp(values)) or np.ptp(t) > 1.2 * WINDOW * step:
            continue
        for found in _first_look(t, y, step, noise):
            period, phase = _sharpened(t, y, *found)
            if _polygon(t, y, period, phase)[0] < EXACT * noise:
                native = _whole(time, values, first, WINDOW, period, phase, noise)
                if native is not None:
                    return native
    return _of_short_period(time, values, step)


def _of_short_period(time: Array, values: Array, step: float) -> Native | None:
    """The same of a channel that is hardly slower than its record."""
    n = len(time)
    if n < 2 * LONGER:
        return None
    first = (n - LONGER) // 2
    t, y = time[first : first + LONGER], values[first : first + LONGER]
    # The usual one: of jumps behind a filter such a polygon leaves little, too.
    noise = float(np.median(np.abs(np.diff(y, 2))) / 0.6745 / np.sqrt(6.0))
    if noise <= ROUNDING * float(np.ptp(values)) or np.ptp(t) > 1.2 * LONGER * step:
        return None
    periods = np.repeat(SHORT * step, len(PHASES))
    phases = np.tile(PHASES, len(SHORT)) * periods
    lefts = _lefts(t, y, periods, phases)
    # Through a curve that a filter has made smooth any such polygon goes nearly.
    usual = float(np.median(lefts))
    best = np.argsort(lefts, kind="stable")[:FOLLOWED]
    for left, period, phase in np.stack([lefts, periods, phases])[:, best].T.tolist():
        if left > LIKELY_SHORT * noise:
            break
        period, phase = _sharpened(t, y, period, phase)
        if _polygon(t, y, period, phase)[0] < EXACT * min(noise, usual):
            native = _whole(time, values, first, LONGER, period, phase, noise)
            if native is not None:
                return native
    return None


def _as_rough_as_noise(values: Array) -> bool:
    """True where neighbours differ as much as samples far apart: nothing was drawn between them."""
    near = np.median(np.abs(values[2:] - 2.0 * values[1:-1] + values[:-2]))
    far = np.median(np.abs(values[2 * FAR :] - 2.0 * values[FAR:-FAR] + values[: -2 * FAR]))
    return bool(near > ROUGH * far)


def is_smooth(values: Array, share: float = SMOOTH) -> bool:
    """True of a record without noise: a polygon goes through any smooth curve."""
    second, third = np.abs(np.diff(values, 2)), np.abs(np.diff(values, 3))
    return bool(np.quantile(third, 0.7) < share * np.quantile(second, 0.7))


def _whole(
    time: Array,
    values: Array,
    first: int,
    length: int,
    period: float,
    phase: float,
    noise: float,
) -> Native | None:
    """The corners of the whole record, from what a window of so many samples tells of them."""
    n = len(time)
    begin = first
    while length < n:
        # Four times as long a stretch makes the period four times as sharp.
        length = min(4 * length, n)
        origin = time[begin]
        begin = max(min(first - length // 2, n - length), 0)
        phase += origin - time[begin]
        part = slice(begin, begin + length)
        period, phase = _sharpened(time[part], values[part], period, phase)
    period, phase = _longest(time, values, period, phase, noise)
    return _whole_of(time, values, period, phase, noise)


def _longest(
    time: Array, values: Array, period: float, phase: float, noise: float
) -> tuple[float, float]:
    """The longest multiple of a period whose polygon fits: corners at a fraction of the true one
    fit as well, and are not readings."""
    for times in (17, 13, 11, 7, 5, 3, 2):
        for k in range(times):
            left, _, _ = _polygon(time, values, times * period, phase + k * period)
            if left < EXACT * noise:
                return _longest(time, values, times * period, phase + k * period, noise)
    return period, phase


def _whole_of(
    time: Array, values: Array, period: float, phase: float, noise: float
) -> Native | None:
    left, knots, corners = _polygon(time, values, period, phase)
    inside = (knots >= time[0]) & (knots <= time[-1]) & np.isfinite(corners)
    if left > EXACT * noise or inside.sum() > MOST_CORNERS * len(time):
        return None
    # Through a record that a filter has made smooth, a polygon of any phase goes nearly.
    elsewhere = [_polygon(time, values, period, phase + s * period)[0] for s in ELSEWHERE]
    if left > CLEARLY * min(elsewhere):
        return None
    read = corners[inside]
    # Corners on a curve, or on a plateau, are of a record without noise; those nearly as close as
    # samples go through any curve.
    curved = SMOOTH if inside.sum() < MANY_CORNERS * len(time) else 2.0 * SMOOTH
    if is_smooth(read, curved) or np.quantile(np.abs(np.diff(read, 2)), 0.7) <= ROUNDING * np.ptp(
        read
    ):
        return None
    return Native(knots[inside], read, period)


def _first_look(t: Array, y: Array, step: float, noise: float) -> list[tuple[float, float]]:
    """Periods and phases, s, with which a polygon nearly goes through a window's samples, best
    first: with corners nearly as many as samples a wrong one may come nearer on this grid."""
    place = (t - t[0]) / step
    even = float(np.max(np.abs(place - np.arange(len(t))))) < EVEN
    looks = _even_looks(len(t)) if even else _looks(place)
    above = y - y[0]
    taken = np.add.reduceat((looks.basis @ above) ** 2, looks.begins).reshape(-1, len(PHASES))
    square = np.maximum(float(above @ above) - taken, 0.0) / looks.free[:, None]
    best = np.argmin(square, axis=1)
    left = np.sqrt(np.min(square, axis=1))
    likely = np.flatnonzero(left < LIKELY * noise)
    found = [
        (float(left[i]), float(looks.periods[i]) * step, float(PHASES[best[i]])) for i in likely
    ]
    return [(period, phase * period) for _, period, phase in sorted(found)[:FOLLOWED]]


@dataclass(frozen=True)
class _Looks:
    """The polygons of every period and phase of a first look, at given places.

    Attributes
    ----------
    periods, free
        Periods, in samples, and how many samples each leaves beyond its corners, shape (p,).
    basis
        What spans the polygons of one period and phase after the other, orthonormal, shape
        (rows, n).
    begins
        Where each one's rows begin.
    """

    periods: Array
    free: Array
    basis: Array
    begins: npt.NDArray[np.intp]


def _looks(place: Array) -> _Looks:
    n = len(place)
    counts = np.ceil((place[-1] - place[0]) / PERIODS).astype(np.intp) + 2
    periods, parts, rows = [], [], []
    # Those of as many corners at once.
    for count in np.unique(counts[n - counts >= LEAST_FREE]).tolist():
        own = PERIODS[counts == count]
        at = place[None, None, :] / own[:, None, None] - PHASES[None, :, None] + 1.0
        at = at.reshape(-1, n)
        low = np.clip(np.floor(at).astype(np.intp), 0, count - 2)
        share = at - low
        design = np.zeros((len(at), n, count))
        one, row = np.arange(len(at))[:, None], np.arange(n)[None, :]
        design[one, row, low] = 1.0 - share
        design[one, row, low + 1] = share
        basis, _ = np.linalg.qr(design)
        periods.append(own)
        parts.append(np.swapaxes(basis, 1, 2).reshape(-1, n))
        rows.append(np.full(len(at), count))
    corners = np.concatenate(rows)
    return _Looks(
        periods=np.concatenate(periods),
        free=(n - corners[:: len(PHASES)]).astype(np.float64),
        basis=np.concatenate(parts),
        begins=np.cumsum(corners) - corners,
    )


@lru_cache(maxsize=1)
def _even_looks(n: int) -> _Looks:
    """The same for evenly spaced samples, kept: nearly every record's are."""
    return _looks(np.arange(n, dtype=np.float64))


def _polygon(time: Array, values: Array, period: float, phase: float) -> tuple[float, Array, Array]:
    """What the best polygon leaves (RMS a degree of freedom), and its corners: instants, values."""
    left, corners, first = _solved(time, values, np.array([period]), np.array([phase]))
    knots = time[0] + phase + period * (first[0] + np.arange(len(corners)))
    return float(left[0]), knots, corners


def _lefts(time: Array, values: Array, period: Array, phase: Array) -> Array:
    """What the best polygons of several periods and phases leave, shape (m,)."""
    at_once = max(AT_ONCE // len(time), 1)
    parts = [slice(k, k + at_once) for k in range(0, len(period), at_once)]
    return np.concatenate([_solved(time, values, period[p], phase[p])[0] for p in parts])


def _solved(time: Array, values: Array, period: Array, phase: Array) -> tuple[Array, Array, Array]:
    """What the best polygons leave, shape (m,), all their corners in a row, and each one's first.

    Each is a tridiagonal system; in a row they are one, no two of them coupled.
    """
    place = (time - time[0] - phase[:, None]) / period[:, None]
    whole = np.floor(place)
    share = (place - whole).ravel()
    low = whole.astype(np.intp)
    first = low[:, 0].copy()
    count = low[:, -1] - first + 2
    offset = np.cumsum(count) - count
    at = (low + (offset - first)[:, None]).ravel()
    total = int(count.sum())
    level = values[0]
    y = np.tile(values - level, len(period))
    rest = 1.0 - share
    diagonal = np.bincount(at, rest**2, total) + np.bincount(at + 1, share**2, total)
    beside = np.bincount(at, rest * share, total)
    right = np.bincount(at, rest * y, total) + np.bincount(at + 1, share * y, total)
    # A corner that no sample is near (a gap, an end) is not known.
    band = np.stack([np.concatenate(([0.0], beside[:-1])), diagonal + 1e-9])
    corners = linalg.solveh_banded(band, right, overwrite_ab=True, overwrite_b=True)
    gap = (y - rest * corners[at] - share * corners[at + 1]).reshape(place.shape)
    free = len(time) - np.add.reduceat((diagonal > 1e-6).astype(np.intp), offset)
    corners = np.where(diagonal > 1e-3, corners + level, np.nan)
    left: Array = np.sqrt(np.sum(gap**2, axis=1) / np.maximum(free, 1))
    return left, corners, first


def _sharpened(time: Array, values: Array, period: float, phase: float) -> tuple[float, float]:
    """Period and phase that fit best near those given, to a fraction of the stretch."""
    length = float(time[-1] - time[0])
    reach_period, reach_phase = 0.12 * period**2 / length, 0.06 * period
    best = (np.inf, period, phase)
    steps = np.linspace(-1.0, 1.0, 5)
    first = np.inf
    for k in range(9):
        periods = np.repeat(best[1] + reach_period * steps, len(steps))
        phases = np.tile(best[2] + reach_phase * steps, len(steps))
        left = _lefts(time, values, periods, phases)
        least = int(np.argmin(left))
        if left[least] < best[0]:
            best = (float(left[least]), float(periods[least]), float(phases[least]))
        if k == 0:
            first = best[0]
        # What a true polygon leaves falls with every halving, in proportion.
        if k == IN_VAIN and best[0] > 0.5 * first:
            break
        reach_period *= 0.5
        reach_phase *= 0.5
    return best[1], best[2]
