"""Named streams of random numbers, so that an additional draw leaves all others unchanged."""

from __future__ import annotations

import zlib

import numpy as np

Rng = np.random.Generator


def stream(seed: int, *words: str) -> Rng:
    """Return the generator for one use of a seed."""
    return np.random.default_rng([seed, *(zlib.crc32(word.encode()) for word in words)])


def log_uniform(rng: Rng, low: float, high: float) -> float:
    """Draw a number between two positive limits, uniformly distributed in its logarithm."""
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))
