"""Temperature that is sampled more slowly than the force, coarsely quantised, or noisy.

Temperature effects are slow, because iron and oil take many seconds to warm. A model requires the
temperature of the body, without the jumps of its readings.
"""

from __future__ import annotations

import numpy as np

from jbf.arrays import Array
from jbf.records.findings.finding import Finding
from jbf.records.motion.roughness import noise_of
from jbf.records.run import Run

HELD = 0.5
"""Minimum share of repeated samples for a held reading."""
SMOOTH_S = 2.0
"""Averaging time for a noisy reading, s."""
NOISE_K = 0.1
"""Noise below which no average is taken, K; changes the viscosity of an oil by half a percent."""


def recorded_temperature(run: Run) -> Array | None:
    """Return the temperature of a run, C, shape (n,), without held steps and noise.

    Returns None if no temperature was recorded.
    """
    if run.temperature_c is None:
        return None
    return _smoothed_temperature(run.time_s, run.temperature_c)[0]


def find_slow_temperature(run: Run) -> list[Finding]:
    """Report the corrections of the recorded temperature."""
    if run.temperature_c is None:
        return []
    _, held_s, noise_k = _smoothed_temperature(run.time_s, run.temperature_c)
    findings = []
    if held_s > 0.0:
        words = f"the temperature is constant for {held_s:.2g} s between readings"
        done = "interpolated linearly between readings"
        findings.append(
            Finding("held_samples", "temperature_c", run.name, held_s, "s", done, words)
        )
    if noise_k > 0.0:
        words = f"the temperature has noise of {noise_k:.2g} K"
        done = f"averaged over {SMOOTH_S:g} s"
        findings.append(
            Finding("noisy_temperature", "temperature_c", run.name, noise_k, "K", done, words)
        )
    return findings


def _smoothed_temperature(time: Array, celsius: Array) -> tuple[Array, float, float]:
    """Temperature without steps or noise, C; hold time of its readings, s; their noise, K.

    Hold time and noise are zero if no correction was made.
    """
    interpolated, held_s = _through_jumps(time, celsius)
    noise_k = noise_of(interpolated)
    if noise_k < NOISE_K:
        return interpolated, held_s, 0.0
    return _averaged(time, interpolated), held_s, noise_k


def _through_jumps(time: Array, celsius: Array) -> tuple[Array, float]:
    """Interpolate a stepwise temperature record linearly through the midpoints of its jumps.

    Also returns the median duration of its steps, s.
    """
    jumps = np.flatnonzero(np.diff(celsius) != 0.0)
    if not len(jumps) or len(jumps) > (1.0 - HELD) * (len(celsius) - 1):
        return celsius, 0.0
    middles = 0.5 * (time[jumps] + time[jumps + 1])
    values = 0.5 * (celsius[jumps] + celsius[jumps + 1])
    knots = np.concatenate(([time[0]], middles, [time[-1]]))
    ends = np.concatenate((celsius[:1], values, celsius[-1:]))
    held_s = float(np.median(np.diff(knots)))
    return np.interp(time, knots, ends), held_s


def _averaged(time: Array, celsius: Array) -> Array:
    """Moving average of a temperature over `SMOOTH_S`, with interpolation between samples."""
    area = np.concatenate(([0.0], np.cumsum(0.5 * np.diff(time) * (celsius[1:] + celsius[:-1]))))
    # The window is symmetric, so that a linear rise is unchanged up to both ends.
    half = np.minimum(0.5 * SMOOTH_S, np.minimum(time - time[0], time[-1] - time))
    early, late = time - half, time + half
    with np.errstate(divide="ignore", invalid="ignore"):
        mean = (np.interp(late, time, area) - np.interp(early, time, area)) / (late - early)
    return np.where(late > early, mean, celsius)
