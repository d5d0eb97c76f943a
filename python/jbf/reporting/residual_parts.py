"""Single pictures of a comparison, each drawn on one matplotlib axes: friction against speed, means
of the residual in bins, the residual in time."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from jbf.comparison import patterns
from jbf.comparison.axes import all_axes
from jbf.comparison.bins import Binned
from jbf.comparison.comparison import Comparison
from jbf.comparison.patterns import Failure
from jbf.models.catalogue import transition_speed
from jbf.records.quantities import Quantities
from jbf.reporting.bin_axes import bin_axis
from jbf.reporting.plot_parts import MEASURED, MODEL, dress, legend_on_top, noise_band, plain

MOST_DOTS = 1500


def friction_and_speed(comparison: Comparison) -> tuple[str, str]:
    """Names of the axes: speed, friction."""
    said = comparison.model.rig.quantities
    return f"{said.velocity} ({said.speed})", f"{said.friction} ({said.force})"


def friction_speed(ax: Axes, comparison: Comparison, index: int, colour: str, title: str) -> None:
    """One run: friction against speed, measured as dots and modelled as a line."""
    p = comparison.campaign.prepared[index]
    speed = p.motion.velocity_m_s
    stride = max(len(speed) // MOST_DOTS, 1)
    ax.plot(
        speed[::stride],
        p.friction_n[::stride],
        ".",
        color=MEASURED,
        markersize=3,
        alpha=0.6,
        label="measured",
        rasterized=True,
    )
    # A line through a reversal, whose instant no sample tells, would show a slope that is not
    # the model's.
    turns = np.append(np.sign(speed[1:]) * np.sign(speed[:-1]) < 0, False)
    shown = np.where(
        comparison.samples.counted[index] & ~turns, comparison.predictions[index], np.nan
    )
    ax.plot(speed, shown, color=colour, linewidth=1.3, label="model")
    dress(ax, title, *friction_and_speed(comparison))
    ax.legend(loc="upper left", frameon=False, markerscale=2)


def means_along(comparison: Comparison, axis: str | None) -> Failure:
    """Bin means of a comparison's residual along an axis, also where it does not fail."""
    for failure in comparison.failures:
        if axis in (None, failure.axis):
            return failure
    campaign = comparison.campaign
    model = comparison.model
    u_tr = transition_speed(model.law, model.values.tolist())
    found: dict[str, Binned] = {a.axis: a for a in all_axes(campaign, u_tr)}
    binned = found.get(axis or "velocity", found["velocity"])
    means, counts = patterns.bin_means(binned, comparison.samples, comparison.residuals)
    return Failure(binned.axis, "no pattern", 0.0, binned.bins, means, counts)


def draw_bin_means(
    ax: Axes, failure: Failure, colour: str, said: Quantities, label: str = ""
) -> None:
    """Means of record minus model in the bins, a line for each direction of motion."""
    place = bin_axis(failure, said)
    directions = list(dict.fromkeys(place.series))
    for direction, marker in zip(directions, "os", strict=False):
        own = np.array([s == direction for s in place.series]) & (failure.counts > 0)
        order = np.argsort(place.x[own])
        name = ", ".join(x for x in (label, direction) if x)
        ax.plot(
            place.x[own][order],
            failure.means_n[own][order],
            color=colour,
            marker=marker,
            markerfacecolor=colour if marker == "o" else "white",
            markersize=5,
            linewidth=1.0,
            linestyle="-" if marker == "o" else "--",
            label=name or "mean in the bin",
        )
    if place.ticks:
        longest = max(len(line) for tick in place.ticks for line in tick.split("\n"))
        crowded = longest * len(place.ticks) > 70
        ax.set_xticks(
            range(len(place.ticks)),
            labels=list(map(plain, place.ticks)),
            rotation=30 if crowded else 0,
            ha="right" if crowded else "center",
            fontsize="small",
        )
    dress(ax, f"Residual along {failure.axis}", place.name, f"Record minus model ({said.force})")


def residual_in_time(ax: Axes, comparison: Comparison, index: int) -> None:
    """Record minus model of one run, where the sign of the motion is known."""
    p = comparison.campaign.prepared[index]
    shown = np.where(comparison.samples.counted[index], comparison.residuals[index], np.nan)
    unit = comparison.model.rig.quantities.force
    noise_band(ax, comparison.noise_n, unit=unit)
    ax.plot(p.run.time_s, shown, ".", color=MODEL, markersize=2, label="record minus model")
    dress(ax, f"Residual, run {p.run.name}", "Time (s)", f"Record minus model ({unit})")
    legend_on_top(ax)
