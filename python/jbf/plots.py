"""Pictures of a comparison, a diagnosis and a run, on matplotlib axes.

Every function draws on the axes it is given, or on a new figure's, and returns them; none opens
a window. `axes[0].figure.savefig(...)` writes the picture. Colours are Okabe and Ito's, which
people who confuse red and green can tell apart.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from jbf.axes import all_axes
from jbf.bin_axes import bin_axis
from jbf.comparison import Comparison, Failure
from jbf.errors import InputError
from jbf.words import number, step_name

if TYPE_CHECKING:
    from jbf.diagnosis.result import Diagnosis

Array = npt.NDArray[np.float64]

MEASURED, MODEL, BEFORE, NOISE = "#8c8c8c", "#0072b2", "#d55e00", "#009e73"
SECOND = "#cc79a7"
MOST_DOTS = 1500


def _axes(
    axes: Sequence[Axes] | None, rows: int, columns: int, size: tuple[float, float]
) -> list[Axes]:
    """The axes given, or those of a new figure."""
    wanted = rows * columns
    if axes is None:
        figure = Figure(figsize=size, layout="constrained")
        found = list(np.ravel(figure.subplots(rows, columns)))
    else:
        found = list(np.ravel(np.asarray(axes, dtype=object)))
    if len(found) != wanted:
        raise InputError(
            problem=f"{len(found)} axes were given", mend=f"this picture needs {wanted}"
        )
    return found


def _dress(ax: Axes, title: str, x: str, y: str) -> None:
    ax.set_title(title, loc="left", fontsize="medium")
    ax.set_xlabel(x)
    ax.set_ylabel(y)
    ax.grid(alpha=0.25)
    ax.spines[["top", "right"]].set_visible(False)


def most_telling(comparison: Comparison, other: Comparison | None = None) -> int:
    """The run in which the model fails most, or in which two models differ most."""
    if other is None:
        return int(np.argmax([r.rms_n for r in comparison.runs]))
    gaps = [
        float(np.mean((a - b)[p.trusted] ** 2))
        for a, b, p in zip(
            comparison.predictions, other.predictions, comparison.campaign.prepared, strict=True
        )
    ]
    return int(np.argmax(gaps)) if max(gaps) > 0.0 else most_telling(comparison)


def _friction_speed(ax: Axes, comparison: Comparison, index: int, colour: str, title: str) -> None:
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
    # A line through a sample whose sign of motion nobody knows would show a jump that is not
    # the model's.
    shown = np.where(p.trusted, comparison.predictions[index], np.nan)
    ax.plot(speed, shown, color=colour, linewidth=1.3, label="model")
    _dress(ax, title, "Surface speed (m/s)", "Friction of one bearing (N)")
    ax.legend(loc="upper left", frameon=False, markerscale=2)


def _pattern(comparison: Comparison, axis: str | None) -> Failure:
    """Bin means of a comparison's residual along an axis, also where it does not fail."""
    for failure in comparison.failures:
        if axis in (None, failure.axis):
            return failure
    campaign = comparison.campaign
    u_tr = float(comparison.model.values[1])
    found = {a.axis: a for a in all_axes(campaign, u_tr)}
    binned = found.get(axis or "velocity", found["velocity"])
    trusted = np.concatenate([p.trusted for p in campaign.prepared])
    bins = np.concatenate(binned.bins)
    known = trusted & (bins >= 0)
    r = np.concatenate(comparison.residuals)[known]
    counts = np.bincount(bins[known], minlength=len(binned.labels))
    means = np.bincount(bins[known], weights=r, minlength=len(binned.labels))
    means = means / np.maximum(counts, 1)
    return Failure(binned.axis, "no pattern", 0.0, binned.labels, means, counts)


def _bin_means(ax: Axes, failure: Failure, colour: str, label: str = "") -> None:
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
        crowded = max(map(len, place.ticks)) * len(place.ticks) > 60
        ax.set_xticks(
            range(len(place.ticks)),
            labels=list(place.ticks),
            rotation=30 if crowded else 0,
            ha="right" if crowded else "center",
            fontsize="small",
        )
    _dress(ax, f"Residual along {failure.axis}", place.name, "Record minus model (N)")


def _noise_band(ax: Axes, noise_n: float) -> None:
    ax.axhspan(-noise_n, noise_n, color=NOISE, alpha=0.15, label=f"noise, ±{number(noise_n, 2)} N")
    ax.axhline(0.0, color="black", linewidth=0.6)


