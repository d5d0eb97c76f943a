"""Between-run spread of a random effect by the method of moments (DerSimonian & Laird 1986)."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy import special

Array = npt.NDArray[np.float64]

ROUNDING = 1e-9
"""Fraction of the total precision below which the precision of other runs is a rounding error.

It is a numerical tolerance.
"""


def spread_between(estimates: Array, precisions: Array) -> tuple[float, float, float]:
    """Standard deviation between runs, its p-value, and the ratio of the variance to chance.

    The standard deviation is zero where the runs agree.
    """
    mean = float(np.sum(precisions * estimates) / np.sum(precisions))
    q, free = float(np.sum(precisions * (estimates - mean) ** 2)), len(estimates) - 1
    # Residuals are never as white as assumed, so twice the chi-square is required.
    chance = float(special.chdtrc(free, 0.5 * q))
    whole = float(np.sum(precisions))
    apart = whole - float(np.sum(precisions**2)) / whole
    # If one run has all of the precision, the others do not determine a spread.
    variance = (q - free) / apart if apart > ROUNDING * whole else 0.0
    return float(np.sqrt(max(variance, 0.0))), chance, q / free
