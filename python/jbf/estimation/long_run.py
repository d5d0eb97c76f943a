"""The long-run variance of scores: how far a sum over residuals that remember strays by chance.

Innovations of a noise that is described well are white, and a score's variance is its length. Those
of a noise with a longer memory, with heavier tails, or larger where the score is, are not. The
variance is then estimated from the record's own score, summed over windows longer than the memory
(Bartlett's kernel; Newey & West 1987).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
from scipy import special

Array = npt.NDArray[np.float64]

WINDOW_S = 3.0
"""Length of the windows, s: five times the longest memory that a noise may be described by,"""
LEAST_WINDOWS = 8
"""but so many fit into a record."""
LEAST_RUNS = 3
"""Fewer runs have no scatter."""
BY_CHANCE = 0.01
"""Probability of a scatter of runs or of windows that is taken for chance."""


def score_square(directions: Array, innovations: Array, step_s: float) -> float:
    """The square of a score over its long-run variance: chi-square, one degree a direction.

    No direction's variance is taken for less than that of white noise.

    Parameters
    ----------
    directions
        Orthonormal columns, shape (n, q).
    innovations
        Of unit variance, shape (n,).
    step_s
        The usual step, s.
    """
    score = directions.T @ innovations
    # What the score itself explains is the signal, and no noise.
    rest = directions * (innovations - directions @ score)[:, None]
    size, axes = np.linalg.eigh(long_run_variance(rest, step_s))
    return float(np.sum((axes.T @ score) ** 2 / np.maximum(size, 1.0)))


def score_inflation(
    directions: Sequence[Array], innovations: Sequence[Array], steps_s: Sequence[float]
) -> float:
    """How many times as large as in white noise the variance of a score is, at least one.

    Parameters
    ----------
    directions, innovations
        One array a run, shape (n,); of any length.
    """
    # Of a direction far above no noise at all the squares would overflow.
    largest = max((float(np.max(np.abs(d), initial=0.0)) for d in directions), default=0.0)
    if not 0.0 < largest < np.inf:
        return 1.0
    directions = [d / largest for d in directions]
    square = sum(float(np.sum(d**2)) for d in directions)
    white = _white(innovations)
    if white <= 0.0:
        return 1.0
    # What the score itself explains is no noise here either.
    along = sum(float(d @ e) for d, e in zip(directions, innovations, strict=True)) / square
    found = sum(
        float(long_run_variance((d * (e - along * d))[:, None], step)[0, 0])
        for d, e, step in zip(directions, innovations, steps_s, strict=True)
    )
    return max(found / (square * white), 1.0)


def sure_inflation(
    directions: Sequence[Array], innovations: Sequence[Array], steps_s: Sequence[float]
) -> float:
    """The same where it is more than chance: a direction of a few breakaways has few windows, and
    the mean square of a few numbers is no variance."""
    ratio = score_inflation(directions, innovations, steps_s)
    if ratio <= 1.0:
        return 1.0
    largest = max(float(np.max(np.abs(d), initial=0.0)) for d in directions)
    directions = [d / largest for d in directions]
    square = sum(float(np.sum(d**2)) for d in directions)
    # A sum of squares with unequal weights is worth so many equal ones (Satterthwaite 1946).
    spread = sum(
        float(long_run_variance(d[:, None] ** 2, step)[0, 0])
        for d, step in zip(directions, steps_s, strict=True)
    )
    windows = square**2 / spread
    return ratio if special.chdtrc(windows, windows * ratio) <= BY_CHANCE else 1.0


def between_runs(
    directions: Sequence[Array], innovations: Sequence[Array], inflation: float
) -> float:
    """The same by what whole runs pull, where they scatter more than chance; else zero.

    A level that each run has of its own outlasts any window (clusters: Liang & Zeger 1986).

    Parameters
    ----------
    inflation
        By the windows within the runs.
    """
    pulls = np.array([float(d @ e) for d, e in zip(directions, innovations, strict=True)])
    sizes = np.array([float(d @ d) for d in directions])
    white = _white(innovations)
    own = sizes > 0.0
    runs = int(np.count_nonzero(own))
    if runs < LEAST_RUNS or white <= 0.0:
        return 0.0
    square = float(np.sum(pulls[own] ** 2 / sizes[own])) / (white * inflation)
    if special.chdtrc(runs - 1, square) > BY_CHANCE:
        return 0.0
    return float(np.sum(pulls**2)) / (white * float(np.sum(sizes))) * runs / (runs - 1)


def _white(innovations: Sequence[Array]) -> float:
    """The mean square of those that count: the others are zero."""
    counted = sum(int(np.count_nonzero(e)) for e in innovations)
    return sum(float(np.sum(e**2)) for e in innovations) / max(counted, 1)


def long_run_variance(scores: Array, step_s: float) -> Array:
    """Long-run variance, shape (q, q), of the sum of scores, shape (n, q)."""
    n = len(scores)
    if n == 0:
        return np.zeros((scores.shape[1], scores.shape[1]))
    length = int(np.clip(WINDOW_S / step_s, 1, max(n // LEAST_WINDOWS, 1)))
    sums = np.cumsum(np.vstack([np.zeros((1, scores.shape[1])), scores]), axis=0)
    windows = sums[length:] - sums[:-length]
    variance: Array = windows.T @ windows * (n / (len(windows) * length))
    return variance
