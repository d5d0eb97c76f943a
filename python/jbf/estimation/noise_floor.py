"""Noise floor of the friction record, estimated from the records only.

The noise follows from third differences, from rests, and from periods that repeat the same motion.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from jbf.arrays import Array
from jbf.estimation.prepared import Prepared
from jbf.estimation.samples import Samples
from jbf.estimation.settings import DEFAULT, NoiseSettings, PeriodSettings
from jbf.records.motion.rests import certain_rests
from jbf.records.motion.roughness import noise_of


def noise_floor(prepared: Sequence[Prepared], samples: Samples) -> float:
    """Standard deviation of the noise on the friction record, N, without use of a model.

    Runs whose force is a command or was filtered do not contain the noise. The result is zero if
    all runs are of this kind: the noise floor is then unknown.

    The white part is estimated from third differences of the record. Its lower limit is the
    quantisation error of a converter (Widrow 1956), because with coarse quantisation most readings
    equal the preceding ones. A coloured part does not contribute to third differences. It is
    estimated from repeated periods of the motion and from rests. The total is used if it clearly
    exceeds the white part. Third differences also contain friction that changes within a few
    samples, such as a fast ripple. Repeated periods do not, and replace the white part if they are
    clearly below it. Rests do not replace it, because the noise may be larger in motion.
    """
    noisy = [i for i, p in enumerate(prepared) if p.has_noise]
    if not noisy:
        return 0.0
    prepared, samples = [prepared[i] for i in noisy], samples.only(noisy)
    settings = samples.settings.noise
    floor, repeats = _white(prepared, samples), _repeat_squares(prepared, samples)
    repeated = _pooled(repeats, settings)
    if repeated is not None and settings.min_floor_ratio * repeated < floor:
        floor = repeated
    total = _pooled([*repeats, *_rest_squares(prepared, settings)], settings)
    if total is None:
        return floor
    low, high = settings.min_floor_ratio * floor, settings.max_floor_ratio * floor
    return total if low < total < high else floor


def noise_upper_bound(prepared: Sequence[Prepared], samples: Samples) -> float | None:
    """Upper limit of the noise including its coloured part, N; None if it cannot be estimated."""
    settings = samples.settings.noise
    squares = [*_repeat_squares(prepared, samples), *_rest_squares(prepared, settings)]
    total = _pooled(squares, settings)
    return None if total is None else max(total, _white(prepared, samples))


def _white(prepared: Sequence[Prepared], samples: Samples) -> float:
    """Standard deviation of the white noise, N, from third differences and quantisation steps."""
    squares = []
    for p, counted in zip(prepared, samples.counted, strict=True):
        values, dither_square = _dithered(p)
        # With coarse quantisation, readings repeat and only the quantisation error is known.
        squares.append(max(noise_of(values[counted]) ** 2 - dither_square, dither_square))
    counts = [int(c.sum()) for c in samples.counted]
    return float(np.sqrt(np.average(squares, weights=counts))) if any(counts) else 0.0


def _dithered(p: Prepared) -> tuple[Array, float]:
    """Readings with uniform dither of one quantisation step, N, and the dither's variance, N^2.

    Medians of quantised values are zero or a step; with dither they are those of the noise
    (Wannamaker et al. 2000). Without quantisation steps no dither is added.
    """
    step = p.converter_step_n
    if step == 0.0:
        return p.friction, 0.0
    dither = np.random.default_rng(0).uniform(-0.5 * step, 0.5 * step, len(p.friction))
    return p.friction + dither, step**2 / 12.0


def _pooled(squares: Sequence[tuple[float, int]], settings: NoiseSettings) -> float | None:
    """Standard deviation pooled over variances with sample counts; None for few samples."""
    weight = sum(count for _, count in squares)
    if weight < settings.min_floor_samples:
        return None
    return float(np.sqrt(sum(square * count for square, count in squares) / weight))


def _rest_squares(prepared: Sequence[Prepared], settings: NoiseSettings) -> list[tuple[float, int]]:
    """Noise variance, N^2, about a straight line in each long rest, and the number of samples.

    The last samples of a rest may belong to a motion that the encoder does not yet show.
    """
    squares = []
    for p in prepared:
        resting = p.motion.resting
        certain = certain_rests(resting)
        edges = np.diff(np.concatenate(([0], resting.astype(np.int8), [0])))
        for first, end in zip(np.flatnonzero(edges == 1), np.flatnonzero(edges == -1), strict=True):
            # The beginning of a rest may still be a transient.
            begin = first + (end - first) // 4
            within = p.friction[begin:end][certain[begin:end]]
            if len(within) >= settings.min_rest_samples:
                part = _detrended(within)
                squares.append((float(part @ part) / (len(part) - 2), len(part)))
    return squares


def _detrended(values: Array) -> Array:
    """Subtract the straight line fitted to a sequence of values."""
    place = np.arange(len(values)) - 0.5 * (len(values) - 1)
    centred = values - np.mean(values)
    return np.asarray(centred - place * float(place @ centred) / float(place @ place))


def _repeat_squares(prepared: Sequence[Prepared], samples: Samples) -> list[tuple[float, int]]:
    """Noise variance, N^2, of each run with a periodic motion, and the number of samples used.

    The variance is that of the differences between readings one period apart.
    """
    squares, settings = [], samples.settings
    for p, counted in zip(prepared, samples.counted, strict=True):
        shift = period_samples(p.motion.velocity, settings.periods)
        if shift is None:
            continue
        # The first period still contains the initial-state transient of the film.
        (values, dither_square), begin = _dithered(p), shift // 2
        gap = (values[begin + shift :] - values[begin:-shift]) / np.sqrt(2.0)
        gap = gap[counted[begin + shift :] & counted[begin:-shift]]
        if len(gap) < settings.noise.min_repeated_samples:
            continue
        # Slow drifts between periods are not noise and are removed. The median tolerates outliers
        # in half of the samples, such as reversals that are not aligned.
        size = max(len(gap) // 12, 25)
        blocks = [gap[i : i + size] for i in range(0, len(gap) - size + 1, size)]
        spread = [np.median(np.abs(b - np.median(b))) / 0.6745 for b in blocks]
        square = max(float(np.median(spread) ** 2) - dither_square, dither_square)
        squares.append((square, len(gap)))
    return squares


def period_samples(velocity: Array, settings: PeriodSettings = DEFAULT.periods) -> int | None:
    """Number of samples in a period of the motion; None if the motion does not repeat."""
    n = len(velocity)
    if n < settings.min_samples or np.ptp(velocity) == 0.0:
        return None
    centred = velocity - velocity.mean()
    power = np.fft.irfft(np.abs(np.fft.rfft(centred, 2 * n)) ** 2)[: n // 2 + n // 4]
    with np.errstate(invalid="ignore", divide="ignore"):
        rho = power / power[0] * n / (n - np.arange(len(power)))
    falls = np.flatnonzero(rho < 0.0)
    if not len(falls):
        return None
    start = int(falls[0])
    inner = rho[start:-1]
    tops = start + np.flatnonzero(
        (inner > rho[start - 1 : -2])
        & (inner >= rho[start + 1 :])
        & (inner > settings.min_correlation)
    )
    if not len(tops):
        return None
    # Select the first of the highest peaks: later ones are at multiples of the period.
    peak = int(tops[np.flatnonzero(rho[tops] > 0.98 * np.max(rho[tops]))[0]])
    # For a record with an incomplete last period, the correlation peaks slightly off the period.
    reach = max(peak // 30, 2)
    gaps = {
        shift: float(np.std(velocity[shift:] - velocity[:-shift]))
        for shift in range(max(peak - reach, 1), min(peak + reach + 1, n - 1))
    }
    best = min(gaps, key=gaps.__getitem__)
    return best if gaps[best] < settings.max_difference * float(np.std(velocity)) else None
