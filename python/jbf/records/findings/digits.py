"""The digits that a channel is written with."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]


def last_digit(values: Array) -> float:
    """The last decimal digit that samples are written with; of binary numbers their rounding."""
    top = float(np.max(np.abs(values)))
    if top == 0.0:
        return 0.0
    first = int(np.floor(np.log10(top)))
    for place in range(first, first - 9, -1):
        scaled = values / 10.0**place
        if np.max(np.abs(scaled - np.round(scaled))) < 1e-6:
            return float(10.0**place)
    return 1e-9 * top
