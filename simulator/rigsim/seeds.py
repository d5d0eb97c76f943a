"""Independent streams of random numbers from one seed, each identified by words.

An additional draw from one stream does not change the others.
"""

from __future__ import annotations

import zlib

import numpy as np

Rng = np.random.Generator


def stream(seed: int, *words: str) -> Rng:
    """Return the random number generator of the stream that `seed` and `words` identify."""
    return np.random.default_rng([seed, *(zlib.crc32(word.encode()) for word in words)])


def log_uniform(rng: Rng, low: float, high: float) -> float:
    """Draw a number between two positive limits whose logarithm has a uniform distribution."""
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))
