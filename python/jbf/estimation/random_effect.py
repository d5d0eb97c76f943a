"""The spread of a random effect between runs, by moments (DerSimonian & Laird 1986)."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy import special

Array = npt.NDArray[np.float64]

ROUNDING = 1e-9
"""Share of the precision of all runs below which that of the others is rounding."""


def spread_between(estimates: Array, precisions: Array) -> tuple[float, float, float]:
    """Standard deviation between runs (zero where they agree), the probability of so much by
    chance, and how many times as much as chance it is."""
    mean = float(np.sum(precisions * estimates) / np.sum(precisions))
    q, free = float(np.sum(precisions * (estimates - mean) ** 2)), len(estimates) - 1
    # Residuals are never quite as white as their innovations: ask for twice the chi-square.
    chance = float(special.chdtrc(free, 0.5 * q))
    whole = float(np.sum(precisions))
    apart = whole - float(np.sum(precisions**2)) / whole
    # Where one run has all of the precision, the others do not tell a spread.
    variance = (q - free) / apart if apart > ROUNDING * whole else 0.0
    return float(np.sqrt(max(variance, 0.0))), chance, q / free
