"""Jitter of the sampling instants relative to an even clock, visible in the time stamps or not."""

from __future__ import annotations

import numpy as np

from jbf.arrays import Array
from jbf.records.findings.finding import Finding
from jbf.records.motion.roughness import noise_of, step_of

LEAST = 0.01
"""Smallest jitter that is reported, as a share of a sampling interval."""
STEP_TOLERANCE, MIN_REGULAR_SHARE = 0.5, 0.9
"""Largest relative deviation from the usual step, and minimum share of steps within it.

Otherwise the record has no constant sampling rate.
"""
ORDER = 5
"""Order of the path differences from which noise is estimated; they vanish for a smooth path."""
DIFFERENCE_STD = np.sqrt(252.0)
"""Standard deviation of differences of order `ORDER` for unit white noise."""
MAX_CORRELATION = -0.45
"""Correlation of adjacent differences below which they are noise (white noise: -5/6)."""
MIN_NOISE_RATIO = 3.0
"""Minimum ratio of the path noise at speed to that at slow motion, and to the encoder rounding."""
MIN_COUNTS = 1.2
"""Minimum path noise, in encoder counts; alternating rounding errors may resemble noise."""
MAX_ESTIMATE_RATIO = 1.6
"""Largest ratio of the jitter estimates at different speeds."""


def uneven_stamps(name: str, time: Array, *, corrected: bool = False) -> Finding | None:
    """Report time stamps with jitter relative to an even clock.

    Parameters
    ----------
    corrected
        True if the instants of the even clock are used instead.
    """
    steps = np.diff(time)
    median_step = float(np.median(steps))
    regular = np.abs(steps - median_step) < STEP_TOLERANCE * median_step
    if len(steps) < 60 or regular.mean() < MIN_REGULAR_SHARE:
        return None
    # A sampling rate that changes smoothly is not jitter. `noise_of` takes third differences of the
    # steps, which are fourth differences of the time stamps. For white noise, the variance of the
    # fourth differences is 70 times that of the noise, and that of third differences 20 times.
    size = noise_of(steps[regular]) * float(np.sqrt(20.0 / 70.0))
    if size < LEAST * median_step:
        return None
    words = f"the time stamps deviate from a regular clock by {1e3 * size:.3g} ms RMS"
    done = "replaced by the regular clock" if corrected else "used as recorded"
    return Finding("jitter", "time_s", name, size, "s", done, words)


def jittered_path(name: str, time: Array, path: Array, speed: Array) -> Finding | None:
    """Report a path whose noise grows with the speed, due to jitter of the sampling instants.

    The encoder was then read at instants that differ from the time stamps.
    """
    median_step = float(np.median(np.diff(time)))
    regular = np.abs(np.diff(time) / median_step - 1.0) < LEAST
    if regular.mean() < MIN_REGULAR_SHARE:
        return None
    rough = np.diff(path, ORDER)
    spoilt = np.convolve(~regular, np.ones(ORDER), "valid") > 0.0
    inner = np.abs(speed[ORDER // 2 : ORDER // 2 + len(rough)])
    top = float(np.quantile(inner, 0.98))
    step = step_of(path)
    floor = step / np.sqrt(12.0)
    sizes, slow_noise = [], floor
    for low, high in ((0.0, 0.15), (0.3, 0.6), (0.6, 1.1)):
        in_band = (inner >= low * top) & (inner < high * top) & ~spoilt
        if in_band.sum() < 60:
            if low > 0.0:
                return None
            continue
        noise = float(np.median(np.abs(rough[in_band]))) / 0.6745 / DIFFERENCE_STD
        if low == 0.0:
            slow_noise = max(noise, floor)
            continue
        pairs = in_band[1:] & in_band[:-1]
        if not np.any(pairs):
            return None
        if _correlation(rough[1:][pairs], rough[:-1][pairs]) > MAX_CORRELATION or noise < max(
            MIN_NOISE_RATIO * slow_noise, MIN_COUNTS * step
        ):
            return None
        mean = float(np.sqrt(np.mean(inner[in_band] ** 2)))
        sizes.append(float(np.sqrt(noise**2 - slow_noise**2)) / mean)
    size = sizes[-1]
    if (
        size < LEAST * median_step
        or not 1.0 / MAX_ESTIMATE_RATIO < sizes[0] / size < MAX_ESTIMATE_RATIO
    ):
        return None
    words = (
        "the position noise grows with the speed, as with time stamp errors of "
        f"{1e3 * size:.3g} ms RMS"
    )
    return Finding("jitter", "time_s", name, size, "s", "none", words)


def _correlation(a: Array, b: Array) -> float:
    # Medians are not needed: both have the same noise, and outliers have been corrected.
    return float(np.mean(a * b) / max(float(np.sqrt(np.mean(a**2) * np.mean(b**2))), 1e-300))
