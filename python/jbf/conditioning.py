"""From a recorded motion to the motion that was imposed.

A recorded speed carries noise and a recorded angle carries the encoder's steps; the
friction law needs the speed, its sign and its slope. Both records see the same motion, so a
short polynomial is fitted to both at once round each sample, over the longest window that
the data allow: windows grow while the speeds they give agree within their errors (the
intersection of confidence intervals, Goldenshluger & Nemirovski 1997). So a sine is smoothed
over many samples and the corner of a trapezoid over few.

Records of real machines are less tidy than an encoder and a noise: positions finer than any step,
speeds that a filter made from positions and that disagree with them, noise that comes and goes,
rests in which the speed is a hum instead of zero. Each is looked for in the record itself.
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
STILL_SAMPLES = 20
"""So many samples without a step of the encoder, at speeds of a hum, are a rest, too."""
STILL_SHARE = 5e-3
"""Largest hum of a rest, as a share of the top speed."""
UNEVEN = 3.0
"""Noise so many times its usual size is uneven: locally it counts as it is."""
UNEVEN_SAMPLES = 101
"""Samples over which local noise is taken."""
CONTRADICTION = 10.0
"""Standard errors by which path and speed must differ to contradict one another,"""
CONTRADICTION_REACH = 3
"""and samples to each side whose acceleration that spoils."""
RARE = 0.01
"""Largest share of the samples that may be contradictions."""
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
        False where the sign of the motion, and so of the friction, cannot be known, and where the
        records of path and speed contradict one another.
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


def still_samples(path: Array, velocity_m_s: Array, step: float) -> Mask:
    """True in stretches of at least `STILL_SAMPLES` in which the encoder stays within its step
    and the speed within `STILL_SHARE` of its top: a rest whose recorded speed is not quite zero.

    Parameters
    ----------
    path
        Recorded path, m.
    step
        The encoder's step, m.
    """
    n = len(path)
    slow = np.abs(velocity_m_s) <= STILL_SHARE * np.max(np.abs(velocity_m_s), initial=0.0)
    if n < STILL_SAMPLES or not slow.any():
        return np.zeros(n, dtype=bool)
    windows = np.lib.stride_tricks.sliding_window_view(path, STILL_SAMPLES)
    calm = np.lib.stride_tricks.sliding_window_view(slow, STILL_SAMPLES)
    begins = (np.ptp(windows, axis=1) <= 1.5 * step) & calm.all(axis=1)
    ends = np.concatenate((np.zeros(STILL_SAMPLES), begins.astype(float)))
    covered = np.cumsum(np.concatenate((begins, np.zeros(STILL_SAMPLES)))) - np.cumsum(ends)
    resting: Mask = covered[:n] > 0.5
    return resting


def local_noise(signal: Array) -> Array | float:
    """`noise_of`, sample by sample where the noise is uneven, else one number."""
    usual = noise_of(signal)
    if len(signal) < 4 * UNEVEN_SAMPLES:
        return usual
    from scipy import ndimage  # most of a second to import: not for a prediction of a short run

    third = np.pad(np.abs(np.diff(signal, 3)), (1, 2), mode="reflect")
    local = ndimage.median_filter(third, UNEVEN_SAMPLES, mode="reflect") / 0.6745 / np.sqrt(20.0)
    uneven = local > UNEVEN * usual
    return np.where(uneven, local, usual) if uneven.any() else usual


def _disagreement(time: Array, path: Array, speed: Array, sd_path: float, sd_speed: float) -> float:
    """Error that the speeds must have beyond their noise to disagree so with the path, m/s."""
    dt = np.diff(time)
    gap = np.diff(path) - 0.5 * (speed[1:] + speed[:-1]) * dt
    step = float(np.median(dt))
    seen = float(np.median(np.abs(gap)) / 0.6745)
    expected = np.sqrt(2.0 * sd_path**2 + 0.5 * (sd_speed * step) ** 2)
    if seen <= 1.5 * expected:
        return 0.0
    return float(np.sqrt(seen**2 - 2.0 * sd_path**2) / step)


def _contradiction(
    time: Array, path: Array, speed: Array, sd_path: float, sd_speed: float
) -> Array:
    """How far speed and path contradict one another round each sample, m/s: a filter that settles,
    a glitch. Zero where they agree.

    Zero everywhere, if that is the way of the whole record: then its errors are larger than they
    look.
    """
    dt = np.diff(time)
    gap = np.abs(np.diff(path) - 0.5 * (speed[1:] + speed[:-1]) * dt)
    usual = float(np.median(gap) / 0.6745)
    expected = np.sqrt(2.0 * sd_path**2 + 0.5 * (sd_speed * dt) ** 2)
    apart = gap > CONTRADICTION * np.maximum(usual, expected)
    if not 0 < apart.sum() <= RARE * len(apart):
        return np.zeros(len(time))
    wide = np.pad(np.where(apart, gap / dt, 0.0), CONTRADICTION_REACH)
    windows = np.lib.stride_tricks.sliding_window_view(wide, 2 * CONTRADICTION_REACH)
    found: Array = windows.max(axis=1)
    return found


def _step_of(angle: Array) -> float:
    """The encoder's step: the smallest change of angle on record."""
    steps = np.abs(np.diff(angle))
    steps = steps[steps > 1e-12]
    return float(np.min(steps)) if len(steps) else 0.0


