"""A force without noise: a command of the controller, or a filtered reading."""

from __future__ import annotations

import numpy as np

from jbf.arrays import Array, Mask
from jbf.records.findings.finding import Finding
from jbf.records.motion.roughness import white_noise
from jbf.records.run import Run

LEAST = 200
"""Minimum number of samples in motion."""
ORDERS = (4, 6)
"""Orders of the differences that are compared."""
MAX_NOISE_RATIO = 0.5
"""Ratio of the noise estimates of the higher and the lower order; it is 1 for white noise."""
ROUNDING_SHARE = 1e-4
"""Share of the standard deviation of the force below which noise is digit rounding only."""


def is_without_noise(force: Array) -> bool:
    """Whether a force in motion has no detectable white noise.

    Notes
    -----
    Differences of order k times ``1 / sqrt(binomial(2 k, k))`` estimate the standard deviation of
    white noise, for every k. For a smooth signal, this estimate decreases with k.
    """
    if len(force) < LEAST:
        return False
    low, high = (white_noise(force, order) for order in ORDERS)
    return high < MAX_NOISE_RATIO * low or high < ROUNDING_SHARE * float(np.std(force))


def find_smooth_force(run: Run, sliding: Mask) -> list[Finding]:
    """Report a force that is a command or was filtered, since it has no noise.

    Parameters
    ----------
    sliding
        True at the samples in motion with usable readings, shape (n,).
    """
    assert run.friction is not None
    force = run.friction[sliding]
    if not is_without_noise(force):
        return []
    names = run.quantities
    noise = white_noise(force, ORDERS[1])
    words = (
        f"the {names.noun} is a command or was filtered: its white noise is at most {noise:.2g} "
        f"{names.force}, so its noise floor is unknown"
    )
    return [Finding("smooth_force", "friction_n", run.name, noise, names.force, "none", words)]
