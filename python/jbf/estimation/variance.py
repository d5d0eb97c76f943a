"""Variance of statistics of residuals that are not independent Gaussian noise.

If the noise model is correct, the innovations are white, and the variance of a score is the sum of
squares of its direction. This is not valid for noise with a longer correlation time, heavy-tailed
noise, or heteroscedastic noise correlated with the score.

Notes
-----
The long-run (HAC) variance is estimated from the score of the record, summed over windows longer
than the correlation time (Bartlett kernel; Newey & West 1987). Robust standard deviations bound the
influence of outliers (Hampel 1974). In a sign randomisation, all samples of a block change sign
together; the blocks are longer than the correlation time.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
from scipy import special

from jbf.arrays import Array
from jbf.estimation.samples import Samples
from jbf.estimation.settings import DEFAULT, VarianceSettings

Places = npt.NDArray[np.intp]


def robust_size(values: Array) -> float:
    """Robust standard deviation of values, from their median magnitude; zero without values."""
    if not len(values):
        return 0.0
    return float(np.median(np.abs(values))) / 0.6745


def clipped_square(errors: Array, size: float, clip_sigma: float) -> float:
    """Sum of squares of errors clipped at `clip_sigma` times the standard deviation `size`."""
    return float(np.sum(np.minimum(errors**2, (clip_sigma * size) ** 2)))


def score_square(
    directions: Array,
    innovations: Array,
    step_s: float,
    settings: VarianceSettings = DEFAULT.variance,
) -> float:
    """Squared score divided by its long-run variance; chi-square, one degree per direction.

    The directions are orthonormal columns, shape (n, q), and the innovations, shape (n,), have unit
    variance. The variance of each direction is at least that of white noise.
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
    """Ratio, at least one, of the variance of a score to its variance in white noise.

    The directions are derivatives of the prediction. They and the innovations have one array per
    run, shape (n,), and any scale.
    """
    directions, square = _scaled(directions)
    white = _mean_square(innovations)
    if square <= 0.0 or white <= 0.0:
        return 1.0
    # The part explained by the score itself is not noise.
    along = sum(float(d @ e) for d, e in zip(directions, innovations, strict=True)) / square
    variance = sum(
        float(long_run_variance((d * (e - along * d))[:, None], step, settings)[0, 0])
        for d, e, step in zip(directions, innovations, steps_s, strict=True)
    )
    return max(variance / (square * white), 1.0)


def significant_inflation(
    directions: Sequence[Array],
    innovations: Sequence[Array],
    steps_s: Sequence[float],
    settings: VarianceSettings = DEFAULT.variance,
) -> float:
    """Variance of a score relative to white noise; one if the ratio is not significant.

    A direction that is nonzero in few windows only does not give a reliable variance. Parameters as
    for :func:`score_inflation`.
    """
    ratio = score_inflation(directions, innovations, steps_s, settings)
    if ratio <= 1.0:
        return 1.0
    directions, square = _scaled(directions)
    # Effective number of equal terms in a sum of squares with unequal weights (Satterthwaite 1946).
    fourth_moments = sum(
        float(long_run_variance(d[:, None] ** 2, step, settings)[0, 0])
        for d, step in zip(directions, steps_s, strict=True)
    )
    windows = square**2 / fourth_moments
    return ratio if special.chdtrc(windows, windows * ratio) <= settings.chance else 1.0


def _scaled(directions: Sequence[Array]) -> tuple[Sequence[Array], float]:
    """Directions divided by their largest element, and the sum of squares of the result.

    The scaling avoids an overflow of the squares. The sum is zero if all elements are zero or one
    of them is infinite.
    """
    largest = max((float(np.max(np.abs(d), initial=0.0)) for d in directions), default=0.0)
    if not 0.0 < largest < np.inf:
        return directions, 0.0
    directions = [d / largest for d in directions]
    return directions, sum(float(np.sum(d**2)) for d in directions)


def cluster_inflation(
    directions: Sequence[Array],
    innovations: Sequence[Array],
    inflation: float,
    settings: VarianceSettings = DEFAULT.variance,
) -> float:
    """Variance of a score relative to white noise, from the scatter between runs as clusters.

    The ratio is zero if the scatter is not significant. An offset that differs between runs lasts
    longer than any window, so that the runs are used as clusters (Liang & Zeger 1986). `inflation`
    is the ratio from windows within the runs (`score_inflation`).
    """
    scores = np.array([float(d @ e) for d, e in zip(directions, innovations, strict=True)])
    sizes = np.array([float(d @ d) for d in directions])
    white = _mean_square(innovations)
    informative = sizes > 0.0
    runs = int(np.count_nonzero(informative))
    if runs < settings.min_runs or white <= 0.0:
        return 0.0
    square = float(np.sum(scores[informative] ** 2 / sizes[informative])) / (white * inflation)
    if special.chdtrc(runs - 1, square) > settings.chance:
        return 0.0
    return float(np.sum(scores**2)) / (white * float(np.sum(sizes))) * runs / (runs - 1)


def _mean_square(innovations: Sequence[Array]) -> float:
    """Mean square of the innovations of included samples; those of the others are zero."""
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
    return np.asarray(windows.T @ windows * (n / (len(windows) * length)))


def blocks_of(samples: Samples, share: float) -> Places:
    """First index of each block among the weighted samples of all runs, concatenated.

    No block spans two runs. `share` is the number of independent samples per sample; it is smaller
    for a longer correlation time.
    """
    settings, starts, offset = samples.settings.blocks, [], 0
    for weight, step in zip(samples.weight, samples.steps_s, strict=True):
        count = int(np.count_nonzero(weight > 0.0))
        shortest = round(settings.min_length_s / step)
        length = max(shortest, round(0.5 * settings.min_memories / share), 1)
        starts.append(offset + np.arange(0, count, length))
        offset += count
    return np.concatenate(starts).astype(np.intp)
