"""Fit of polygonal lines with corners evenly spaced in time, by period and phase.

The samples are linear in the values at the corners, which follow by linear least squares. Only the
period and the phase are searched.
"""

from __future__ import annotations

import numpy as np
from scipy import linalg

from jbf.arrays import Array

USUAL_HALVINGS, MOST_HALVINGS = 9, 14
"""Number of halvings of the search range: default, and largest.

The search continues beyond the usual number as long as the residual decreases.
"""
MAX_IDLE_HALVINGS = 4
"""Number of halvings after which a search without improvement ends."""
BATCH_SAMPLES = 2**13
"""Total number of samples of the polygons in one linear system."""


def polygon(time: Array, values: Array, period: float, phase: float) -> tuple[float, Array, Array]:
    """Fit a polygonal line of given period and phase; return its residual and its corners.

    Returns
    -------
    residual : float
    knots : ndarray
        Instants of the corners, s.
    corners : ndarray
        Values at the corners; nan if undetermined.
    """
    residual, corners, first = _solved(time, values, np.array([period]), np.array([phase]))
    knots = time[0] + phase + period * (first[0] + np.arange(len(corners)))
    return float(residual[0]), knots, corners


def polygon_rms(time: Array, values: Array, period: Array, phase: Array) -> Array:
    """RMS residuals of the best polygons for several periods and phases, shape (m,)."""
    at_once = max(BATCH_SAMPLES // len(time), 1)
    parts = [slice(k, k + at_once) for k in range(0, len(period), at_once)]
    return np.concatenate([_solved(time, values, period[p], phase[p])[0] for p in parts])


def _solved(time: Array, values: Array, period: Array, phase: Array) -> tuple[Array, Array, Array]:
    """Fit polygonal lines for several periods and phases at once.

    Each fit is a tridiagonal system; all fits are solved together as one block-diagonal system.

    Returns
    -------
    residual : ndarray
        RMS residual of each polygon, shape (m,).
    corners : ndarray
        Values at the corners of all polygons, concatenated.
    first : ndarray
        Number of the first corner of each polygon, shape (m,).
    """
    place = (time - time[0] - phase[:, None]) / period[:, None]
    segment = np.floor(place)
    share = (place - segment).ravel()
    low = segment.astype(np.intp)
    first = low[:, 0].copy()
    count = low[:, -1] - first + 2
    offset = np.cumsum(count) - count
    at = (low + (offset - first)[:, None]).ravel()
    total = int(count.sum())
    level = values[0]
    y = np.tile(values - level, len(period))
    rest = 1.0 - share
    diagonal = np.bincount(at, rest**2, total) + np.bincount(at + 1, share**2, total)
    off_diagonal = np.bincount(at, rest * share, total)
    right = np.bincount(at, rest * y, total) + np.bincount(at + 1, share * y, total)
    # A corner without nearby samples (a gap, an end) is undetermined.
    band = np.stack([np.concatenate(([0.0], off_diagonal[:-1])), diagonal + 1e-9])
    corners = linalg.solveh_banded(band, right, overwrite_ab=True, overwrite_b=True)
    gap = (y - rest * corners[at] - share * corners[at + 1]).reshape(place.shape)
    free = len(time) - np.add.reduceat((diagonal > 1e-6).astype(np.intp), offset)
    corners = np.where(diagonal > 1e-3, corners + level, np.nan)
    residual: Array = np.sqrt(np.sum(gap**2, axis=1) / np.maximum(free, 1))
    return residual, corners, first


def refined(
    time: Array, values: Array, period: float, phase: float, *, near: bool = False
) -> tuple[float, float]:
    """Refine period and phase near the given ones, to a fraction of the initial range.

    Parameters
    ----------
    near
        True if the given values are known to be nearly right. Then the early abort is disabled and
        more halvings are allowed.
    """
    length = float(time[-1] - time[0])
    reach_period, reach_phase = 0.12 * period**2 / length, 0.06 * period
    best = (np.inf, period, phase)
    steps = np.linspace(-1.0, 1.0, 5)
    first = np.inf
    for k in range(MOST_HALVINGS if near else USUAL_HALVINGS):
        before = best[0]
        periods = np.repeat(best[1] + reach_period * steps, len(steps))
        phases = np.tile(best[2] + reach_phase * steps, len(steps))
        residual = polygon_rms(time, values, periods, phases)
        smallest = int(np.argmin(residual))
        if residual[smallest] < best[0]:
            best = (
                float(residual[smallest]),
                float(periods[smallest]),
                float(phases[smallest]),
            )
        if k == 0:
            first = best[0]
        # For a true polygon, the residual is proportional to the step size of the search.
        if k == MAX_IDLE_HALVINGS and best[0] > 0.5 * first and not near:
            break
        if k >= USUAL_HALVINGS and best[0] > 0.9 * before:
            break
        reach_period *= 0.5
        reach_phase *= 0.5
    return best[1], best[2]
