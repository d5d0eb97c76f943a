"""Plot of the errors in each step of a diagnosis, with the noise floor."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from jbf.models.number_format import number, step_words
from jbf.plot.style import (
    BEFORE,
    INK,
    MODEL,
    NOISE,
    dress,
    legend_above,
    one_axes,
    plain,
    shortened,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes

    from jbf.diagnosis.ledger import Step
    from jbf.diagnosis.result import Diagnosis


def ledger(diagnosis: Diagnosis, *, ax: Axes | None = None) -> Axes:
    """Plot fit and held-out error of each step of a diagnosis, one row each.

    The error axis is logarithmic, so that the last steps remain visible next to the first.
    """
    steps = diagnosis.steps
    ax = one_axes(ax, (9.0, 1.3 + 0.42 * len(steps)))
    y = np.arange(len(steps))
    unit = diagnosis.model.rig.quantities.force
    noise = steps[-1].noise_rms
    ax.set_xscale("log")
    if noise > 0.0:
        ax.axvline(noise, color=NOISE, linestyle="--", linewidth=1.5, label="noise floor")
    fitted, held_out = _errors(steps)
    ax.hlines(
        y, np.minimum(fitted, held_out), np.maximum(fitted, held_out), color=INK, linewidth=0.6
    )
    ax.plot(fitted, y, "o-", color=MODEL, label="fit")
    ax.plot(held_out, y, "s--", color=BEFORE, markerfacecolor="white", label="held out")
    names = [step_words([s.effects for s in steps], i) for i in range(len(steps))]
    ax.set_yticks(y, labels=[plain(shortened(name, 44)) for name in names])
    ax.set_ylim(len(steps) - 0.5, -0.6)
    _reach(ax, [noise, *fitted, *held_out])
    for row, words in zip(y, _falls(held_out, unit), strict=True):
        ax.annotate(
            words,
            (1.01, row),
            xycoords=("axes fraction", "data"),
            va="center",
            fontsize="small",
            annotation_clip=False,
        )
    dress(ax, "Error by step", f"RMS residual ({unit}), logarithmic", "")
    legend_above(ax)
    return ax


def _errors(steps: Sequence[Step]) -> tuple[list[float], list[float]]:
    """Fit RMS and held-out RMS of each step."""
    return [s.rms for s in steps], [s.held_out_rms for s in steps]


def _falls(held_out: Sequence[float], unit: str) -> list[str]:
    """Format each held-out error with its relative change from the previous step."""
    words = [f"{number(held_out[0])} {unit}"]
    for last, now in pairwise(held_out):
        change = 100.0 * (now / last - 1.0) if last > 0.0 else 0.0
        # The typographic minus sign has the width of the plus sign.
        words.append(f"{number(now)} {unit}  ({change:+.2g} %)".replace("-", "−"))
    return words


def _reach(ax: Axes, values: Sequence[float]) -> None:
    """Set the limits of an axis slightly beyond the values, with few round ticks."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    positive = [v for v in values if v > 0.0 and np.isfinite(v)] or [1.0]
    low, high = min(positive), max(positive)
    span = max(float(np.log(high / low)), 0.1)
    ax.set_xlim(low * float(np.exp(-0.06 * span)), high * float(np.exp(0.06 * span)))
    decades = np.log10(high / low)
    subs = (1.0,) if decades > 2.5 else (1.0, 2.0, 5.0) if decades > 0.5 else tuple(range(1, 10))
    ax.xaxis.set_major_locator(LogLocator(subs=[float(s) for s in subs], numticks=12))
    ax.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
    ax.xaxis.set_minor_formatter(NullFormatter())
