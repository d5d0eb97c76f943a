"""Figures of a comparison and of one of its runs, on matplotlib axes.

Every function draws on the given axes, or on those of a new figure, and returns them. No function
opens a window. `axes[0].figure.savefig(...)` saves the figure.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite
from typing import TYPE_CHECKING

from jbf.plot.loops import loops
from jbf.plot.residuals import residual_along, residual_in_time
from jbf.plot.runs import index_of, largest_error_run
from jbf.plot.style import INK, MODEL, axes_or_new, dress, plain
from jbf.plot.traces import record_and_model

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from jbf.comparison.comparison import Comparison
    from jbf.comparison.model_comparison import ModelComparison


def plot_comparison(comparison: Comparison, axes: Sequence[Axes] | None = None) -> list[Axes]:
    """Plot friction against speed in the worst run, and the residual along its worst axis.

    Parameters
    ----------
    comparison
        Result of `jbf.compare`.
    axes
        Two matplotlib axes to draw on. Default: those of a new figure.
    """
    left, right = axes_or_new(axes, 1, 2, (10.0, 4.2))
    loops(comparison, largest_error_run(comparison), ax=left)
    residual_along(comparison, ax=right)
    if not comparison.failures:
        right.set_title("No pattern in the residual", loc="left", fontsize="medium")
    return [left, right]


def plot_run(
    comparison: Comparison, run: int | str | None = None, axes: Sequence[Axes] | None = None
) -> list[Axes]:
    """Plot one run in time: measured and modelled friction, and the residual below.

    Parameters
    ----------
    comparison
        Result of `jbf.compare`.
    run
        Index or name of the run. Default: the run with the largest error.
    axes
        Two matplotlib axes to draw on. Default: those of a new figure.

    Raises
    ------
    InputError
        The comparison has no such run.
    """
    index = index_of(comparison, run)
    top, bottom = axes_or_new(axes, 2, 1, (10.0, 6.0))
    record_and_model(comparison, index, ax=top)
    residual_in_time(comparison, index, ax=bottom)
    bottom.sharex(top)
    return [top, bottom]


def plot_model_comparison(
    compared: ModelComparison, axes: Sequence[Axes] | None = None
) -> list[Axes]:
    """Plot the RMS of each model minus that of the best one, with standard errors, on one axes."""
    models = compared.models
    (ax,) = axes_or_new(axes, 1, 1, (7.0, 1.2 + 0.5 * len(models)))
    for row, m in enumerate(models):
        error = m.stderr if isfinite(m.stderr) else 0.0
        ax.errorbar(m.difference, row, xerr=error, fmt="o", color=MODEL, capsize=3, markersize=5)
    ax.set_yticks(range(len(models)), labels=[plain(m.name) for m in models], fontsize="small")
    ax.set_ylim(len(models) - 0.4, -0.6)
    ax.axvline(0.0, color=INK, linewidth=0.6)
    unit = compared.force_unit
    dress(ax, "Difference to the best model", f"RMS minus that of the best ({unit})", "")
    return [ax]
