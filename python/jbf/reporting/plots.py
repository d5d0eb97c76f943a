"""Pictures of a comparison, a diagnosis and a run, on matplotlib axes.

Every function draws on the axes it is given, or on a new figure's, and returns them; none opens
a window. `axes[0].figure.savefig(...)` writes the picture.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from jbf.comparison.comparison import Comparison
from jbf.errors import InputError
from jbf.reporting.plot_parts import (
    BEFORE,
    MEASURED,
    MODEL,
    bin_means,
    dress,
    error_falling,
    friction_speed,
    legend_on_top,
    noise_band,
    pattern_along,
    residual_in_time,
)

if TYPE_CHECKING:
    from jbf.diagnosis.result import Diagnosis


def _axes(
    axes: Sequence[Axes] | None, rows: int, columns: int, size: tuple[float, float]
) -> list[Axes]:
    """The axes given, or those of a new figure."""
    wanted = rows * columns
    if axes is None:
        figure = Figure(figsize=size, layout="constrained")
        found = list(np.ravel(figure.subplots(rows, columns)))
    else:
        found = list(np.ravel(np.asarray(axes, dtype=object)))
    if len(found) != wanted:
        raise InputError(
            problem=f"{len(found)} axes were given", mend=f"this picture needs {wanted}"
        )
    return found


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
    left, right = _axes(axes, 1, 2, (10.0, 4.2))
    index = most_telling(comparison)
    friction_speed(left, comparison, index, MODEL, f"Run {comparison.runs[index].name}")
    noise_band(right, comparison.noise_n)
    failure = pattern_along(comparison, None)
    bin_means(right, failure, MODEL)
    if not comparison.failures:
        right.set_title("No pattern in the residual", loc="left", fontsize="medium")
    legend_on_top(right)
    return [left, right]


def plot_diagnosis(diagnosis: Diagnosis, axes: Sequence[Axes] | None = None) -> list[Axes]:
    """The error falling, the residual before and after, and friction against speed.

    The last of the four axes shows the final model, or, where no effect was added, the residual
    of the run in time.

    Parameters
    ----------
    diagnosis
        From `jbf.diagnose`.
    axes
        Four matplotlib axes to draw on; a new figure's by default.
    """
    falling, residual, first, last = _axes(axes, 2, 2, (10.0, 8.0))
    before, after = diagnosis.before, diagnosis.after
    error_falling(falling, diagnosis)
    pattern = pattern_along(before, None)
    noise_band(residual, before.noise_n)
    bin_means(residual, pattern, BEFORE, "bare law" if diagnosis.effects else "")
    index = most_telling(before, after)
    name = before.runs[index].name
    friction_speed(first, before, index, BEFORE, f"Bare law, run {name}")
    if diagnosis.effects:
        bin_means(residual, pattern_along(after, pattern.axis), MODEL, "final")
        friction_speed(last, after, index, MODEL, f"Final model, run {name}")
        last.set_ylim(first.get_ylim())
    else:
        residual_in_time(last, before, index)
    legend_on_top(residual)
    return [falling, residual, first, last]


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
    top, bottom = _axes(axes, 2, 1, (10.0, 6.0))
    index = _index(comparison, run)
    p = comparison.campaign.prepared[index]
    time_s = p.run.time_s
    top.plot(time_s, p.friction_n, ".", color=MEASURED, markersize=2, label="measured")
    top.plot(time_s, comparison.predictions[index], color=MODEL, linewidth=1.0, label="model")
    dress(top, f"Run {p.run.name}", "Time (s)", "Friction of one bearing (N)")
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
