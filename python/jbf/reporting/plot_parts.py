"""What all pictures share: colours, the look of an axes, a figure where none is given."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import AutoLocator, MaxNLocator

from jbf.errors import InputError
from jbf.reporting.words import number

# Okabe and Ito's colours: people who confuse red and green can tell them apart.
MEASURED, MODEL, BEFORE, NOISE = "#8c8c8c", "#0072b2", "#d55e00", "#009e73"


def plain(words: str) -> str:
    """Words that matplotlib takes for no formula, whatever a run is called."""
    return words.replace("$", r"\$")


def dress(ax: Axes, title: str, x: str, y: str) -> None:
    """Title, names of the axes, grid."""
    ax.set_title(plain(title), loc="left", fontsize="medium")
    ax.set_xlabel(x)
    ax.set_ylabel(y)
    if isinstance(ax.xaxis.get_major_locator(), AutoLocator):
        ax.xaxis.set_major_locator(MaxNLocator(6))
    ax.grid(alpha=0.25)
    ax.spines[["top", "right"]].set_visible(False)


def axes_or_new(
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


def noise_band(ax: Axes, noise_n: float, name: str = "noise", unit: str = "N") -> None:
    """One standard deviation of the noise to either side of zero."""
    label = f"{name}, ±{number(noise_n, 2)} {unit}"
    ax.axhspan(-noise_n, noise_n, color=NOISE, alpha=0.15, label=label)
    ax.axhline(0.0, color="black", linewidth=0.6)


def legend_on_top(ax: Axes, columns: int = 2) -> None:
    """A legend in room made for it above the data."""
    low, high = ax.get_ylim()
    ax.set_ylim(low, high + 0.28 * (high - low))
    ax.legend(loc="upper left", frameon=False, fontsize="small", ncols=columns)
