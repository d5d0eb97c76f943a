"""Local polynomials through path and speed at once, over windows as long as the data allow.

Windows grow while the speeds they give agree within their errors (the intersection of confidence
intervals, Goldenshluger & Nemirovski 1997): a sine is smoothed over many samples, the corner of a
trapezoid over few.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

HALF_WIDTHS = (1, 2, 4, 8, 16)
"""Half widths of the windows tried, in samples."""
AGREEMENT = 2.0
"""How many standard errors the intervals of two windows may span and still agree."""


def local_fit(
    time: Array, path: Array, speed: Array, sd_path: float, sd_speed: Array | float, half: int
) -> tuple[Array, Array, Array, Array, Array]:
    """Fit a polynomial path to path and speed in windows of `2 half + 1` samples.

    Returns path, speed, acceleration and the standard errors of the speed and of the acceleration
    at each sample.
    """
    n = len(time)
    width = min(2 * half + 1, n)
    # A long window sees more of a bend: give it more terms than a short one can carry.
    order = 3 if half < 4 else 5
    if isinstance(sd_speed, np.ndarray) or not _even(time):
        return _windows(np.arange(n), time, path, speed, sd_path, sd_speed, width, order)
    # The windows of evenly spaced samples are one, but for those at the ends.
    ends = np.r_[: min(half, n), max(n - half, half) : n]
    found = [np.empty(n) for _ in range(5)]
    for whole, part in zip(
        found,
        _windows(ends, time, path, speed, sd_path, sd_speed, width, order),
        strict=True,
    ):
        whole[ends] = part
    if n > 2 * half:
        inside = slice(half, n - half)
        step_s = float(np.median(np.diff(time)))
        t = np.arange(-half, width - half, dtype=np.float64) * step_s
        scale = float(t[-1])
        sd = np.array([[sd_speed]], dtype=np.float64)
        design = _design(t[None, :] / scale, order, scale, sd_path, sd)[0]
        inverse = np.linalg.pinv(design.T @ design, hermitian=True)
        weights = design @ inverse
        for_path, for_speed = weights[:width] / sd_path, weights[width:] / sd_speed
        level = path - path[n // 2]
        terms = [
            np.correlate(level, for_path[:, k])
            - np.sum(for_path[:, k]) * level[inside]
            + np.correlate(speed, for_speed[:, k])
            for k in range(3)
        ]
        found[0][inside] = terms[0] + path[inside]
        found[1][inside] = terms[1] / scale
        found[2][inside] = 2.0 * terms[2] / scale**2
        found[3][inside] = np.sqrt(max(float(inverse[1, 1]), 0.0)) / scale
        found[4][inside] = 2.0 * np.sqrt(max(float(inverse[2, 2]), 0.0)) / scale**2
    return found[0], found[1], found[2], found[3], found[4]


def _windows(
    which: npt.NDArray[np.intp],
    time: Array,
    path: Array,
    speed: Array,
    sd_path: float,
    sd_speed: Array | float,
    width: int,
    order: int,
) -> tuple[Array, Array, Array, Array, Array]:
    """`_local_fit` at the samples `which`, each in a window of its own."""
    first = np.clip(which - width // 2, 0, len(time) - width)
    index = first[:, None] + np.arange(width)[None, :]
    t = time[index] - time[which, None]
    scale = max(float(np.max(np.abs(t), initial=0.0)), 1e-30)
    sd = sd_speed[index] if isinstance(sd_speed, np.ndarray) else np.full((1, 1), sd_speed)
    design = _design(t / scale, order, scale, sd_path, sd)
    target = np.concatenate([(path[index] - path[which, None]) / sd_path, speed[index] / sd], 1)
    inverse = np.linalg.pinv(np.einsum("nij,nik->njk", design, design), hermitian=True)
    right = np.einsum("nij,ni->nj", design, target)
    coefficients = np.einsum("njk,nk->nj", inverse, right)
    return (
        coefficients[:, 0] + path[which],
        coefficients[:, 1] / scale,
        2.0 * coefficients[:, 2] / scale**2,
        np.sqrt(np.maximum(inverse[:, 1, 1], 0.0)) / scale,
        2.0 * np.sqrt(np.maximum(inverse[:, 2, 2], 0.0)) / scale**2,
    )


def _even(time: Array) -> bool:
    """True where the samples are evenly spaced, but for rounding."""
    steps = np.diff(time)
    return bool(np.ptp(steps) <= 1e-6 * np.median(steps))


def _design(u: Array, order: int, scale: float, sd_path: float, sd: Array) -> Array:
    """Powers of scaled times for path and speed, each over its error, (n, 2 width, order + 1)."""
    powers = np.stack([u**k for k in range(order + 1)], axis=-1)
    slopes = np.stack([k * u ** max(k - 1, 0) for k in range(order + 1)], axis=-1) / scale
    return np.concatenate([powers / sd_path, slopes / sd[..., None]], axis=1)


def smooth(
    time: Array, path: Array, speed: Array, sd_path: float, sd_speed: Array | float
) -> tuple[Array, Array, Array, Array]:
    """Path, speed, acceleration and standard error of the speed in one stretch of motion."""
    best: tuple[Array, ...] | None = None
    # Of speed and of acceleration: where a force sets in, only the latter has a corner.
    low = np.full((2, len(time)), -np.inf)
    high = np.full((2, len(time)), np.inf)
    growing = np.ones(len(time), dtype=bool)
    for half in HALF_WIDTHS:
        if best is not None and 2 * half + 1 > len(time):
            break
        fit = local_fit(time, path, speed, sd_path, sd_speed, half)
        value, error = np.stack(fit[1:3]), AGREEMENT * np.stack(fit[3:5])
        low = np.maximum(low, value - error)
        high = np.minimum(high, value + error)
        growing &= (low <= high).all(axis=0)
        best = (
            fit
            if best is None
            else tuple(np.where(growing, new, old) for new, old in zip(fit, best, strict=True))
        )
        if not growing.any():
            break
    assert best is not None
    return best[0], best[1], best[2], best[3]
