"""Record minus model: means along an axis, in time, run after run."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from jbf.plot.bin_axes import bin_axis
from jbf.plot.runs import index_of, said_by
from jbf.plot.style import (
    BEFORE,
    MODEL,
    dress,
    legend_on_top,
    noise_band,
    one_axes,
    plain,
    shortened,
)
from jbf.records.counts import count_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from jbf.comparison.comparison import Comparison
    from jbf.comparison.patterns import Failure
    from jbf.estimation.fit import Fit
    from jbf.records.quantities import Quantities

Array = npt.NDArray[np.float64]

MOST_TICKS = 16
MOST_DOTS = 4000
ONE_PLACE = 0.012
"""Share of an axis's length below which two marks stand at one place."""
NEARLY_ALL = 0.998
"""Of the samples: so many are seen in a picture in time."""


def means_along(comparison: Comparison, axis: str | None) -> Failure:
    """Bin means of a comparison's residual along an axis, also where it does not fail; by default
    along the one where it fails most, or else along velocity."""
    from jbf.comparison import patterns
    from jbf.comparison.axes import all_axes, force_axis
    from jbf.models.catalogue import transition_speed

    for failure in comparison.failures:
        if axis in (None, failure.axis):
            return failure
    model = comparison.model
    u_tr = transition_speed(model.law, model.values.tolist())
    found = {a.axis: a for a in all_axes(comparison.campaign, u_tr)}
    found["force"] = force_axis(comparison.predictions, unit=said_by(comparison).force)
    binned = next((a for name, a in found.items() if name == axis), found["velocity"])
    means, counts = patterns.bin_means(binned, comparison.samples, comparison.residuals)
    return patterns.Failure(binned.axis, "no pattern", 0.0, binned.bins, means, counts)


def residual_along(
    comparison: Comparison,
    axis: str | None = None,
    *,
    ax: Axes | None = None,
    colour: str = MODEL,
    label: str = "",
) -> Axes:
    """Means of record minus model in the bins of an axis; by default of the worst.

    Parameters
    ----------
    axis
        `velocity`, `direction`, `regime` (`speed range`), `acceleration`, `angle`, `time`, `run`,
        `time since a rest`, `distance since a reversal` or `force`.
    """
    ax = one_axes(ax)
    said = said_by(comparison)
    noise_band(ax, comparison.noise_n, unit=said.force)
    draw_means(ax, means_along(comparison, axis), colour, said, label)
    legend_on_top(ax)
    return ax


def draw_means(ax: Axes, failure: Failure, colour: str, said: Quantities, label: str = "") -> None:
    """Means of record minus model in the bins, a line for each direction of motion."""
    place = bin_axis(failure, said)
    directions = list(dict.fromkeys(place.series))
    for direction, marker in zip(directions, "os", strict=False):
        own = np.array([s == direction for s in place.series]) & (failure.counts > 0)
        x, means = _at_places(place.x[own], failure.means_n[own], failure.counts[own])
        name = ", ".join(x for x in (label, direction) if x)
        ax.plot(
            x,
            means,
            color=colour,
            marker=marker,
            markerfacecolor=colour if marker == "o" else "white",
            markersize=5,
            linewidth=1.0,
            linestyle="-" if marker == "o" else "--",
            label=name or "mean in the bin",
        )
    if place.ticks:
        _ticks(ax, place.ticks)
    dress(ax, f"Residual along {failure.axis}", place.name, f"Record minus model ({said.force})")


def _at_places(x: Array, means: Array, counts: npt.NDArray[np.int64]) -> tuple[Array, Array]:
    """Bins in order, those that stand at one place on the page as one: of a speed that is held
    there are many."""
    order = np.argsort(x, kind="stable")
    x, means, counts = x[order], means[order], counts[order]
    groups = np.cumsum(np.diff(x, prepend=x[:1]) > ONE_PLACE * (np.ptp(x) if len(x) else 0.0))
    weight = np.bincount(groups, counts)
    return np.bincount(groups, counts * x) / weight, np.bincount(groups, counts * means) / weight


def _ticks(ax: Axes, ticks: tuple[str, ...]) -> None:
    """Names under the bins; of very many every few."""
    every = -(-len(ticks) // MOST_TICKS)
    shown = [plain(shortened(t, 24)) for t in ticks[::every]]
    longest = max(len(line) for tick in shown for line in tick.split("\n"))
    crowded = longest * len(shown) > 70
    ax.set_xticks(
        range(0, len(ticks), every),
        labels=shown,
        rotation=30 if crowded else 0,
        ha="right" if crowded else "center",
        fontsize="small",
    )


def residual_in_time(
    comparison: Comparison, run: int | str | None = None, *, ax: Axes | None = None
) -> Axes:
    """Record minus model of one run, where the sign of the motion is known."""
    ax = one_axes(ax, (10.0, 3.0))
    index = index_of(comparison, run)
    p = comparison.campaign.prepared[index]
    shown = np.where(comparison.samples.counted[index], comparison.residuals[index], np.nan)
    unit = said_by(comparison).force
    noise_band(ax, comparison.noise_n, unit=unit)
    ax.plot(
        p.run.time_s,
        shown,
        ".",
        color=MODEL,
        markersize=2,
        label="record minus model",
        rasterized=True,
    )
    # A few samples far off would leave no room for the rest.
    size = np.abs(shown[np.isfinite(shown)])
    reach = max(1.4 * float(np.quantile(size, NEARLY_ALL)), 3.0 * comparison.noise_n)
    if reach > 0.0:
        ax.set_ylim(-reach, reach)
    far = int(np.sum(size > reach))
    beyond = f"; {count_of(far, 'sample')} beyond" if far else ""
    dress(ax, f"Residual, run {p.run.name}{beyond}", "Time (s)", f"Record minus model ({unit})")
    legend_on_top(ax)
    return ax


def residuals_in_a_row(fit: Fit, *, ax: Axes | None = None) -> Axes:
    """Record minus model of a fit, run after run."""
    ax = one_axes(ax)
    # The samples next to a reversal count for nothing and may be far off.
    reach = 5.0 * fit.rms_n
    start = 0
    for i, residual in enumerate(fit.residuals):
        stride = max(len(residual) * len(fit.residuals) // MOST_DOTS, 1)
        at = np.arange(start, start + len(residual))[::stride]
        colour = MODEL if i % 2 == 0 else BEFORE
        ax.plot(at, residual[::stride], ".", color=colour, markersize=2, rasterized=True)
        start += len(residual)
    unit = fit.model.rig.quantities.force
    noise_band(ax, fit.rms_n, "RMS", unit)
    if reach > 0.0:
        ax.set_ylim(-reach, reach)
    dress(ax, "What the fit leaves, run after run", "Sample", f"Record minus model ({unit})")
    ax.legend(loc="upper left", frameon=False, fontsize="small")
    return ax
