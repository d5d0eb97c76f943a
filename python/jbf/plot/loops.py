"""Plot of friction against speed along a run, with the hysteresis loops of dynamic friction."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from jbf.plot.runs import axes_words, index_of
from jbf.plot.style import MEASURED, MODEL, dress, one_axes

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from jbf.comparison.comparison import Comparison

MOST_DOTS = 1500


def loops(
    comparison: Comparison,
    run: int | str | None = None,
    *,
    alone: bool = False,
    ax: Axes | None = None,
    colour: str = MODEL,
    title: str = "",
) -> Axes:
    """Plot friction against speed of one run: measured values as dots, the model as a line.

    Hollow dots are samples that the fit excludes, such as those before the state of a film or a
    bristle is known. The model is not drawn there.

    Parameters
    ----------
    comparison
        Result of `jbf.compare`, or `before` and `after` of a diagnosis.
    run
        Index or name of the run. Default: the run with the largest error.
    alone
        Whether to subtract the model terms that are not friction, such as inertia and weight.
    ax
        Matplotlib axes to draw on. Default: those of a new figure.
    """
    ax = one_axes(ax)
    index = index_of(comparison, run)
    p = comparison.campaign.prepared[index]
    rest = np.zeros(len(p.friction))
    if alone:
        from jbf.comparison.parts import added_by, non_friction_effects

        rest = added_by(comparison, non_friction_effects(comparison))[index]
    speed = p.motion.velocity
    stride = max(len(speed) // MOST_DOTS, 1)
    measured = np.column_stack((speed, p.friction - rest))[::stride]
    counted = comparison.samples.counted[index][::stride]
    dots: dict[str, Any] = {"linestyle": "", "alpha": 0.6, "rasterized": True, "color": MEASURED}
    ax.plot(*measured[counted].T, ".", markersize=3, label="measured", **dots)
    if not counted.all():
        dots |= {"markerfacecolor": "none", "markeredgewidth": 0.6}
        ax.plot(*measured[~counted].T, "o", markersize=3, label="excluded from the fit", **dots)
    draw_model(ax, comparison, index, rest, colour=colour)
    dress(ax, title or f"Run {p.run.name}", *axes_words(comparison))
    ax.legend(loc="upper left", frameon=False, markerscale=2)
    return ax


def draw_model(
    ax: Axes,
    comparison: Comparison,
    index: int,
    rest: float | npt.NDArray[np.float64] = 0.0,
    *,
    colour: str = MODEL,
    label: str = "model",
) -> None:
    """Plot the model's loop of a run, minus `rest`, on axes that show the measured values."""
    speed = comparison.campaign.prepared[index].motion.velocity
    # The instant of a reversal lies between samples. A line through it would show a slope that the
    # model does not have.
    turns = np.append(np.sign(speed[1:]) * np.sign(speed[:-1]) < 0, False)
    in_loop = comparison.samples.counted[index] & ~turns
    modelled = np.where(in_loop, comparison.predictions[index] - rest, np.nan)
    ax.plot(speed, modelled, color=colour, linewidth=1.3, label=label, rasterized=True)
