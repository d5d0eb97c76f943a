"""The picture of a diagnosis: the error falling, the residual before and after."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes

from jbf.diagnosis.result import Diagnosis
from jbf.reporting.comparison_plots import most_telling
from jbf.reporting.plot_parts import (
    BEFORE,
    MODEL,
    NOISE,
    axes_or_new,
    dress,
    legend_on_top,
    noise_band,
)
from jbf.reporting.residual_parts import (
    draw_bin_means,
    friction_speed,
    means_along,
    residual_in_time,
)
from jbf.reporting.words import step_name


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
    falling, residual, first, last = axes_or_new(axes, 2, 2, (10.0, 8.0))
    before, after = diagnosis.before, diagnosis.after
    error_falling(falling, diagnosis)
    pattern = means_along(before, None)
    said = diagnosis.model.rig.quantities
    noise_band(residual, before.noise_n, unit=said.force)
    draw_bin_means(residual, pattern, BEFORE, said, "bare law" if diagnosis.effects else "")
    index = most_telling(before, after)
    name = before.runs[index].name
    friction_speed(first, before, index, BEFORE, f"Bare law, run {name}")
    if diagnosis.effects:
        draw_bin_means(residual, means_along(after, pattern.axis), MODEL, said, "final")
        friction_speed(last, after, index, MODEL, f"Final model, run {name}")
        last.set_ylim(first.get_ylim())
    else:
        residual_in_time(last, before, index)
    legend_on_top(residual)
    return [falling, residual, first, last]


def error_falling(ax: Axes, diagnosis: Diagnosis) -> None:
    """Fit and held-out error of each step of the ledger, and the noise floor."""
    steps = diagnosis.steps
    x = np.arange(len(steps))
    ax.axhline(steps[-1].noise_n, color=NOISE, linestyle="--", linewidth=1.5, label="noise floor")
    ax.plot(x, [s.rms_n for s in steps], "o-", color=MODEL, label="fit")
    ax.plot(
        x, [s.holdout_rms_n for s in steps], "s--", color=BEFORE, markerfacecolor="white",
        label="held out",
    )  # fmt: skip
    names = [step_name(diagnosis, i).replace("_", " ") for i in range(len(steps))]
    slanted = len(steps) > 3
    ax.set_xticks(
        x, labels=names, rotation=20 if slanted else 0, ha="right" if slanted else "center"
    )
    ax.set_xlim(-0.5, len(steps) - 0.5)
    highest = max(max(s.rms_n, s.holdout_rms_n, s.noise_n) for s in steps)
    ax.set_ylim(0.0, 1.15 * highest)
    unit = diagnosis.model.rig.quantities.force
    dress(ax, "The error falling", "Model", f"RMS of record minus model ({unit})")
    ax.legend(loc="best", frameon=False)
