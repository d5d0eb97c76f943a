"""Stribeck curves: the mean friction at each speed, both ways, of record, model and law."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from jbf.plot.runs import axes_words
from jbf.plot.style import INK, MEASURED, MODEL, dress, one_axes

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from jbf.comparison.comparison import Comparison

Array = npt.NDArray[np.float64]

BINS = 24
FEWEST = 5
"""Fewer samples make no mean worth a dot."""


def stribeck(comparison: Comparison, *, ax: Axes | None = None) -> Axes:
    """Friction without what is none of it, over the speed: means of all runs with the scatter
    round them, the model's means of the same samples, and the law's own steady curve."""
    from jbf.comparison.parts import added_by, beside_friction

    ax = one_axes(ax)
    rest = added_by(comparison, beside_friction(comparison))
    prepared, samples = comparison.campaign.prepared, comparison.samples
    speed = samples.flat([p.motion.velocity_m_s for p in prepared])
    measured = samples.flat([p.friction_n - f for p, f in zip(prepared, rest, strict=True)])
    modelled = samples.flat([m - f for m, f in zip(comparison.predictions, rest, strict=True)])
    for way, filled in ((1.0, True), (-1.0, False)):
        own = speed * way > 0.0
        if own.sum() < FEWEST:
            continue
        x, mean, spread = _means(speed[own], measured[own])
        face = MEASURED if filled else "white"
        ax.errorbar(
            x,
            mean,
            yerr=spread,
            fmt="o",
            color=MEASURED,
            markerfacecolor=face,
            markersize=5,
            elinewidth=0.8,
            label="measured, with its scatter" if filled or not np.any(speed > 0.0) else None,
        )
        x, mean, _ = _means(speed[own], modelled[own])
        name = "model at the same samples" if filled or not np.any(speed > 0.0) else None
        ax.plot(x, mean, "-", color=MODEL, linewidth=1.5, label=name)
    limits = ax.get_ylim()
    _steady(ax, comparison, speed)
    ax.set_ylim(limits)
    ax.axhline(0.0, color=INK, linewidth=0.6)
    dress(ax, "Friction over speed, means of all runs", *axes_words(comparison))
    ax.legend(loc="upper left", frameon=False, fontsize="small")
    return ax


def _means(speed: Array, force: Array) -> tuple[Array, Array, Array]:
    """Means in bins that hold as many samples each: speed, force, and the force's scatter."""
    order = np.argsort(speed, kind="stable")
    parts = np.array_split(order, max(min(BINS, len(order) // FEWEST), 1))
    rows = [(speed[p].mean(), force[p].mean(), force[p].std()) for p in parts]
    x, mean, spread = np.array(rows).T
    return x, mean, spread


def _steady(ax: Axes, comparison: Comparison, speed: Array) -> None:
    """The steady curve of the law alone, under the rig's load; none where that needs one."""
    from jbf.errors import InputError

    for way in (1.0, -1.0):
        own = np.abs(speed[speed * way > 0.0])
        if len(own) < FEWEST:
            continue
        x = way * np.geomspace(max(own.min(), 1e-4 * own.max()), own.max(), 300)
        try:
            steady = comparison.model.steady_friction(x)
        except InputError:
            return
        there = any(line.get_label() == "law alone, steady" for line in ax.lines)
        name = None if there else "law alone, steady"
        ax.plot(x, steady, ":", color=INK, linewidth=1.2, label=name)
