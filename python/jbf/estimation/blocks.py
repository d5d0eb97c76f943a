"""Blocks of samples that are longer than what is left remembers: what turns its sign as one."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from jbf.estimation.samples import Samples

Places = npt.NDArray[np.intp]

SHORTEST_BLOCK_S = 1.0
"""Blocks are no shorter, s: longer than any memory that passes for noise;"""
MEMORIES = 4.0
"""and so many times as long as what is left remembers."""


def blocks_of(samples: Samples, share: float) -> Places:
    """Where blocks begin among the samples that have weight, all runs in a row; none spans two.

    Parameters
    ----------
    share
        How many independent samples one is worth: the fewer, the longer they remember.
    """
    found, before = [], 0
    for weight, step in zip(samples.weight, samples.steps_s, strict=True):
        count = int(np.count_nonzero(weight > 0.0))
        length = max(round(SHORTEST_BLOCK_S / step), round(0.5 * MEMORIES / share), 1)
        found.append(before + np.arange(0, count, length))
        before += count
    return np.concatenate(found).astype(np.intp)
