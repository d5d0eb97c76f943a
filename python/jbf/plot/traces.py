"""Time series of one run: measured and modelled friction."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from jbf.plot.runs import axes_words, index_of
from jbf.plot.style import MEASURED, MODEL, dress, legend_on_top, one_axes

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from jbf.comparison.comparison import Comparison


def record_and_model(
    comparison: Comparison, run: int | str | None = None, *, ax: Axes | None = None
) -> Axes:
    """Plot measured and modelled friction of one run in time.

    The default is the run with the largest error.
    """
    from matplotlib.ticker import MaxNLocator

    ax = one_axes(ax, (10.0, 3.0))
    index = index_of(comparison, run)
    p = comparison.campaign.prepared[index]
    time_s = p.run.time_s
    measured: dict[str, Any] = {"markersize": 2, "label": "measured", "rasterized": True}
    ax.plot(time_s, p.friction, ".", color=MEASURED, **measured)
    modelled = comparison.predictions[index]
    ax.plot(time_s, modelled, color=MODEL, linewidth=1.0, label="model", rasterized=True)
    dress(ax, f"Run {p.run.name}", "Time (s)", axes_words(comparison)[1])
    ax.yaxis.set_major_locator(MaxNLocator(6))
    legend_on_top(ax)
    return ax
