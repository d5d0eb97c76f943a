"""Figure of a diagnosis: error per step, residual before and after, friction against speed."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from jbf.plot.ledger import ledger
from jbf.plot.loops import loops
from jbf.plot.residuals import draw_means, means_along, residual_in_time
from jbf.plot.runs import largest_error_run
from jbf.plot.style import BEFORE, MODEL, axes_or_new, legend_above, legend_on_top, noise_band

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from jbf.comparison.patterns import Failure
    from jbf.diagnosis.result import Diagnosis


def plot_diagnosis(diagnosis: Diagnosis, axes: Sequence[Axes] | None = None) -> list[Axes]:
    """Plot the error per step, the residual before and after, and friction against speed.

    The last of the four axes shows the final model. If no effect was added, it shows the residual
    of the run in time.

    Parameters
    ----------
    diagnosis
        Result of `jbf.diagnose`.
    axes
        Four matplotlib axes to draw on. Default: those of a new figure.
    """
    falling, residual, first, last = axes_or_new(axes, 2, 2, (11.0, 8.0))
    before, after = diagnosis.before, diagnosis.after
    ledger(diagnosis, ax=falling)
    before_and_after(diagnosis, means_along(before, None), residual)
    index = largest_error_run(before, after)
    name = before.runs[index].name
    loops(before, index, ax=first, colour=BEFORE, title=f"Base law, run {name}")
    if diagnosis.effects:
        loops(after, index, ax=last, title=f"Final model, run {name}")
        last.set_ylim(first.get_ylim())
    else:
        residual_in_time(before, index, ax=last)
    return [falling, residual, first, last]


def before_and_after(
    diagnosis: Diagnosis, pattern: Failure, ax: Axes, *, titled: bool = True
) -> None:
    """Plot bin means of the residual along the axis of a pattern, before and after.

    The final model is drawn only if it differs from the base law.
    """
    quantities = diagnosis.model.rig.quantities
    noise_band(ax, diagnosis.before.noise_rms, unit=quantities.force)
    changed = bool(diagnosis.model.effects) and diagnosis.after is not diagnosis.before
    draw_means(ax, pattern, BEFORE, quantities, "base law" if changed else "")
    if changed:
        draw_means(ax, means_along(diagnosis.after, pattern.axis), MODEL, quantities, "final")
    if titled:
        legend_on_top(ax)
    else:
        ax.set_title("", loc="left")
        legend_above(ax, 2)
