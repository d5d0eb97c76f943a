"""The spread of a random effect between runs, by moments (DerSimonian & Laird 1986)."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy import special

Array = npt.NDArray[np.float64]


def spread_between(estimates: Array, precisions: Array) -> tuple[float, float, float]:
    """Standard deviation between runs (zero where they agree), the probability of so much by
    chance, and how many times as much as chance it is."""
    mean = float(np.sum(precisions * estimates) / np.sum(precisions))
    q, free = float(np.sum(precisions * (estimates - mean) ** 2)), len(estimates) - 1
    # Residuals are never quite as white as their innovations: ask for twice the chi-square.
    chance = float(special.chdtrc(free, 0.5 * q))
    whole = float(np.sum(precisions))
    variance = (q - free) / (whole - float(np.sum(precisions**2)) / whole)
    return float(np.sqrt(max(variance, 0.0))), chance, q / free
