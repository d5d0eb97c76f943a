"""Replicates: parts of a record that repeat the same motion."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from jbf.estimation.settings import DEFAULT, PeriodSettings

Array = npt.NDArray[np.float64]


def period_samples(velocity: Array, settings: PeriodSettings = DEFAULT.periods) -> int | None:
    """Period of a repeated motion in samples, or None."""
    n = len(velocity)
    if n < settings.min_samples or np.ptp(velocity) == 0.0:
        return None
    centred = velocity - velocity.mean()
    power = np.fft.irfft(np.abs(np.fft.rfft(centred, 2 * n)) ** 2)[: n // 2 + n // 4]
    with np.errstate(invalid="ignore", divide="ignore"):
        rho = power / power[0] * n / (n - np.arange(len(power)))
    falls = np.flatnonzero(rho < 0.0)
    if not len(falls):
        return None
    start = int(falls[0])
    inner = rho[start:-1]
    tops = start + np.flatnonzero(
        (inner > rho[start - 1 : -2])
        & (inner >= rho[start + 1 :])
        & (inner > settings.min_correlation)
    )
    if not len(tops):
        return None
    # The first repetition of about the highest correlation, rather than a multiple of it.
    peak = int(tops[np.flatnonzero(rho[tops] > 0.98 * np.max(rho[tops]))[0]])
    # For a record with an incomplete last period, the correlation peaks slightly off the period.
    reach = max(peak // 30, 2)
    gaps = {
        shift: float(np.std(velocity[shift:] - velocity[:-shift]))
        for shift in range(max(peak - reach, 1), min(peak + reach + 1, n - 1))
    }
    best = min(gaps, key=gaps.__getitem__)
    return best if gaps[best] < settings.max_difference * float(np.std(velocity)) else None
