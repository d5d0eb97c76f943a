"""From a recorded motion to the motion that was imposed.

A recorded speed carries noise and a recorded angle carries the encoder's steps; the
friction law needs the speed, its sign and its slope. Both records see the same motion, so a
short polynomial is fitted to both at once round each sample, over the longest window that
the data allow: windows grow while the speeds they give agree within their errors (the
intersection of confidence intervals, Goldenshluger & Nemirovski 1997). So a sine is smoothed
over many samples and the corner of a trapezoid over few.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from jbf.record import Run

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

HALF_WIDTHS = (1, 2, 4, 8, 16)
"""Half widths of the windows tried, in samples."""
AGREEMENT = 2.0
"""How many standard errors the intervals of two windows may span and still agree."""
REST_SAMPLES = 3
"""So many zero speeds in a row are a rest, not a crossing."""
SIGN_SIGMA = 4.0
"""A speed closer to zero than this many standard errors has no sign to rely on."""


@dataclass(frozen=True)
class ImposedMotion:
    """The motion that a model is driven with; all arrays of shape (n,).

    Attributes
    ----------
    velocity_m_s, acceleration_m_s2, angle_rad
        Estimates at the samples.
    velocity_error_m_s
        Standard error of the speed.
    resting
        True where the shaft was at rest.
    trusted
        False where the sign of the motion, and so of the friction, cannot be known.
    """

    velocity_m_s: Array
    acceleration_m_s2: Array
    angle_rad: Array
    velocity_error_m_s: Array
    resting: Mask
    trusted: Mask


def noise_of(signal: Array) -> float:
    """Standard deviation of white noise on a smooth signal, from its third differences.

    Robust: half of the samples may do anything.
    """
    if len(signal) < 8:
        return 0.0
    third = np.diff(signal, 3)
    return float(np.median(np.abs(third)) / 0.6745 / np.sqrt(20.0))


def resting_samples(velocity_m_s: Array) -> Mask:
    """True in stretches of at least `REST_SAMPLES` speeds that are exactly zero."""
    zero = velocity_m_s == 0.0
    edges = np.diff(np.concatenate(([0], zero.astype(np.int8), [0])))
    rest = np.zeros(len(zero), dtype=bool)
    for first, end in zip(np.flatnonzero(edges == 1), np.flatnonzero(edges == -1), strict=True):
        if end - first >= REST_SAMPLES:
            rest[first:end] = True
    return rest


def _step_of(angle: Array) -> float:
    """The encoder's step: the smallest change of angle on record."""
    steps = np.abs(np.diff(angle))
    steps = steps[steps > 1e-12]
    return float(np.min(steps)) if len(steps) else 0.0


def _local_fit(
    time: Array, path: Array, speed: Array, sd_path: float, sd_speed: float, half: int
) -> tuple[Array, Array, Array, Array]:
    """Fit a cubic path to path and speed in windows of `2 half + 1` samples.

    Returns path, speed, acceleration and the standard error of the speed at each sample.
    """
    n = len(time)
    width = min(2 * half + 1, n)
    first = np.clip(np.arange(n) - half, 0, n - width)
    index = first[:, None] + np.arange(width)[None, :]
    t = time[index] - time[:, None]
    scale = max(float(np.max(np.abs(t))), 1e-30)
    u = t / scale
    # A long window sees more of a bend: give it more terms than a short one can carry.
    order = 3 if half < 4 else 5
    powers = np.stack([u**k for k in range(order + 1)], axis=-1)
    slopes = np.stack([k * u ** max(k - 1, 0) for k in range(order + 1)], axis=-1) / scale
    origin = path[:, None]
    design = np.concatenate([powers / sd_path, slopes / sd_speed], axis=1)
    target = np.concatenate([(path[index] - origin) / sd_path, speed[index] / sd_speed], axis=1)
    normal = np.einsum("nij,nik->njk", design, design)
    right = np.einsum("nij,ni->nj", design, target)
    inverse = np.linalg.pinv(normal, hermitian=True)
    coefficients = np.einsum("njk,nk->nj", inverse, right)
    return (
        coefficients[:, 0] + path,
        coefficients[:, 1] / scale,
        2.0 * coefficients[:, 2] / scale**2,
        np.sqrt(np.maximum(inverse[:, 1, 1], 0.0)) / scale,
    )


