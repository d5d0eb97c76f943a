"""Test for structure without an axis: errors that repeat with a repeated motion.

Noise is independent between periods; a model error is not. The autocorrelation of the residual at
a lag of one period is therefore the share of its mean square that is not noise. This is a
lack-of-fit test with replicates.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from jbf.diagnosis.ledger import Remainder
from jbf.diagnosis.policy import Policy
from jbf.estimation.long_run import long_run_variance
from jbf.estimation.prepared import Prepared
from jbf.estimation.replicates import period_samples
from jbf.estimation.solution import Solution

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]


def find_replicates(
    prepared: Sequence[Prepared], solution: Solution, policy: Policy
) -> list[Remainder]:
    """Find the part of the residual that repeats with the motion, over all periodic runs."""
    product, spread, square, names = 0.0, 0.0, 0.0, []
    settings = solution.samples.settings
    least = policy.replicates.min_share
    left = solution.samples.without_deviations(solution.residuals, solution.noise)
    for residual, counted, p in zip(left, solution.samples.counted, prepared, strict=True):
        shift = period_samples(p.motion.velocity, settings.periods)
        if shift is None:
            continue
        both = counted[shift:] & counted[:-shift]
        first, second = residual[:-shift][both], residual[shift:][both]
        if len(first) < policy.replicates.min_pairs:
            continue
        level = float(first @ first + second @ second) / (2.0 * len(first))
        # Noise with a long memory is correlated over a period, and more over half a period.
        own = float(first @ second) - len(first) * _remembered(
            residual, counted, shift, policy.replicates.memory_lags
        )
        product += own
        square += level * len(first)
        products = first * second
        strayed = long_run_variance(
            (products - np.mean(products))[:, None], p.step_s, settings.variance
        )
        spread += max(level**2 * len(first), float(strayed[0, 0]))
        if own > least * level * len(first):
            names.append(p.run.name)
    if spread == 0.0:
        return []
    share = product / square
    if share < least or product < policy.replicates.min_sigma * np.sqrt(spread):
        return []
    size = float(np.sqrt(share))
    where = (
        f"error that comes again with each period, {100.0 * size:.0f} % of the residual's RMS, in "
        + ", ".join(names)
    )
    return [Remainder("period", where, min(share, 1.0))]


def _remembered(residual: Array, counted: Mask, shift: int, lags: Sequence[float]) -> float:
    """Mean product one period apart that is due to the noise's memory, N^2.

    It is the smallest mean product at lags between half a period and a whole one, where a repeating
    error has both signs.
    """
    products = []
    for share in lags:
        lag = max(int(share * shift), 1)
        both = counted[lag:] & counted[:-lag]
        if both.any():
            products.append(float(np.mean(residual[:-lag][both] * residual[lag:][both])))
    return max(min(products, default=0.0), 0.0)
