"""Common elements of all plots: colours, axes style, new figures, file output."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import TYPE_CHECKING, cast

import numpy as np

from jbf.errors import InputError
from jbf.models.number_format import number

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from jbf.results import AxesOrArray

# Colour palette of Okabe and Ito, distinguishable with red-green colour blindness.
MEASURED, MODEL, BEFORE, NOISE = "#8c8c8c", "#0072b2", "#d55e00", "#009e73"
OTHER = "#cc79a7"
INK, SOFT = "#000000", "#5b6470"
DIVERGING = "PuOr_r"
"""Diverging colour map of signed quantities, distinguishable with colour blindness."""
PIXELS_PER_INCH = 130


def plain(words: str) -> str:
    """Escape characters that matplotlib would interpret as a formula."""
    return words.replace("$", r"\$")


def shortened(words: str, longest: int = 28) -> str:
    """Shorten a long name by replacing its middle with an ellipsis."""
    if len(words) <= longest:
        return words
    head = (longest - 1) // 2
    return f"{words[:head]}…{words[head - longest + 1 :]}"


def dress(ax: Axes, title: str, x: str, y: str) -> None:
    """Set title, axis labels and grid of axes."""
    from matplotlib.ticker import AutoLocator, MaxNLocator

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
    """Return the given axes, or those of a new figure."""
    count = rows * columns
    if axes is None:
        from matplotlib.figure import Figure

        figure = Figure(figsize=size, layout="constrained")
        axes_list = list(np.ravel(figure.subplots(rows, columns)))
    else:
        axes_list = list(np.ravel(np.asarray(axes, dtype=object)))
    if len(axes_list) != count:
        raise InputError(
            problem=f"{len(axes_list)} axes were given", remedy=f"this picture requires {count}"
        )
    return axes_list


def one_axes(ax: Axes | None, size: tuple[float, float] = (6.0, 4.0)) -> Axes:
    """Return the given axes, or that of a new figure."""
    return axes_or_new(None if ax is None else [ax], 1, 1, size)[0]


def noise_band(ax: Axes, noise_rms: float, name: str = "noise", unit: str = "N") -> None:
    """Shade one standard deviation of the noise on both sides of zero."""
    label = f"{name}, ±{number(noise_rms, 2)} {unit}"
    ax.axhspan(-noise_rms, noise_rms, color=NOISE, alpha=0.15, label=label)
    ax.axhline(0.0, color=INK, linewidth=0.6)


def legend_on_top(ax: Axes, columns: int = 2) -> None:
    """Add a legend inside the axes, in additional space above the data."""
    low, high = ax.get_ylim()
    ax.set_ylim(low, high + 0.28 * (high - low))
    ax.legend(loc="upper left", frameon=False, fontsize="small", ncols=columns)


def legend_above(ax: Axes, columns: int = 3) -> None:
    """Add a legend above the axes, aligned to the right."""
    ax.legend(
        loc="lower right",
        bbox_to_anchor=(1.0, 0.995),
        frameon=False,
        fontsize="small",
        ncols=columns,
        borderaxespad=0.1,
        columnspacing=1.2,
        handlelength=1.6,
    )


def save(ax: AxesOrArray, path: str | os.PathLike[str]) -> None:
    """Save the figure of the axes in the format of the suffix, such as `.svg`, `.pdf` or `.png`.

    Raises
    ------
    InputError
        The file cannot be written, or its suffix is not that of an image format.
    """
    first = np.ravel(np.asarray(ax, dtype=object))[0]
    # Keep text as text, so that it can be searched and set in another font.
    from matplotlib import rc_context

    try:
        with rc_context({"svg.fonttype": "none", "pdf.fonttype": 42}):
            cast("Figure", first.figure).savefig(path, dpi=PIXELS_PER_INCH)
    except (OSError, ValueError) as error:
        problem = f"cannot be written ({str(error).splitlines()[0].lower()})"
        raise InputError(file=path, problem=problem, remedy="name a .png, .svg or .pdf") from None
