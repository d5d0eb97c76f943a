"""Offset of the recorded speed: it is not zero while the position is constant.

Causes are a quantised speed without a level at zero, and the offset of a tachometer. Without a
correction, a rest would appear as creep, and its friction as friction of sliding.
"""

from __future__ import annotations

import numpy as np

from jbf.arrays import Array, Mask
from jbf.records.findings.finding import Finding
from jbf.records.motion.rests import STILL_SAMPLES, STILL_STEPS
from jbf.records.motion.roughness import step_of

LEAST = 3 * STILL_SAMPLES
"""Minimum number of samples at standstill for an estimate of the offset."""
MIN_IMPLIED_STEPS = 4.0
"""Minimum displacement that the speed implies during a standstill, in encoder steps."""
MIN_OFFSET_ERRORS = 5.0
"""Minimum offset in standard errors."""


def speed_zero(
    name: str, time: Array, path: Array, speed: Array, step: float, unit: str
) -> tuple[Array, float, Finding | None]:
    """Correct the offset of the speed, if it is significant.

    Parameters
    ----------
    path
        Recorded path, m.
    step
        The encoder step, m.
    unit
        Unit of the speed, for the finding.

    Returns
    -------
    speed : ndarray
        The corrected speed, m/s.
    count : float
        One count of the speed, m/s; zero without a correction.
    finding : Finding or None
        The finding, if the speed was corrected.
    """
    resting = _rest_mask(path, step)
    if step <= 0.0 or resting.sum() < LEAST:
        return speed, 0.0, None
    at_rest = speed[resting]
    # Mean of the central values, since a median of quantised values is itself quantised.
    low, high = np.quantile(at_rest, [0.1, 0.9])
    inner = at_rest[(at_rest >= low) & (at_rest <= high)]
    zero = float(np.mean(inner))
    error = float(np.std(inner)) / np.sqrt(len(inner) / STILL_SAMPLES)
    if (
        abs(zero) < MIN_OFFSET_ERRORS * error
        or abs(zero) * _longest(time, resting) < MIN_IMPLIED_STEPS * step
    ):
        return speed, 0.0, None
    words = f"the speed reads {zero:.3g} {unit} at constant position"
    finding = Finding("speed_zero", "velocity_m_s", name, zero, unit, "subtracted", words)
    return speed - zero, step_of(speed), finding


def _rest_mask(path: Array, step: float) -> Mask:
    """Mask of the samples at standstill.

    These are in a window of `STILL_SAMPLES` samples over which the path varies by at most
    `STILL_STEPS` encoder steps.
    """
    n = len(path)
    mask = np.zeros(n, dtype=bool)
    if n < STILL_SAMPLES:
        return mask
    windows = np.lib.stride_tricks.sliding_window_view(path, STILL_SAMPLES)
    for first in np.flatnonzero(np.ptp(windows, axis=1) <= STILL_STEPS * step):
        mask[first : first + STILL_SAMPLES] = True
    return mask


def _longest(time: Array, resting: Mask) -> float:
    """Duration of the longest standstill, s."""
    edges = np.diff(np.concatenate(([0], resting.astype(np.int8), [0])))
    firsts, ends = np.flatnonzero(edges == 1), np.flatnonzero(edges == -1)
    return float(np.max(time[ends - 1] - time[firsts]))
