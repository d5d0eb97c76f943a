"""Plots of the residual (record minus model): means along an axis, in time, over all runs."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from jbf.arrays import Array
from jbf.plot.bin_axes import bin_axis
from jbf.plot.runs import index_of, quantities_of
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


MOST_TICKS = 16
MOST_DOTS = 4000
MERGE_DISTANCE = 0.012
"""Share of an axis's length below which two bins are merged in the plot."""
SHOWN_SHARE = 0.998
"""Share of the samples that a time plot shows."""


def means_along(comparison: Comparison, axis: str | None) -> Failure:
    """Bin means of the residual of a comparison along an axis.

    The axis need not be one along which the model fails. Default: the axis of the worst failure,
    otherwise velocity.
    """
    from jbf.comparison import patterns
    from jbf.comparison.axes import all_axes, force_axis
    from jbf.models.catalogue import transition_speed

    for failure in comparison.failures:
        if axis in (None, failure.axis):
            return failure
    model = comparison.model
    u_tr = transition_speed(model.law, model.values.tolist())
    by_axis = {a.axis: a for a in all_axes(comparison.campaign, u_tr)}
    by_axis["force"] = force_axis(comparison.predictions, unit=quantities_of(comparison).force)
    binned = next((a for name, a in by_axis.items() if name == axis), by_axis["velocity"])
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
    """Plot the mean residual (record minus model) in the bins of an axis.

    Parameters
    ----------
    axis
        `velocity`, `direction`, `regime` (`speed range`), `acceleration`, `angle`, `time`, `run`,
        `time since a rest`, `distance since a reversal` or `force`. Default: the axis of the worst
        failure.
    """
    ax = one_axes(ax)
    quantities = quantities_of(comparison)
    noise_band(ax, comparison.noise_rms, unit=quantities.force)
    draw_means(ax, means_along(comparison, axis), colour, quantities, label)
    legend_on_top(ax)
    return ax


def draw_means(
    ax: Axes, failure: Failure, colour: str, quantities: Quantities, label: str = ""
) -> None:
    """Draw the mean residual in the bins of an axis, one line per direction of motion."""
    place = bin_axis(failure, quantities)
    directions = list(dict.fromkeys(place.series))
    for direction, marker in zip(directions, "os", strict=False):
        in_direction = np.array([s == direction for s in place.series]) & (failure.counts > 0)
        x, means = _at_places(
            place.x[in_direction], failure.means_n[in_direction], failure.counts[in_direction]
        )
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
    dress(
        ax, f"Residual along {failure.axis}", place.name, f"Record minus model ({quantities.force})"
    )


def _at_places(x: Array, means: Array, counts: npt.NDArray[np.int64]) -> tuple[Array, Array]:
    """Sort bins by position, and merge those that coincide in the plot.

    Motion at constant speed yields many coinciding bins.
    """
    order = np.argsort(x, kind="stable")
    x, means, counts = x[order], means[order], counts[order]
    groups = np.cumsum(np.diff(x, prepend=x[:1]) > MERGE_DISTANCE * (np.ptp(x) if len(x) else 0.0))
    weight = np.bincount(groups, counts)
    return np.bincount(groups, counts * x) / weight, np.bincount(groups, counts * means) / weight


def _ticks(ax: Axes, ticks: tuple[str, ...]) -> None:
    """Label the bins; if there are many labels, only every n-th is shown."""
    every = -(-len(ticks) // MOST_TICKS)
    labels = [plain(shortened(t, 24)) for t in ticks[::every]]
    longest = max(len(line) for tick in labels for line in tick.split("\n"))
    crowded = longest * len(labels) > 70
    ax.set_xticks(
        range(0, len(ticks), every),
        labels=labels,
        rotation=30 if crowded else 0,
        ha="right" if crowded else "center",
        fontsize="small",
    )


def residual_in_time(
    comparison: Comparison, run: int | str | None = None, *, ax: Axes | None = None
) -> Axes:
    """Plot the residual of one run in time, where the sign of the motion is known."""
    ax = one_axes(ax, (10.0, 3.0))
    index = index_of(comparison, run)
    p = comparison.campaign.prepared[index]
    residual = np.where(comparison.samples.counted[index], comparison.residuals[index], np.nan)
    unit = quantities_of(comparison).force
    noise_band(ax, comparison.noise_rms, unit=unit)
    ax.plot(
        p.run.time_s,
        residual,
        ".",
        color=MODEL,
        markersize=2,
        label="record minus model",
        rasterized=True,
    )
    # Otherwise a few outliers would determine the scale.
    size = np.abs(residual[np.isfinite(residual)])
    reach = max(1.4 * float(np.quantile(size, SHOWN_SHARE)), 3.0 * comparison.noise_rms)
    if reach > 0.0:
        ax.set_ylim(-reach, reach)
    count_beyond = int(np.sum(size > reach))
    beyond = f"; {count_of(count_beyond, 'sample')} beyond" if count_beyond else ""
    dress(ax, f"Residual, run {p.run.name}{beyond}", "Time (s)", f"Record minus model ({unit})")
    legend_on_top(ax)
    return ax


def residuals_in_a_row(fit: Fit, *, ax: Axes | None = None) -> Axes:
    """Plot the residual of a fit, one run after another."""
    ax = one_axes(ax)
    # Samples next to a reversal have no weight and may be outliers.
    reach = 5.0 * fit.rms
    start = 0
    for i, residual in enumerate(fit.residuals):
        stride = max(len(residual) * len(fit.residuals) // MOST_DOTS, 1)
        at = np.arange(start, start + len(residual))[::stride]
        colour = MODEL if i % 2 == 0 else BEFORE
        ax.plot(at, residual[::stride], ".", color=colour, markersize=2, rasterized=True)
        start += len(residual)
    unit = fit.model.rig.quantities.force
    noise_band(ax, fit.rms, "RMS", unit)
    if reach > 0.0:
        ax.set_ylim(-reach, reach)
    dress(ax, "Residuals of the fit, run by run", "Sample", f"Record minus model ({unit})")
    ax.legend(loc="upper left", frameon=False, fontsize="small")
    return ax
