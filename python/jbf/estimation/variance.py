"""Variance of statistics of residuals that are not independent Gaussian noise.

If the noise model is correct, innovations are white, and the variance of a score is its squared
length. This fails for noise with a longer correlation time, heavy-tailed noise, or heteroscedastic
noise related to the score.

Notes
-----
The long-run (HAC) variance is estimated from the score of the record, summed over windows longer
than the correlation time (Bartlett kernel; Newey & West 1987). Robust sizes bound the influence of
outliers (Hampel 1974). Blocks longer than the correlation time change sign together in a sign
randomisation.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
from scipy import special

from jbf.estimation.samples import Samples
from jbf.estimation.settings import DEFAULT, VarianceSettings

Array = npt.NDArray[np.float64]
Places = npt.NDArray[np.intp]


def robust_size(values: Array) -> float:
    """Standard deviation estimated from the median; zero without values, as for an excluded run."""
    if not len(values):
        return 0.0
    return float(np.median(np.abs(values))) / 0.6745


def clipped_square(errors: Array, size: float, clip_sigma: float) -> float:
    """Sum of squares with errors clipped at `clip_sigma` standard deviations of `size`."""
    return float(np.sum(np.minimum(errors**2, (clip_sigma * size) ** 2)))


def score_square(
    directions: Array,
    innovations: Array,
    step_s: float,
    settings: VarianceSettings = DEFAULT.variance,
) -> float:
    """Square of a score over its long-run variance: chi-square, one degree of freedom a direction.

    The variance of each direction is at least that of white noise.

    Parameters
    ----------
    directions
        Orthonormal columns, shape (n, q).
    innovations
        Innovations of unit variance, shape (n,).
    step_s
        Usual sampling interval, s.
    """
    score = directions.T @ innovations
    # The part explained by the score itself is signal, not noise.
    rest = directions * (innovations - directions @ score)[:, None]
    size, axes = np.linalg.eigh(long_run_variance(rest, step_s, settings))
    return float(np.sum((axes.T @ score) ** 2 / np.maximum(size, 1.0)))


def score_inflation(
    directions: Sequence[Array],
    innovations: Sequence[Array],
    steps_s: Sequence[float],
    settings: VarianceSettings = DEFAULT.variance,
) -> float:
    """Ratio of the variance of a score to that in white noise, at least one.

    Parameters
    ----------
    directions, innovations
        One array a run, shape (n,); of any scale.
    """
    # The squares of a direction far above the noise would overflow.
    largest = max((float(np.max(np.abs(d), initial=0.0)) for d in directions), default=0.0)
    if not 0.0 < largest < np.inf:
        return 1.0
    directions = [d / largest for d in directions]
    square = sum(float(np.sum(d**2)) for d in directions)
    white = _white(innovations)
    if white <= 0.0:
        return 1.0
    # The part explained by the score itself is not noise.
    along = sum(float(d @ e) for d, e in zip(directions, innovations, strict=True)) / square
    found = sum(
        float(long_run_variance((d * (e - along * d))[:, None], step, settings)[0, 0])
        for d, e, step in zip(directions, innovations, steps_s, strict=True)
    )
    return max(found / (square * white), 1.0)


def sure_inflation(
    directions: Sequence[Array],
    innovations: Sequence[Array],
    steps_s: Sequence[float],
    settings: VarianceSettings = DEFAULT.variance,
) -> float:
    """Ratio of the variance of a score to that in white noise, or one if it is not significant.

    A direction of a few breakaways has few windows, and the mean square of a few numbers is not a
    reliable variance.
    """
    ratio = score_inflation(directions, innovations, steps_s, settings)
    if ratio <= 1.0:
        return 1.0
    largest = max(float(np.max(np.abs(d), initial=0.0)) for d in directions)
    directions = [d / largest for d in directions]
    square = sum(float(np.sum(d**2)) for d in directions)
    # Effective number of equal terms in a sum of squares with unequal weights (Satterthwaite 1946).
    spread = sum(
        float(long_run_variance(d[:, None] ** 2, step, settings)[0, 0])
        for d, step in zip(directions, steps_s, strict=True)
    )
    windows = square**2 / spread
    return ratio if special.chdtrc(windows, windows * ratio) <= settings.chance else 1.0


def between_runs(
    directions: Sequence[Array],
    innovations: Sequence[Array],
    inflation: float,
    settings: VarianceSettings = DEFAULT.variance,
) -> float:
    """Ratio of the variance of a score to that in white noise, from the scatter of whole runs.

    It is zero if the scatter is not significant. A level that each run has of its own lasts longer
    than any window (clusters: Liang & Zeger 1986).

    Parameters
    ----------
    inflation
        Ratio from the windows within the runs.
    """
    pulls = np.array([float(d @ e) for d, e in zip(directions, innovations, strict=True)])
    sizes = np.array([float(d @ d) for d in directions])
    white = _white(innovations)
    own = sizes > 0.0
    runs = int(np.count_nonzero(own))
    if runs < settings.min_runs or white <= 0.0:
        return 0.0
    square = float(np.sum(pulls[own] ** 2 / sizes[own])) / (white * inflation)
    if special.chdtrc(runs - 1, square) > settings.chance:
        return 0.0
    return float(np.sum(pulls**2)) / (white * float(np.sum(sizes))) * runs / (runs - 1)


def _white(innovations: Sequence[Array]) -> float:
    """Mean square of the innovations that count; the others are zero."""
    counted = sum(int(np.count_nonzero(e)) for e in innovations)
    return sum(float(np.sum(e**2)) for e in innovations) / max(counted, 1)


def long_run_variance(
    scores: Array, step_s: float, settings: VarianceSettings = DEFAULT.variance
) -> Array:
    """Long-run variance, shape (q, q), of the sum of scores, shape (n, q)."""
    n = len(scores)
    if n == 0:
        return np.zeros((scores.shape[1], scores.shape[1]))
    length = int(np.clip(settings.window_s / step_s, 1, max(n // settings.min_windows, 1)))
    sums = np.cumsum(np.vstack([np.zeros((1, scores.shape[1])), scores]), axis=0)
    windows = sums[length:] - sums[:-length]
    variance: Array = windows.T @ windows * (n / (len(windows) * length))
    return variance


def blocks_of(samples: Samples, share: float) -> Places:
    """Start indices of blocks among the samples with weight, with all runs concatenated.

    No block spans two runs.

    Parameters
    ----------
    share
        Number of independent samples per sample; smaller for a longer correlation time.
    """
    settings, found, before = samples.settings.blocks, [], 0
    for weight, step in zip(samples.weight, samples.steps_s, strict=True):
        count = int(np.count_nonzero(weight > 0.0))
        shortest = round(settings.min_length_s / step)
        length = max(shortest, round(0.5 * settings.min_memories / share), 1)
        found.append(before + np.arange(0, count, length))
        before += count
    return np.concatenate(found).astype(np.intp)
