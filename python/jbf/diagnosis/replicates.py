"""Structure seen without any axis: what comes again when the same motion comes again.

Noise of one period knows nothing of the next; an error of the model does. The correlation of the
residual with itself one period later is therefore the share of its mean square that is no noise
(a lack-of-fit test with replicates).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from jbf.diagnosis.ledger import Remainder
from jbf.diagnosis.policy import Policy
from jbf.estimation.noise import Noise
from jbf.estimation.prepared import Prepared
from jbf.estimation.replicates import period_samples
from jbf.estimation.solution import Solution

MIN_PAIRS = 100
"""Pairs of replicates that a run must have to say something."""


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
        own = float(first @ second)
        product += own
        square += level * len(first)
        spread += level**2 * len(first) * _fewer(solution.noise, p.step_s)
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


def _fewer(noise: Noise, step_s: float) -> float:
    """How many times fewer independent samples a coloured noise has, for products of two (Bartlett
    1946): `1 + 2 sum of squared autocorrelations`."""
    if noise.colour <= 0.0:
        return 1.0
    keep = float(np.exp(-2.0 * step_s / noise.memory_s))
    return 1.0 + 2.0 * noise.colour**2 * keep / (1.0 - keep)
