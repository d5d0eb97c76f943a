"""Pictures of fitted parameters: each with its interval, and what the fit leaves of the record."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from types import MappingProxyType

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter

from jbf.estimation.bootstrap import Bootstrap
from jbf.estimation.fit import Fit
from jbf.estimation.trajectory_fit import TrajectoryFit
from jbf.models.parameter_units import shown
from jbf.models.parameter_value import ParameterValue
from jbf.reporting.plot_parts import BEFORE, MEASURED, MODEL, axes_or_new, dress, noise_band, plain
from jbf.reporting.words import value_and_error

Array = npt.NDArray[np.float64]

LINEAR_PERCENT = 1.0
"""Errors of a few permille and of half the value stand on one axis: linear up to so many percent,
logarithmic beyond."""
WIDEST_PERCENT = 300.0
MOST_DOTS = 4000
NONE: Mapping[str, tuple[str, str]] = MappingProxyType({})


def parameter_intervals(
    ax: Axes,
    parameters: Mapping[str, ParameterValue],
    answers: Mapping[str, Array] | None = None,
    called: Mapping[str, tuple[str, str]] = NONE,
) -> None:
    """Each parameter's standard error in percent of its value, and answers of repeated fits.

    A parameter without an error, or at zero, is an open mark. `called` has shown names and units.
    """
    names = list(parameters)
    largest = 2.0 * LINEAR_PERCENT
    for row, name in enumerate(names):
        p = parameters[name]
        if p.stderr is None or p.value == 0.0 or not math.isfinite(p.value):
            ax.plot(0.0, row, "o", color=MODEL, markerfacecolor="white", markersize=5)
            continue
        percent = 100.0 * abs(p.stderr / p.value)
        if answers is not None:
            off = 100.0 * (answers[name] / p.value - 1.0)
            ax.plot(off, np.full(len(off), row), "|", color=MEASURED, markersize=9)
        ax.errorbar(0.0, row, xerr=percent, fmt="o", color=MODEL, capsize=3, markersize=5)
        largest = max(largest, 1.5 * percent)
    labels = []
    for name in names:
        shown_name, unit = called.get(name, (name, ""))
        labels.append(f"{shown_name}\n{_value_words(parameters[name])} {unit}".rstrip())
    ax.set_yticks(range(len(names)), labels=list(map(plain, labels)), fontsize="small")
    ax.set_ylim(len(names) - 0.4, -0.6)
    ax.axvline(0.0, color="black", linewidth=0.6)
    ax.set_xscale("symlog", linthresh=LINEAR_PERCENT)
    ax.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
    reach = min(largest, WIDEST_PERCENT)
    ax.set_xlim(-reach, reach)
    dress(ax, "Parameters with standard errors", "Off the value (%)", "")


def _called(fit: Fit) -> Mapping[str, tuple[str, str]]:
    """Names of a drive's parameters and their units; of any other rig the names tell the units."""
    model = fit.model
    if model.rig.drive is None:
        return NONE
    return shown(model.law, model.effects, model.rig.quantities)


def _value_words(p: ParameterValue) -> str:
    value, error = value_and_error(p)
    return f"{value} ± {error}" if error else value


def residuals_in_a_row(ax: Axes, fit: Fit) -> None:
    """Record minus model, run after run."""
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


def _height(parameters: Mapping[str, object]) -> float:
    return 1.6 + 0.5 * len(parameters)


def plot_fit(fit: Fit, axes: Sequence[Axes] | None = None) -> list[Axes]:
    """The parameters with their intervals, and the residuals.

    Parameters
    ----------
    fit
        From `jbf.fit`.
    axes
        Two matplotlib axes to draw on; a new figure's by default.
    """
    left, right = axes_or_new(axes, 1, 2, (10.0, max(_height(fit.parameters), 4.2)))
    parameter_intervals(left, fit.parameters, called=_called(fit))
    residuals_in_a_row(right, fit)
    return [left, right]


def plot_bootstrap(found: Bootstrap, axes: Sequence[Axes] | None = None) -> list[Axes]:
    """The parameters with their intervals, and the answers that these come from; one axes."""
    (ax,) = axes_or_new(axes, 1, 1, (7.0, _height(found.values)))
    parameter_intervals(ax, found.fit.parameters, found.values, _called(found.fit))
    ax.set_title("Parameters, and the answers of repeated fits", loc="left", fontsize="medium")
    return [ax]


def plot_trajectory_fit(fit: TrajectoryFit, axes: Sequence[Axes] | None = None) -> list[Axes]:
    """The parameters with their intervals; one axes."""
    (ax,) = axes_or_new(axes, 1, 1, (7.0, _height(fit.parameters)))
    parameter_intervals(ax, fit.parameters)
    return [ax]
