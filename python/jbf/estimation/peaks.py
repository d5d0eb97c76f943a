"""Other peaks of a likelihood that has many, along the parameter that makes them.

Frequencies that samples cannot tell apart make a peak each. A search ends on the one that it began
near; from there the next ones are seen by moving that parameter alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

REACH = 5.0
"""Peaks are looked for up to so many times the value, and down to as small a share of it,"""
POINTS = 41
"""at so many points."""
CLIMBED = 2
"""How many of them are climbed."""


def other_peaks(
    square: Callable[[Array], float], values: Array, which: int, lower: float, upper: float
) -> list[Array]:
    """The best local minima of `square` along parameter number `which`, the one at hand left out.

    Parameters
    ----------
    square
        Sum of squares at parameter values.
    lower, upper
        Bounds of the parameter, a scale above zero.
    """
    spread = np.log(REACH)
    places = values[which] * np.exp(np.linspace(-spread, spread, POINTS))
    places = places[(places > lower) & (places < upper)]

    def moved(place: float) -> Array:
        there: Array = values.copy()
        there[which] = place
        return there

    found = np.array([square(moved(place)) for place in places])
    around = np.pad(found, 1, constant_values=np.inf)
    lowest = (found <= around[:-2]) & (found <= around[2:])
    # The grid's spacing: the same peak, not another.
    lowest &= np.abs(np.log(places / values[which])) > spread / POINTS
    best = sorted(np.flatnonzero(lowest), key=lambda k: found[k])[:CLIMBED]
    return [moved(float(places[k])) for k in best]
