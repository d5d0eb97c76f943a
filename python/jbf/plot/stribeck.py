"""Stribeck curves: mean friction against speed, in both directions, of record, model and law."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from jbf.errors import InputError
from jbf.plot.runs import axes_words
from jbf.plot.style import INK, MEASURED, MODEL, dress, one_axes

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from jbf.comparison.comparison import Comparison
    from jbf.comparison.over_speed import OverSpeed


def stribeck(comparison: Comparison, *, ax: Axes | None = None) -> Axes:
    """Plot the Stribeck curve: mean friction against speed of all runs, for record and model.

    Model terms that are not friction are subtracted. The plot shows the means of all runs with
    their scatter, and the model's means at the same samples. The steady curve of the law and the
    limits of its regimes are added.
    """
    from jbf.comparison.over_speed import friction_over_speed

    ax = one_axes(ax)
    branches = friction_over_speed(comparison)
    for number, branch in enumerate(branches):
        ax.errorbar(
            branch.speed_m_s,
            branch.measured_n,
            yerr=branch.scatter_n,
            fmt="o",
            color=MEASURED,
            markerfacecolor=MEASURED if branch.way > 0.0 else "white",
            markersize=5,
            elinewidth=0.8,
            label=None if number else "measured, with standard deviation",
        )
        name = None if number else "model at the same samples"
        ax.plot(branch.speed_m_s, branch.modelled_n, "-", color=MODEL, linewidth=1.5, label=name)
    limits = ax.get_ylim()
    _steady(ax, comparison, branches)
    ax.set_ylim(limits)
    _regimes(ax, comparison)
    ax.axhline(0.0, color=INK, linewidth=0.6)
    dress(ax, "Friction over speed, means of all runs", *axes_words(comparison))
    ax.legend(loc="upper left", frameon=False, fontsize="small")
    return ax


def _steady(ax: Axes, comparison: Comparison, branches: tuple[OverSpeed, ...]) -> None:
    """Plot the steady curve of the law under the rig's load, if the rig has the required load."""
    for number, branch in enumerate(branches):
        top_speed = float(np.abs(branch.speed_m_s).max())
        x = branch.way * np.geomspace(
            max(float(np.abs(branch.speed_m_s).min()), 1e-4 * top_speed), top_speed, 300
        )
        try:
            steady = comparison.model.steady_friction(x)
        except InputError:
            return
        name = None if number else "base law, steady state"
        ax.plot(x, steady, ":", color=INK, linewidth=1.2, label=name)


def _regimes(ax: Axes, comparison: Comparison) -> None:
    """Mark the speeds at which the lubrication regimes of the law begin."""
    from jbf.comparison.over_speed import regimes

    left, right = ax.get_xlim()
    for speed, name in regimes(comparison.model):
        for direction in (1.0, -1.0):
            if left < direction * speed < right:
                ax.axvline(direction * speed, color=INK, linewidth=0.8, linestyle=(0, (2, 4)))
        if speed < right:
            ax.text(
                speed, 0.02, f" {name}", transform=ax.get_xaxis_transform(), fontsize="small",
                color=INK,
            )  # fmt: skip
