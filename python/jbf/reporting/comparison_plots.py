"""Pictures of a comparison and of one run in it, on matplotlib axes.

Every function draws on the axes it is given, or on a new figure's, and returns them; none opens
a window. `axes[0].figure.savefig(...)` writes the picture.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from jbf.plot.loops import loops
from jbf.plot.residuals import residual_along, residual_in_time
from jbf.plot.runs import index_of, most_telling
from jbf.plot.style import axes_or_new
from jbf.plot.traces import record_and_model

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from jbf.comparison.comparison import Comparison


def plot_comparison(comparison: Comparison, axes: Sequence[Axes] | None = None) -> list[Axes]:
    """Friction against speed in the worst run, and the residual along its worst axis.

    Parameters
    ----------
    comparison
        From `jbf.compare`.
    axes
        Two matplotlib axes to draw on; a new figure's by default.
    """
    left, right = axes_or_new(axes, 1, 2, (10.0, 4.2))
    loops(comparison, most_telling(comparison), ax=left)
    residual_along(comparison, ax=right)
    if not comparison.failures:
        right.set_title("No pattern in the residual", loc="left", fontsize="medium")
    return [left, right]


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
    index = index_of(comparison, run)
    top, bottom = axes_or_new(axes, 2, 1, (10.0, 6.0))
    record_and_model(comparison, index, ax=top)
    residual_in_time(comparison, index, ax=bottom)
    bottom.sharex(top)
    return [top, bottom]
