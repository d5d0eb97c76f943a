"""The single pictures that `jbf.plots` puts together, each drawn on one matplotlib axes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.ticker import AutoLocator, MaxNLocator

from jbf.comparison.axes import all_axes
from jbf.comparison.comparison import Comparison, Failure
from jbf.models.catalogue import transition_speed
from jbf.reporting.bin_axes import bin_axis
from jbf.reporting.words import number, step_name

if TYPE_CHECKING:
    from jbf.diagnosis.result import Diagnosis

Array = npt.NDArray[np.float64]

# Okabe and Ito's colours: people who confuse red and green can tell them apart.
MEASURED, MODEL, BEFORE, NOISE = "#8c8c8c", "#0072b2", "#d55e00", "#009e73"
MOST_DOTS = 1500


def plain(words: str) -> str:
    """Words that matplotlib takes for no formula, whatever a run is called."""
    return words.replace("$", r"\$")


def dress(ax: Axes, title: str, x: str, y: str) -> None:
    """Title, names of the axes, grid."""
    ax.set_title(plain(title), loc="left", fontsize="medium")
    ax.set_xlabel(x)
    ax.set_ylabel(y)
    if isinstance(ax.xaxis.get_major_locator(), AutoLocator):
        ax.xaxis.set_major_locator(MaxNLocator(6))
    ax.grid(alpha=0.25)
    ax.spines[["top", "right"]].set_visible(False)


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
    dress(ax, title, "Surface speed (m/s)", "Friction of one bearing (N)")
    ax.legend(loc="upper left", frameon=False, markerscale=2)


def pattern_along(comparison: Comparison, axis: str | None) -> Failure:
    """Bin means of a comparison's residual along an axis, also where it does not fail."""
    for failure in comparison.failures:
        if axis in (None, failure.axis):
            return failure
    campaign = comparison.campaign
    model = comparison.model
    u_tr = transition_speed(model.law, model.values.tolist())
    found = {a.axis: a for a in all_axes(campaign, u_tr)}
    binned = found.get(axis or "velocity", found["velocity"])
    bins = comparison.samples.flat(binned.bins)
    known = bins >= 0
    r = comparison.samples.flat(comparison.residuals)[known]
    counts = np.bincount(bins[known], minlength=len(binned.labels))
    sums = np.bincount(bins[known], weights=r, minlength=len(binned.labels))
    means = sums / np.maximum(counts, 1)
    return Failure(binned.axis, "no pattern", 0.0, binned.labels, means, counts)


def bin_means(ax: Axes, failure: Failure, colour: str, label: str = "") -> None:
    """Means of record minus model in the bins, a line for each direction of motion."""
    place = bin_axis(failure)
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
    dress(ax, f"Residual along {failure.axis}", place.name, "Record minus model (N)")


def noise_band(ax: Axes, noise_n: float) -> None:
    """One standard deviation of the noise to either side of zero."""
    ax.axhspan(-noise_n, noise_n, color=NOISE, alpha=0.15, label=f"noise, ±{number(noise_n, 2)} N")
    ax.axhline(0.0, color="black", linewidth=0.6)


def legend_on_top(ax: Axes, columns: int = 2) -> None:
    """A legend in room made for it above the data."""
    low, high = ax.get_ylim()
    ax.set_ylim(low, high + 0.28 * (high - low))
    ax.legend(loc="upper left", frameon=False, fontsize="small", ncols=columns)


def error_falling(ax: Axes, diagnosis: Diagnosis) -> None:
    """Fit and held-out error of each step of the ledger, and the noise floor."""
    steps = diagnosis.steps
    x = np.arange(len(steps))
    ax.axhline(steps[-1].noise_n, color=NOISE, linestyle="--", linewidth=1.5, label="noise floor")
    ax.plot(x, [s.rms_n for s in steps], "o-", color=MODEL, label="fit")
    ax.plot(
        x, [s.holdout_rms_n for s in steps], "s--", color=BEFORE, markerfacecolor="white",
        label="held out",
    )  # fmt: skip
    names = [step_name(diagnosis, i).replace("_", " ") for i in range(len(steps))]
    slanted = len(steps) > 3
    ax.set_xticks(
        x, labels=names, rotation=20 if slanted else 0, ha="right" if slanted else "center"
    )
    ax.set_xlim(-0.5, len(steps) - 0.5)
    highest = max(max(s.rms_n, s.holdout_rms_n, s.noise_n) for s in steps)
    ax.set_ylim(0.0, 1.15 * highest)
    dress(ax, "The error falling", "Model", "RMS of record minus model (N)")
    ax.legend(loc="best", frameon=False)


def residual_in_time(ax: Axes, comparison: Comparison, index: int) -> None:
    """Record minus model of one run, where the sign of the motion is known."""
    p = comparison.campaign.prepared[index]
    shown = np.where(comparison.samples.counted[index], comparison.residuals[index], np.nan)
    noise_band(ax, comparison.noise_n)
    ax.plot(p.run.time_s, shown, ".", color=MODEL, markersize=2, label="record minus model")
    dress(ax, f"Residual, run {p.run.name}", "Time (s)", "Record minus model (N)")
    legend_on_top(ax)
