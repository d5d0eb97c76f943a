"""Figure of imported recordings and of the pieces into which they were cut."""

from __future__ import annotations

import os
from collections.abc import Sequence

from matplotlib.axes import Axes

from jbf.importing.overview import Overview
from jbf.importing.result import Import
from jbf.plot.style import BEFORE, MEASURED, MODEL, axes_or_new, dress, plain, save
from jbf.reporting.page import page
from jbf.reporting.svg import svg

_MOST_NAMED = 40


def plot_cut(campaign: Import, axes: Sequence[Axes] | None = None) -> Sequence[Axes]:
    """Plot each channel of each imported recording in time, with the pieces.

    Runs are shaded in alternating colours. Excluded pieces are hatched.
    """
    rows = [(view, key) for view in campaign.overviews for key in view.curves]
    all_axes = axes_or_new(axes, len(rows), 1, (11.0, 0.8 + 1.7 * len(rows)))
    for ax, (view, key) in zip(all_axes, rows, strict=True):
        times, low, high = view.curves[key]
        # The line at mid-height stays visible where a segment contains a single sample.
        ax.fill_between(times, low, high, color=MEASURED, linewidth=0.0)
        ax.plot(times, 0.5 * (low + high), color="black", linewidth=0.5)
        _shade(ax, campaign, view)
        dress(ax, f"{view.file}: {key}", "Time (s)", key)
    return all_axes


def _shade(ax: Axes, campaign: Import, view: Overview) -> None:
    file_pieces = [piece for piece in campaign.pieces if piece.file == view.file]
    runs = [piece for piece in file_pieces if piece.keep]
    for piece in file_pieces:
        shift = view.starts_s[piece.segment]
        span = (piece.from_s + shift, piece.to_s + shift)
        if not piece.keep:
            ax.axvspan(*span, facecolor="none", edgecolor="#d9d9d9", hatch="///", linewidth=0.0)
            continue
        number = runs.index(piece)
        ax.axvspan(*span, color=(MODEL, BEFORE)[number % 2], alpha=0.15, linewidth=0.0)
        if len(runs) <= _MOST_NAMED:
            word = piece.name.rpartition("_")[2] if len(runs) > 1 else piece.name
            ax.annotate(
                plain(word),
                (span[0], 1.0),
                xycoords=("data", "axes fraction"),
                fontsize=6,
                va="top",
            )


def save_cut(campaign: Import, path: str | os.PathLike[str]) -> None:
    """Save the figure of imported recordings and their pieces.

    Raises
    ------
    InputError
        The file cannot be written, or its suffix is not that of an image format.
    """
    save(plot_cut(campaign), path)


def import_page(campaign: Import) -> str:
    """HTML page of an import."""
    picture = svg(plot_cut(campaign), "Each recording in time, and how it was cut")
    return page("text.html.j2", "Import", words=campaign.summary(), picture=picture)