def encoder_step(path: Array) -> float:
    """The step of the encoder that recorded a path in motion, in the path's unit; zero where its
    samples are finer than any encoder's."""
    step = _step_of(path)
    return 0.0 if noise_of(path) > UNEVEN * step / np.sqrt(12.0) else step


def _local_fit(
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


def _smooth(
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
        fit = _local_fit(time, path, speed, sd_path, sd_speed, half)
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


def impose(run: Run, radius_m: float | None) -> ImposedMotion:
    """Estimate the imposed motion of a run.

    Parameters
    ----------
    run
        The record; its angle or position is used where it is there, else the speed alone.
    radius_m
        Journal radius, m: turns the angle into a path. None where it is not known: a position
        then makes the axis a linear one, which is a rotary one of radius 1 m, and an angle tells
        nothing of the speed.
    """
    time, speed = run.time_s, run.velocity_m_s
    n = len(time)
    path = _recorded_path(run, radius_m)
    rest = resting_samples(speed)
    step = 0.0 if path is None else _step_of(path)
    if path is not None:
        rest |= still_samples(path, speed, step)
    moving = ~rest
    if path is None:
        steps = 0.5 * (speed[1:] + speed[:-1]) * np.diff(time)
        path, sd_path = np.concatenate(([0.0], np.cumsum(steps))), 1e3
    else:
        sd_path, hum = step / np.sqrt(12.0), noise_of(path[moving])
        # Where samples are finer than any encoder's, the smallest change on record is chance.
        if hum > UNEVEN * sd_path:
            sd_path = hum
        sd_path = max(sd_path, 1e-9 * float(np.ptp(path)), 1e-15)
    top = float(np.max(np.abs(speed))) if n else 0.0
    sd_speed = noise_of(speed[moving]) if moving.any() else 0.0
    sd_speed = max(sd_speed, 1e-7 * top, 1e-15)
    beyond = _disagreement(time, path, speed, sd_path, sd_speed) if n > 1 else 0.0
    usual = max(sd_speed, beyond)

    contradiction = np.zeros(n)
    if n > 1:
        contradiction = _contradiction(time, path, speed, sd_path, usual)

    velocity, acceleration = np.where(rest, 0.0, speed), np.zeros(n)
    smooth_path, error = path.copy(), np.zeros(n)
    edges = np.diff(np.concatenate(([0], moving.astype(np.int8), [0])))
    for first, end in zip(np.flatnonzero(edges == 1), np.flatnonzero(edges == -1), strict=True):
        part = slice(first, end)
        if end - first < 3:
            error[part] = usual
            continue
        local = local_noise(speed[part])
        sd: Array | float = usual
        if isinstance(local, np.ndarray):
            sd = np.maximum(local, usual)
        if contradiction[part].any():
            # A position was read; a speed was made from positions, and the making has its ends.
            sd = np.maximum(sd, contradiction[part])
        smooth_path[part], velocity[part], acceleration[part], error[part] = _smooth(
            time[part], path[part], speed[part], sd_path, sd
        )
    _place_rests(rest, smooth_path, velocity, acceleration, 0.5 * sd_path * np.sqrt(12.0))
    trusted = rest | (np.abs(velocity) > SIGN_SIGMA * error)
    trusted &= contradiction == 0.0
    # A contact that bends begins bent where the run begins in motion: noise is none.
    if n and not trusted[0]:
        velocity[0] = 0.0
    angle = smooth_path / (radius_m or 1.0)
    if radius_m is None and run.position_m is None and run.angle_rad is not None:
        angle = np.unwrap(run.angle_rad)
    return ImposedMotion(velocity, acceleration, angle, error, rest, trusted)


def _recorded_path(run: Run, radius_m: float | None) -> Array | None:
    """The path on record, m; None where only the speed tells of it."""
    if run.angle_rad is not None and radius_m is not None:
        path: Array = np.unwrap(run.angle_rad) * radius_m
        return path
    return run.position_m
