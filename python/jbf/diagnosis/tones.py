"""Test for tones: spectral lines above the white spectrum of the innovations (Fisher 1929)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from jbf.diagnosis.ledger import Remainder
from jbf.diagnosis.policy import Policy
from jbf.estimation.prepared import Prepared
from jbf.estimation.samples import Samples

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]


def find_tones(
    prepared: Sequence[Prepared],
    samples: Samples,
    innovations: Sequence[Array],
    residuals: Sequence[Array],
    policy: Policy,
) -> list[Remainder]:
    """Find spectral lines in the innovations, with their amplitude in the residuals."""
    lines: list[tuple[float, float, str]] = []
    power = 0.0
    for p, counted, e, r in zip(prepared, samples.counted, innovations, residuals, strict=True):
        n = len(e)
        if n < policy.tones.min_samples:
            continue
        f = np.fft.rfftfreq(n, p.step_s)
        spectrum = np.abs(np.fft.rfft(e - np.mean(e))) ** 2
        band = f > policy.tones.min_periods / p.run.duration_s
        if not band.any():
            continue
        level = float(np.median(spectrum[band]) / np.log(2.0))
        k = int(np.argmax(np.where(band, spectrum, 0.0)))
        if level <= 0.0 or spectrum[k] / level < -np.log(policy.tones.chance / band.sum()):
            continue
        frequency, amplitude = _refine(p.run.time_s, r, counted, float(f[k]), float(f[1]))
        lines.append((frequency, amplitude, p.run.name))
        power += 0.5 * amplitude**2 * n
    if not lines:
        return []
    total = sum(
        float(np.sum(r[counted] ** 2))
        for r, counted in zip(residuals, samples.counted, strict=True)
    )
    share = power / max(total, 1e-300)
    if share < policy.tones.min_share:
        return []
    return [
        Remainder(
            "frequency",
            _words(lines, len(prepared), prepared[0].run.quantities.force),
            min(share, 1.0),
        )
    ]


def _words(lines: list[tuple[float, float, str]], runs: int, unit: str) -> str:
    """Describe one common tone, or the tone of each run."""
    middle = float(np.median([x[0] for x in lines]))
    same = [x for x in lines if abs(x[0] - middle) < 0.02 * middle + 0.02]
    scope = "in all runs" if len(lines) == runs else "in " + ", ".join(x[2] for x in lines)
    if len(same) == len(lines):
        amplitude = float(np.median([x[1] for x in same]))
        return f"a {middle:.2f} Hz tone, amplitude {amplitude:.2g} {unit}, {scope}"
    return "tones: " + ", ".join(f"{x[0]:.2f} Hz of {x[1]:.2g} {unit} in {x[2]}" for x in lines)


def _refine(time: Array, r: Array, counted: Mask, near: float, width: float) -> tuple[float, float]:
    """Frequency and amplitude of the best-fitting sine near a spectral line.

    The frequency is kept at least half a line width from zero and from the Nyquist frequency.
    Closer than that, a sine cannot be distinguished from a constant or from its alias.
    """
    nyquist = 0.5 / float(np.median(np.diff(time)))
    grid = near + width * np.linspace(-1.0, 1.0, 41)
    grid = np.clip(grid, 0.5 * width, nyquist - 0.5 * width)
    t, y = time[counted], r[counted]
    best, amplitude, gain = near, 0.0, -1.0
    for f in grid:
        phase = 2.0 * np.pi * f * t
        pair = np.stack([np.cos(phase), np.sin(phase)], axis=1)
        c, *_ = np.linalg.lstsq(pair, y, rcond=None)
        now = float(np.sum((pair @ c) ** 2))
        if now > gain:
            best, amplitude, gain = float(f), float(np.hypot(*c)), now
    return best, amplitude
