"""Ends of a channel that do not belong to it: the first samples before a converter is ready, the
last ones of a buffer that was not full.

Within a record a sample that is off has neighbours on both sides that say so; at its ends it has
those of one side. They say it where it is off by much more than anything in the record is.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from jbf.records.findings.finding import Finding
from jbf.records.lagrange import weights_at_zero

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

MOST = 3
"""Samples at an end that may be off."""
TIMES = 4.0
"""Times the largest distance of any sample within from what follows it."""
LEAST_SAMPLES = 60


def loose_ends(time: Array, values: Array, beside: int) -> Mask:
    """True at the first and last samples that are off what comes next to them.

    Parameters
    ----------
    beside
        How many samples say where the one next to them is: one its level, three a parabola.
    """
    found = np.zeros(len(values), dtype=bool)
    if len(values) < max(LEAST_SAMPLES, 2 * MOST + 2 * beside):
        return found
    found[: _loose(time, values, beside)] = True
    found[len(values) - _loose(time[::-1], values[::-1], beside) :] = True
    return found


def _loose(time: Array, values: Array, beside: int) -> int:
    """How many samples at the beginning are off."""
    n = len(values) - beside
    t = np.stack([time[k : n + k] - time[:n] for k in range(1, beside + 1)])
    y = np.stack([values[k : n + k] - values[:n] for k in range(1, beside + 1)])
    off = np.abs(np.sum(weights_at_zero(t) * y, axis=0))
    within = float(np.max(off[MOST : n - MOST]))
    far = np.flatnonzero(off[:MOST] > TIMES * within)
    # Of a record that never changes nobody knows by how much it may.
    return int(far[-1]) + 1 if within > 0.0 and len(far) else 0


def ends_finding(
    channel: str, what: str, run: str, mask: Mask, off: Array, unit: str, done: str
) -> Finding | None:
    """What is said of ends that are off by so much; None where none is."""
    if not mask.any():
        return None
    half = len(mask) // 2
    sides = [
        f"the {word} sample" if np.sum(part) == 1 else f"the {word} {np.sum(part)} samples"
        for word, part in (("first", mask[:half]), ("last", mask[half:]))
        if part.any()
    ]
    size = float(np.max(np.abs(off[mask])))
    words = f"{' and '.join(sides)} of the {what} off by up to {size:.3g} {unit}"
    return Finding("glitches", channel, run, size, unit, done, words)
