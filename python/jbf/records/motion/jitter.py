"""Jitter: samples read off an even clock, whether the stamps say so or not."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from jbf.records.findings.finding import Finding
from jbf.records.motion.roughness import noise_of, step_of

Array = npt.NDArray[np.float64]

LEAST = 0.01
"""Share of a step below which instants that are off are not worth a word."""
EVEN, MOSTLY = 0.5, 0.9
"""So many of the steps are within this share of the usual one, in a record that has a rate."""
ORDER = 5
"""Differences that leave nothing of a smooth path."""
UNIT = np.sqrt(252.0)
"""What such differences make of white noise of unit size: the root of 2 ORDER over ORDER."""
WHITE = -0.45
"""Correlation of neighbouring differences below which they are of noise: -5/6 if it is white."""
BEYOND = 3.0
"""Noise of the path at speed over what it is where the shaft is slow, and over the encoder's."""
COUNTS = 1.2
"""and over a count: rounding that alternates makes a good one of it."""
AGREE = 1.6
"""Jitter is one at all speeds, to this factor."""


def uneven_stamps(name: str, time: Array, *, corrected: bool = False) -> Finding | None:
    """Stamps that are off an even clock.

    Parameters
    ----------
    corrected
        Whether the instants of the even clock are used in their place.
    """
    steps = np.diff(time)
    usual = float(np.median(steps))
    near = np.abs(steps - usual) < EVEN * usual
    if len(steps) < 60 or near.mean() < MOSTLY:
        return None
    # A rate that changes smoothly is no jitter. `noise_of` takes third differences, here of steps:
    # fourth ones of the stamps, in which white noise is 70 of its squares, not 20.
    size = noise_of(steps[near]) * float(np.sqrt(20.0 / 70.0))
    if size < LEAST * usual:
        return None
    words = f"the stamps are off an even clock by {1e3 * size:.3g} ms RMS"
    done = "the instants of the even clock are used" if corrected else "taken as they are"
    return Finding("jitter", "time_s", name, size, "s", done, words)


def shaken_path(name: str, time: Array, path: Array, speed: Array) -> Finding | None:
    """A path whose noise grows with the speed: the encoder looked at other instants than the
    stamps say."""
    usual = float(np.median(np.diff(time)))
    whole = np.abs(np.diff(time) / usual - 1.0) < LEAST
    if whole.mean() < MOSTLY:
        return None
    rough = np.diff(path, ORDER)
    spoilt = np.convolve(~whole, np.ones(ORDER), "valid") > 0.0
    inner = np.abs(speed[ORDER // 2 : ORDER // 2 + len(rough)])
    top = float(np.quantile(inner, 0.98))
    step = step_of(path)
    floor = step / np.sqrt(12.0)
    sizes, slow = [], floor
    for low, high in ((0.0, 0.15), (0.3, 0.6), (0.6, 1.1)):
        which = (inner >= low * top) & (inner < high * top) & ~spoilt
        if which.sum() < 60:
            if low > 0.0:
                return None
            continue
        noise = float(np.median(np.abs(rough[which]))) / 0.6745 / UNIT
        if low == 0.0:
            slow = max(noise, floor)
            continue
        pairs = which[1:] & which[:-1]
        if not np.any(pairs):
            return None
        if _correlation(rough[1:][pairs], rough[:-1][pairs]) > WHITE or noise < max(
            BEYOND * slow, COUNTS * step
        ):
            return None
        mean = float(np.sqrt(np.mean(inner[which] ** 2)))
        sizes.append(float(np.sqrt(noise**2 - slow**2)) / mean)
    size = sizes[-1]
    if size < LEAST * usual or not 1.0 / AGREE < sizes[0] / size < AGREE:
        return None
    words = (
        f"the path is as noisy as if it was read {1e3 * size:.3g} ms RMS off the stamps: "
        "its noise grows with the speed"
    )
    return Finding("jitter", "time_s", name, size, "s", "none", words)


def _correlation(a: Array, b: Array) -> float:
    # Medians would do no better: both are of one noise, and a glitch has been mended.
    return float(np.mean(a * b) / max(float(np.sqrt(np.mean(a**2) * np.mean(b**2))), 1e-300))
