"""Steady friction of a model at constant speeds, and its approximation by few points."""

from __future__ import annotations

from collections.abc import Collection, Iterable

import numpy as np

from jbf.arrays import Array
from jbf.export.reference import Reference, part
from jbf.records.checks import POINT, POINT_S
from jbf.records.run import Run

SPEEDS = 40
"""Number of logarithmic and of linear speeds at which the steady friction is computed."""
SLOWEST_QUANTILE = 0.001
"""Quantile of the absolute speeds of the runs at which a curve begins."""
FLOOR = 0.05
"""Weight of a speed that the runs do not contain, relative to the mean weight."""


def speeds_of(reference: Reference) -> Array:
    """Speeds between the slowest and the fastest of the runs, ascending, all above zero."""
    speeds = np.abs(reference.pooled(reference.velocity))
    top = float(np.max(speeds))
    low = max(float(np.quantile(speeds, SLOWEST_QUANTILE)), 1e-4 * top)
    if low >= top:
        low = 0.5 * top
    grid = np.concatenate([np.geomspace(low, top, SPEEDS), np.linspace(low, top, SPEEDS)])
    grid[[SPEEDS - 1, -1]] = top
    return np.unique(grid)


def weights_of(reference: Reference, speeds: Array, direction: int) -> Array:
    """Share of the samples next to each speed in one direction, with a floor; sum 1."""
    velocity = direction * reference.pooled(reference.velocity)
    velocity = velocity[velocity > 0.0]
    borders = 0.5 * (speeds[1:] + speeds[:-1])
    counts = np.bincount(np.searchsorted(borders, velocity), minlength=len(speeds)).astype(float)
    weights = counts + FLOOR * max(float(np.mean(counts)), 1.0)
    return weights / float(np.sum(weights))


def steady_friction(
    reference: Reference, speeds: Array, direction: int, omitted: Collection[str]
) -> Array:
    """Friction of a model at constant speeds, at the median load and temperature of the runs.

    Parameters
    ----------
    reference
        The model and its runs.
    speeds
        Absolute speeds, shape (n,).
    direction
        Sign of the motion, 1 or -1.
    omitted
        Effects that the model is evaluated without.

    Returns
    -------
    ndarray
        Signed friction, shape (n,).
    """
    model = part(reference.machine, set(reference.machine.effects) - set(omitted))
    settled = np.concatenate([[speeds[0]], speeds])
    run = _steady_run(reference, direction * settled)
    return model.predict(run)[1:]


def _steady_run(reference: Reference, velocity: Array) -> Run:
    """Run whose samples are steady states."""
    points = np.arange(len(velocity), dtype=float)
    return Run.from_arrays(
        POINT_S * points,
        velocity,
        load_n=_median([run.load_n for run in reference.runs], len(velocity)),
        temperature_c=_median([run.temperature_c for run in reference.runs], len(velocity)),
        extra={POINT: points},
    )


def _median(columns: Iterable[Array | None], count: int) -> Array | None:
    """Median of a column over all runs, repeated; None if a run lacks the column."""
    known = []
    for column in columns:
        if column is None:
            return None
        known.append(column)
    return np.full(count, float(np.median(np.concatenate(known))))


def best_points(x: Array, y: Array, weights: Array, count: int) -> tuple[Array, Array]:
    """Approximate a curve by a polygon with the least weighted squared error.

    The abscissae are selected among those of the curve by dynamic programming, for a polygon whose
    corners are on the curve; the ordinates then follow from linear least squares.

    Parameters
    ----------
    x, y, weights
        Curve and weights, shape (n,); `x` is ascending.
    count
        Largest number of corners, at least 2.

    Returns
    -------
    x, y : ndarray
        Corners, shape (k,), k at most `count`. The first and the last abscissa are those of the
        curve.
    """
    n = len(x)
    if n <= count:
        return x, y
    cost = np.full((n, n), np.inf)
    for i in range(n - 1):
        for j in range(i + 1, n):
            inner = slice(i, j)
            chord = y[i] + (y[j] - y[i]) * (x[inner] - x[i]) / (x[j] - x[i])
            cost[i, j] = float(np.sum(weights[inner] * (y[inner] - chord) ** 2))
    # Least cost of a polygon from the first point to point j, with one more segment in each pass.
    least, previous = cost[0], []
    for _ in range(count - 2):
        through = least[:, None] + cost
        previous.append(np.argmin(through, axis=0))
        least = np.min(through, axis=0)
    chosen = [n - 1]
    for before in reversed(previous):
        chosen.append(int(before[chosen[-1]]))
    knots = x[[0, *reversed(chosen)]]
    hats = np.stack([np.interp(x, knots, unit) for unit in np.eye(len(knots))], axis=1)
    root = np.sqrt(weights)
    ordinates, *_ = np.linalg.lstsq(hats * root[:, None], y * root, rcond=None)
    return knots, np.asarray(ordinates, dtype=np.float64)
