"""Figures of control-loop runs: response, error, friction and learned quantities per scheme."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from jbf.plot.control import TRACES, control_trace
from jbf.plot.style import axes_or_new

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from jbf.control.run import Result


def plot_runs(results: Sequence[Result], figure: Figure | None = None) -> Figure:
    """Plot several control-loop runs, one column per scheme.

    The rows are response, error, friction against speed, friction in time, and learned quantities.
    """
    from matplotlib.figure import Figure

    n, rows = len(results), len(TRACES)
    drawing = Figure(figsize=(4.2 * n, 12.5), layout="constrained") if figure is None else figure
    grid = drawing.subplots(rows, n, squeeze=False)
    for column, result in enumerate(results):
        _column([grid[row][column] for row in range(rows)], result, first=column == 0)
    return drawing


def plot_run_of_loop(run: Result, axes: Sequence[Axes] | None = None) -> list[Axes]:
    """Plot one control-loop run on five axes.

    The axes are response, error, friction against speed, friction in time, and learned quantities.
    """
    run_axes = axes_or_new(axes, len(TRACES), 1, (7.0, 12.5))
    _column(run_axes, run, first=True)
    return run_axes


def _column(axes: Sequence[Axes], run: Result, *, first: bool) -> None:
    for ax, trace in zip(axes, TRACES, strict=True):
        control_trace(run, trace, ax=ax, named=first)
