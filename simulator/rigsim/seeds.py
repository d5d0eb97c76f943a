"""Streams of random numbers by name, so that drawing one thing more moves nothing else."""

from __future__ import annotations

import zlib

import numpy as np

Rng = np.random.Generator


def stream(seed: int, *words: str) -> Rng:
    """The generator of one use of a seed."""
    return np.random.default_rng([seed, *(zlib.crc32(word.encode()) for word in words)])


def log_uniform(rng: Rng, low: float, high: float) -> float:
    """A number between two positive ones, every decade as likely as another."""
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))