def _smooth(
    time: Array, path: Array, speed: Array, sd_path: float, sd_speed: float
) -> tuple[Array, Array, Array, Array]:
    """Path, speed, acceleration and standard error of the speed in one stretch of motion."""
    best: tuple[Array, Array, Array, Array] | None = None
    low = np.full(len(time), -np.inf)
    high = np.full(len(time), np.inf)
    growing = np.ones(len(time), dtype=bool)
    for half in HALF_WIDTHS:
        if best is not None and 2 * half + 1 > len(time):
            break
        fit = _local_fit(time, path, speed, sd_path, sd_speed, half)
        low = np.maximum(low, fit[1] - AGREEMENT * fit[3])
        high = np.minimum(high, fit[1] + AGREEMENT * fit[3])
        growing &= low <= high
        best = (
            fit
            if best is None
            else tuple(np.where(growing, new, old) for new, old in zip(fit, best, strict=True))  # type: ignore[assignment]
        )
        if not growing.any():
            break
    assert best is not None
    return best


def _place_rests(
    rest: Mask, path: Array, velocity: Array, acceleration: Array, half_step: float
) -> None:
    """Place each rest where the motions on either side end and begin, in `path`.

    An encoder shows a rest to the nearest step; a stiff drive makes a force of the remainder.
    The motion before says where it came to a stop, the one after where it started from.
    """
    edges = np.diff(np.concatenate(([0], rest.astype(np.int8), [0])))
    for first, end in zip(np.flatnonzero(edges == 1), np.flatnonzero(edges == -1), strict=True):
        guesses = []
        for neighbour, way in ((first - 1, 1.0), (end, -1.0)):
            if 0 <= neighbour < len(path) and acceleration[neighbour] != 0.0:
                v, a = velocity[neighbour], acceleration[neighbour]
                guesses.append(path[neighbour] + way * 0.5 * v * abs(v) / abs(a))
        if guesses:
            recorded = path[first]
            placed = np.clip(np.mean(guesses), recorded - half_step, recorded + half_step)
            path[first:end] = placed


def impose(run: Run, radius_m: float) -> ImposedMotion:
    """Estimate the imposed motion of a run.

    Parameters
    ----------
    run
        The record; `angle_rad` is used where it is there, else the speed alone.
    radius_m
        Journal radius, m: turns the angle into a path.
    """
    time, speed = run.time_s, run.velocity_m_s
    n = len(time)
    rest = resting_samples(speed)
    moving = ~rest
    if run.angle_rad is not None:
        path = np.unwrap(run.angle_rad) * radius_m
        sd_path = _step_of(path) / np.sqrt(12.0)
    elif run.position_m is not None:
        path = run.position_m
        sd_path = _step_of(path) / np.sqrt(12.0)
    else:
        steps = 0.5 * (speed[1:] + speed[:-1]) * np.diff(time)
        path, sd_path = np.concatenate(([0.0], np.cumsum(steps))), np.inf
    sd_speed = noise_of(speed[moving]) if moving.any() else 0.0
    top = float(np.max(np.abs(speed))) if n else 0.0
    sd_speed = max(sd_speed, 1e-7 * top, 1e-15)
    sd_path = max(sd_path, 1e-9 * float(np.ptp(path)), 1e-15) if np.isfinite(sd_path) else 1e3

    velocity, acceleration = speed.copy(), np.zeros(n)
    smooth_path, error = path.copy(), np.zeros(n)
    edges = np.diff(np.concatenate(([0], moving.astype(np.int8), [0])))
    for first, end in zip(np.flatnonzero(edges == 1), np.flatnonzero(edges == -1), strict=True):
        part = slice(first, end)
        if end - first < 3:
            error[part] = sd_speed
            continue
        smooth_path[part], velocity[part], acceleration[part], error[part] = _smooth(
            time[part], path[part], speed[part], sd_path, sd_speed
        )
    _place_rests(rest, smooth_path, velocity, acceleration, 0.5 * sd_path * np.sqrt(12.0))
    trusted = rest | (np.abs(velocity) > SIGN_SIGMA * error)
    return ImposedMotion(velocity, acceleration, smooth_path / radius_m, error, rest, trusted)
