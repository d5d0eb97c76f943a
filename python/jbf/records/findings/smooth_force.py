"""A force without noise: a command of the controller, or a reading behind a filter."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from jbf.records.findings.finding import Finding
from jbf.records.motion.roughness import white_noise
from jbf.records.run import Run

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

LEAST = 200
"""Samples in motion that tell."""
ORDERS = (4, 6)
"""Orders of difference that are compared."""
FALLING = 0.5
"""Ratio of the noise by the higher order to that by the lower one: of white noise it is 1."""
DIGITS = 1e-4
"""Share of the force's standard deviation below which noise is that of digits, and no sensor's."""


def is_without_noise(force: Array) -> bool:
    """Whether a force in motion has no white noise that could be seen.

    Notes
    -----
    The standard deviation of white noise is the same by differences of every order k, with the
    factor ``1 / sqrt(binomial(2 k, k))``. That of a smooth signal falls with k.
    """
    if len(force) < LEAST:
        return False
    low, high = (white_noise(force, order) for order in ORDERS)
    return high < FALLING * low or high < DIGITS * float(np.std(force))


def find_smooth_force(run: Run, sliding: Mask) -> list[Finding]:
    """A finding where the force is a command, or was filtered.

    Parameters
    ----------
    sliding
        True at the samples in motion whose readings can be used, shape (n,).
    """
    assert run.friction_n is not None
    force = run.friction_n[sliding]
    if not is_without_noise(force):
        return []
    said = run.quantities
    noise = white_noise(force, ORDERS[1])
    words = (
        f"the {said.noun} is a command or was filtered: white noise is {noise:.2g} {said.force} "
        "at most, so its noise floor is not known"
    )
    return [Finding("smooth_force", "friction_n", run.name, noise, said.force, "none", words)]
