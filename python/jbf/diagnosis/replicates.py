"""Structure seen without any axis: what comes again when the same motion comes again.

Noise of one period knows nothing of the next; an error of the model does. The correlation of the
residual with itself one period later is therefore the share of its mean square that is no noise
(a lack-of-fit test with replicates).
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

MIN_PAIRS = 100
"""Pairs of replicates that a run must have to say something."""
BETWEEN = (0.5, 0.6, 0.7, 0.8, 0.9)
"""Shares of a period at which nothing comes again but what the noise remembers."""

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]


def find_replicates(
    prepared: Sequence[Prepared], solution: Solution, policy: Policy
) -> list[Remainder]:
    """What of the residual comes again with the motion, over all periodic runs."""
    product, spread, square, names = 0.0, 0.0, 0.0, []
    least = policy.replicate_share
    left = solution.samples.without_deviations(solution.residuals, solution.noise)
    for residual, counted, p in zip(left, solution.samples.counted, prepared, strict=True):
        shift = period_samples(p.motion.velocity_m_s)
        if shift is None:
            continue
        both = counted[shift:] & counted[:-shift]
        first, second = residual[:-shift][both], residual[shift:][both]
        if len(first) < MIN_PAIRS:
            continue
        level = float(first @ first + second @ second) / (2.0 * len(first))
        # A noise with a long memory remembers a period, and half of one better still.
        own = float(first @ second) - len(first) * _remembered(residual, counted, shift)
        product += own
        square += level * len(first)
        products = first * second
        strayed = long_run_variance((products - np.mean(products))[:, None], p.step_s)
        spread += max(level**2 * len(first), float(strayed[0, 0]))
        if own > least * level * len(first):
            names.append(p.run.name)
    if spread == 0.0:
        return []
    share = product / square
    if share < least or product < policy.replicate_sigma * np.sqrt(spread):
        return []
    size = float(np.sqrt(share))
    where = (
        f"error that comes again with each period, {100.0 * size:.0f} % of the residual's RMS, in "
        + ", ".join(names)
    )
    return [Remainder("period", where, min(share, 1.0))]


def _remembered(residual: Array, counted: Mask, shift: int) -> float:
    """What of the mean product one period apart is the noise's memory, N^2: the least between half
    a period and a whole one, where an error that comes again rises and falls."""
    products = []
    for share in BETWEEN:
        lag = max(int(share * shift), 1)
        both = counted[lag:] & counted[:-lag]
        if both.any():
            products.append(float(np.mean(residual[:-lag][both] * residual[lag:][both])))
    return max(min(products, default=0.0), 0.0)
