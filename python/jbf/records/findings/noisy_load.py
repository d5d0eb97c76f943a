"""Noisy load: a load column that consists of white noise about a constant load."""

from __future__ import annotations

import numpy as np

from jbf.arrays import Array
from jbf.records.findings.finding import Finding

LEAST_SAMPLES = 100
CHANCE = 1e-4
"""Probability of classifying a constant load with white noise as a changing one."""
CONSTANT_RANGE = 1e-9
"""Relative range below which a column is constant."""


def only_noise(load: Array) -> bool:
    """Whether the changes of a load column are white noise about a constant.

    Both tests must be passed: no significant line in the periodogram (Fisher 1929), and a
    cumulative periodogram that is linear in the frequency (Bartlett 1954).
    """
    n = len(load)
    if n < LEAST_SAMPLES or np.ptp(load) <= CONSTANT_RANGE * float(np.mean(load)):
        return False
    power = np.abs(np.fft.rfft(load - np.mean(load))[1 : (n + 1) // 2]) ** 2
    share = power / np.sum(power)
    m = len(power)
    line = m * (1.0 - float(np.max(share))) ** (m - 1)
    rise = np.max(np.abs(np.cumsum(share) - np.arange(1, m + 1) / m))
    even = 2.0 * np.exp(-2.0 * m * float(rise) ** 2)
    return line > CHANCE and even > CHANCE


def steady_load(load: Array) -> Array:
    """Load without noise: its mean at every sample if the load is constant, otherwise unchanged."""
    return np.full(len(load), float(np.mean(load))) if only_noise(load) else load


def find_noisy_load(name: str, load: Array | None) -> list[Finding]:
    """Report a recorded load that consists only of noise about its mean."""
    if load is None or not only_noise(load):
        return []
    size = float(np.std(load))
    share = 100.0 * size / float(np.mean(load))
    words = f"the load is white noise of {size:.3g} N ({share:.2g} %) about {np.mean(load):.4g} N"
    return [Finding("noisy_load", "load_n", name, size, "N", "replaced by its mean", words)]
