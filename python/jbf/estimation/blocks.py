"""Blocks of samples longer than the correlation time of the residual, for sign randomisation.

All samples of a block change sign together.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from jbf.estimation.samples import Samples

Places = npt.NDArray[np.intp]


def blocks_of(samples: Samples, share: float) -> Places:
    """Start indices of blocks among the samples with weight, with all runs concatenated.

    No block spans two runs.

    Parameters
    ----------
    share
        Number of independent samples per sample; smaller for a longer correlation time.
    """
    settings, found, before = samples.settings.blocks, [], 0
    for weight, step in zip(samples.weight, samples.steps_s, strict=True):
        count = int(np.count_nonzero(weight > 0.0))
        shortest = round(settings.min_length_s / step)
        length = max(shortest, round(0.5 * settings.min_memories / share), 1)
        found.append(before + np.arange(0, count, length))
        before += count
    return np.concatenate(found).astype(np.intp)
