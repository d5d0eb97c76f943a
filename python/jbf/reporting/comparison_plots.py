"""Pictures of a comparison and of one run in it, on matplotlib axes.

Every function draws on the axes it is given, or on a new figure's, and returns them; none opens
a window. `axes[0].figure.savefig(...)` writes the picture.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from jbf.comparison.comparison import Comparison
from jbf.errors import InputError
from jbf.reporting.plot_parts import (
    MEASURED,
    MODEL,
    axes_or_new,
    dress,
    legend_on_top,
    noise_band,
)
from jbf.reporting.residual_parts import (
    draw_bin_means,
    friction_and_speed,
    friction_speed,
    means_along,
    residual_in_time,
)


def most_telling(comparison: Comparison, other: Comparison | None = None) -> int:
    """The run in which the model fails most, or in which two models differ most."""
    if other is None:
        return int(np.argmax([r.rms_n for r in comparison.runs]))
    gaps = [
        float(np.mean((a - b)[counted] ** 2))
        for a, b, counted in zip(
            comparison.predictions, other.predictions, comparison.samples.counted, strict=True
        )
    ]
    return int(np.argmax(gaps)) if max(gaps) > 0.0 else most_telling(comparison)


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
    index = most_telling(comparison)
    friction_speed(left, comparison, index, MODEL, f"Run {comparison.runs[index].name}")
    said = comparison.model.rig.quantities
    noise_band(right, comparison.noise_n, unit=said.force)
    failure = means_along(comparison, None)
    draw_bin_means(right, failure, MODEL, said)
    if not comparison.failures:
        right.set_title("No pattern in the residual", loc="left", fontsize="medium")
    legend_on_top(right)
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
    top, bottom = axes_or_new(axes, 2, 1, (10.0, 6.0))
    index = _index(comparison, run)
    p = comparison.campaign.prepared[index]
    time_s = p.run.time_s
    top.plot(time_s, p.friction_n, ".", color=MEASURED, markersize=2, label="measured")
    top.plot(time_s, comparison.predictions[index], color=MODEL, linewidth=1.0, label="model")
    dress(top, f"Run {p.run.name}", "Time (s)", friction_and_speed(comparison)[1])
    top.yaxis.set_major_locator(MaxNLocator(6))
    legend_on_top(top)
    residual_in_time(bottom, comparison, index)
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
