"""Figures of planned runs and of simulation studies."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from jbf.plot.power import power
from jbf.plot.style import MODEL, axes_or_new, dress, plain

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from jbf.diagnosis.check import Check
    from jbf.diagnosis.experiment_design.plan import Plan
    from jbf.diagnosis.power.planned_runs import PlannedPower


def plot_planned_power(planned: PlannedPower, axes: Sequence[Axes] | None = None) -> list[Axes]:
    """Plot the power curves of effects in planned runs, on one axes."""
    (ax,) = axes_or_new(axes, 1, 1, (7.0, 4.4))
    return [power(planned, ax=ax)]


def plot_plan(plan: Plan, axes: Sequence[Axes] | None = None) -> list[Axes]:
    """Plot the power curves of effects in the runs of a plan, on one axes."""
    return plot_planned_power(plan.planned, axes)


def plot_check(check: Check, axes: Sequence[Axes] | None = None) -> list[Axes]:
    """Plot the simulated success rates with their confidence intervals, on one axes."""
    rates = check.rates
    (ax,) = axes_or_new(axes, 1, 1, (7.0, 1.2 + 0.4 * len(rates)))
    for row, rate in enumerate(rates):
        share = 100.0 * rate.count / rate.campaigns
        interval = [[share - 100.0 * rate.low], [100.0 * rate.high - share]]
        ax.errorbar(share, row, xerr=interval, fmt="o", color=MODEL, capsize=3, markersize=5)
    ax.set_yticks(range(len(rates)), labels=[plain(r.what) for r in rates], fontsize="small")
    ax.set_ylim(len(rates) - 0.4, -0.6)
    ax.set_xlim(-2.0, 102.0)
    dress(ax, "Simulated campaigns", "Rate with its 95 % interval (%)", "")
    return [ax]
