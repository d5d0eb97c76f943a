"""Figures of fitted parameters with their intervals, and of the residuals of the fit."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from jbf.plot.parameters import height, intervals, parameters
from jbf.plot.residuals import residuals_in_a_row
from jbf.plot.style import axes_or_new

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from jbf.estimation.bootstrap import Bootstrap
    from jbf.estimation.fit import Fit
    from jbf.estimation.trajectory_fit import TrajectoryFit


def plot_fit(fit: Fit, axes: Sequence[Axes] | None = None) -> list[Axes]:
    """Plot the fitted parameters with their confidence intervals, and the residuals.

    Parameters
    ----------
    fit
        Result of `jbf.fit`.
    axes
        Two matplotlib axes to draw on. Default: those of a new figure.
    """
    left, right = axes_or_new(axes, 1, 2, (10.0, max(height(fit.parameters), 4.2)))
    parameters(fit, ax=left)
    residuals_in_a_row(fit, ax=right)
    return [left, right]


def plot_bootstrap(bootstrap: Bootstrap, axes: Sequence[Axes] | None = None) -> list[Axes]:
    """Plot the parameters with bootstrap intervals and all bootstrap estimates, on one axes."""
    (ax,) = axes_or_new(axes, 1, 1, (7.0, height(bootstrap.values)))
    parameters(bootstrap.fit, answers=bootstrap.values, ax=ax)
    ax.set_title("Parameters with estimates from repeated fits", loc="left", fontsize="medium")
    return [ax]


def plot_trajectory_fit(fit: TrajectoryFit, axes: Sequence[Axes] | None = None) -> list[Axes]:
    """Plot the parameters of a trajectory fit with their intervals, on one axes."""
    (ax,) = axes_or_new(axes, 1, 1, (7.0, height(fit.parameters)))
    intervals(fit.parameters, ax=ax)
    return [ax]
