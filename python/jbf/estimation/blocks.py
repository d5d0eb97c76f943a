"""Blocks of samples longer than the correlation time of the residual, for sign randomisation.

All samples of a block change sign together.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from jbf.estimation.samples import Samples

Places = npt.NDArray[np.intp]

SHORTEST_BLOCK_S = 1.0
"""Minimum length of a block, s: longer than any correlation time that is treated as noise."""
MEMORIES = 4.0
"""Minimum length of a block in correlation times of the residual."""


def blocks_of(samples: Samples, share: float) -> Places:
    """Start indices of blocks among the samples with weight, with all runs concatenated.

    No block spans two runs.

    Parameters
    ----------
    share
        Number of independent samples per sample; smaller for a longer correlation time.
    """
    found, before = [], 0
    for weight, step in zip(samples.weight, samples.steps_s, strict=True):
        count = int(np.count_nonzero(weight > 0.0))
        length = max(round(SHORTEST_BLOCK_S / step), round(0.5 * MEMORIES / share), 1)
        found.append(before + np.arange(0, count, length))
        before += count
    return np.concatenate(found).astype(np.intp)
