"""Spectra of the residual, which show hum, ripple or rattle above the noise."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from jbf.plot.runs import index_of, quantities_of
from jbf.plot.style import MODEL, NOISE, dress, one_axes

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from jbf.comparison.comparison import Comparison

SEGMENTS = 8
"""Number of segments of a run that are averaged, with 50 % overlap."""
SHORTEST = 64


def spectrum(
    comparison: Comparison,
    run: int | str | None = None,
    *,
    ax: Axes | None = None,
    colour: str = MODEL,
    label: str = "record minus model",
) -> Axes:
    """Plot the amplitude spectral density of one run's residual, and that of white noise.

    The residual is record minus model; excluded samples are set to zero. The white noise has the
    same variance.

    Parameters
    ----------
    run
        Index or name of the run. Default: the run with the largest error.
    """
    from scipy.signal import welch

    ax = one_axes(ax, (7.0, 3.6))
    index = index_of(comparison, run)
    p = comparison.campaign.prepared[index]
    time = p.run.time_s
    step = float(np.median(np.diff(time)))
    residual = np.where(comparison.samples.counted[index], comparison.residuals[index], 0.0)
    even = np.interp(np.arange(time[0], time[-1] + 0.5 * step, step), time, residual)
    length = min(max(2 * len(even) // (SEGMENTS + 1), SHORTEST), len(even))
    frequency, density = welch(even, 1.0 / step, nperseg=length)
    unit = quantities_of(comparison).force
    ax.loglog(frequency[1:], np.sqrt(density[1:]), color=colour, linewidth=1.0, label=label)
    if not any(str(line.get_label()).startswith("white noise") for line in ax.lines):
        floor = comparison.noise_rms * np.sqrt(2.0 * step)
        ax.axhline(
            floor, color=NOISE, linestyle="--", linewidth=1.2, label="white noise of equal power"
        )
    title = f"Spectrum of the residual, run {p.run.name}"
    dress(ax, title, "Frequency (Hz)", f"Density ({unit}/√Hz)")
    ax.legend(frameon=False, fontsize="small")
    return ax
