"""Other maxima of a likelihood that has many, along the parameter that causes them.

Frequencies that the samples cannot distinguish cause one maximum each. A search ends at the maximum
near its start. The next ones are found from there by varying this parameter only.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

REACH = 5.0
"""Range of the scan, as a factor on the value upwards and downwards. It bounds a search only."""
POINTS = 41
"""Number of points of the scan. It is a numerical resolution."""
CLIMBED = 2
"""Number of maxima that are followed by a search. It limits the effort only."""


def other_peaks(
    square: Callable[[Array], float], values: Array, which: int, lower: float, upper: float
) -> list[Array]:
    """Best local minima of `square` along parameter number `which`, except the current one.

    Parameters
    ----------
    square
        Sum of squares as a function of the parameter values.
    which
        Index of the parameter.
    lower, upper
        Bounds of the parameter, a positive scale.
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
    # Minima within the grid spacing are the current one.
    lowest &= np.abs(np.log(places / values[which])) > spread / POINTS
    best = sorted(np.flatnonzero(lowest), key=lambda k: found[k])[:CLIMBED]
    return [moved(float(places[k])) for k in best]