def _legend_on_top(ax: Axes, columns: int = 2) -> None:
    """A legend in room made for it above the data."""
    low, high = ax.get_ylim()
    ax.set_ylim(low, high + 0.28 * (high - low))
    ax.legend(loc="upper left", frameon=False, fontsize="small", ncols=columns)


def plot_comparison(comparison: Comparison, axes: Sequence[Axes] | None = None) -> list[Axes]:
    """Friction against speed in the worst run, and the residual along its worst axis.

    Parameters
    ----------
    comparison
        From `jbf.compare`.
    axes
        Two matplotlib axes to draw on; a new figure's by default.
    """
    left, right = _axes(axes, 1, 2, (10.0, 4.2))
    index = most_telling(comparison)
    _friction_speed(left, comparison, index, MODEL, f"Run {comparison.runs[index].name}")
    _noise_band(right, comparison.noise_n)
    failure = _pattern(comparison, None)
    _bin_means(right, failure, MODEL)
    if not comparison.failures:
        right.set_title("No pattern in the residual", loc="left", fontsize="medium")
    _legend_on_top(right)
    return [left, right]


def _error_falling(ax: Axes, diagnosis: Diagnosis) -> None:
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
    _dress(ax, "The error falling", "Model", "RMS of record minus model (N)")
    ax.legend(loc="best", frameon=False)


def plot_diagnosis(diagnosis: Diagnosis, axes: Sequence[Axes] | None = None) -> list[Axes]:
    """The error falling, the residual before and after, and friction against speed.

    The last of the four axes shows the final model, or, where no effect was added, the residual
    of the run in time.

    Parameters
    ----------
    diagnosis
        From `jbf.diagnose`.
    axes
        Four matplotlib axes to draw on; a new figure's by default.
    """
    falling, residual, first, last = _axes(axes, 2, 2, (10.0, 8.0))
    before, after = diagnosis.before, diagnosis.after
    _error_falling(falling, diagnosis)
    pattern = _pattern(before, None)
    _noise_band(residual, before.noise_n)
    _bin_means(residual, pattern, BEFORE, "bare law" if diagnosis.effects else "")
    index = most_telling(before, after)
    name = before.runs[index].name
    _friction_speed(first, before, index, BEFORE, f"Bare law, run {name}")
    if diagnosis.effects:
        _bin_means(residual, _pattern(after, pattern.axis), MODEL, "final")
        _friction_speed(last, after, index, MODEL, f"Final model, run {name}")
        last.set_ylim(first.get_ylim())
    else:
        _residual_in_time(last, before, index)
    _legend_on_top(residual)
    return [falling, residual, first, last]


def _residual_in_time(ax: Axes, comparison: Comparison, index: int) -> None:
    p = comparison.campaign.prepared[index]
    shown = np.where(p.trusted, comparison.residuals[index], np.nan)
    _noise_band(ax, comparison.noise_n)
    ax.plot(p.run.time_s, shown, color=MODEL, linewidth=0.6, label="record minus model")
    _dress(ax, f"Residual, run {p.run.name}", "Time (s)", "Record minus model (N)")
    _legend_on_top(ax)


def plot_run(
    comparison: Comparison, run: int | str | None = None, axes: Sequence[Axes] | None = None
) -> list[Axes]:
    """One run in time: friction measured and modelled, and below it the residual.

    Parameters
    ----------
    comparison
        From `jbf.compare`.
    run
        Its index or name; the run with the largest error by default.
    axes
        Two matplotlib axes to draw on; a new figure's by default.

    Raises
    ------
    InputError
        The comparison has no such run.
    """
    top, bottom = _axes(axes, 2, 1, (10.0, 6.0))
    index = _index(comparison, run)
    p = comparison.campaign.prepared[index]
    time_s = p.run.time_s
    top.plot(time_s, p.friction_n, ".", color=MEASURED, markersize=2, label="measured")
    top.plot(time_s, comparison.predictions[index], color=MODEL, linewidth=1.0, label="model")
    _dress(top, f"Run {p.run.name}", "Time (s)", "Friction of one bearing (N)")
    top.yaxis.set_major_locator(MaxNLocator(6))
    _legend_on_top(top)
    _residual_in_time(bottom, comparison, index)
    bottom.sharex(top)
    return [top, bottom]


def _index(comparison: Comparison, run: int | str | None) -> int:
    names = [r.name for r in comparison.runs]
    if run is None:
        return most_telling(comparison)
    if isinstance(run, str) and run in names:
        return names.index(run)
    if isinstance(run, int) and -len(names) <= run < len(names):
        return run % len(names)
    raise InputError(problem=f"there is no run {run}", mend=f"known: {', '.join(names)}")
