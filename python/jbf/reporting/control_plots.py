"""Figures of the tables of Cohn (1998), and of the robustness of a compensator."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from jbf.control.robustness import Outcome
from jbf.control.thesis_tables import COLUMNS, Tables
from jbf.plot.style import BEFORE, MEASURED, MODEL, NOISE, dress


def plot_tables(tables: Tables, figure: Figure | None = None) -> Figure:
    """Plot the simulated RMS errors and those of Cohn (1998) for every cell of the tables.

    Columns without values in the thesis, such as the observed compensator, show the true error.
    """
    drawing = Figure(figsize=(10.0, 4.6), layout="constrained") if figure is None else figure
    ax = drawing.subplots()
    rows = list({key[0]: None for key in tables.cells})
    columns = list({key[1]: None for key in tables.cells})
    colours = {"none": MEASURED, "learning": MODEL, "coulomb": BEFORE, "observed": NOISE}
    for i, column in enumerate(columns):
        at = np.arange(len(rows)) + (i - (len(columns) - 1) / 2.0) * 0.2
        cells = [tables[row, column] for row in rows]
        ours = column not in COLUMNS
        label = f"{column}, true error" if ours else f"{column}, bench"
        heights = [c.true_rms if ours else c.rms for c in cells]
        ax.bar(at, heights, 0.17, color=colours[column], alpha=0.85, label=label)
        if column in COLUMNS:
            printed = [(x, c.printed_rms) for x, c in zip(at, cells, strict=True) if c.printed_rms]
            ax.plot(
                [x for x, _ in printed],
                [y for _, y in printed],
                "D",
                color="black",
                markersize=5,
                label="thesis" if i == 0 else None,
            )
    ax.set_yscale("log")
    ax.set_xticks(range(len(rows)), [row.replace(" ", "\n", 1) for row in rows])
    dress(ax, "RMS error: bench (bars) and thesis (diamonds)", "", "rad or rad/s")
    drawing.legend(ncols=5, fontsize="small", frameon=False, loc="outside lower center")
    return drawing


def plot_robustness(outcomes: Sequence[Outcome], figure: Figure | None = None) -> Figure:
    """Plot the error with compensation relative to that without it, one dot per row of the tables.

    The worst row of each case is marked.
    """
    drawing = Figure(figsize=(8.0, 7.0), layout="constrained") if figure is None else figure
    ax = drawing.subplots()
    for i, outcome in enumerate(reversed(outcomes)):
        values = list(outcome.ratios.values())
        ax.plot(values, [i] * len(values), "o", color=MODEL, alpha=0.5, markersize=4)
        ax.plot(outcome.worst, i, "D", color=BEFORE, markersize=5)
    ax.axvline(1.0, color="black", linewidth=1.0)
    ax.set_xscale("log")
    ax.set_yticks(range(len(outcomes)), [o.name for o in reversed(outcomes)], fontsize="small")
    title = "Ratio of the errors with and without the observed compensator (below 1: improvement)"
    dress(ax, title, "Ratio of true RMS errors, worst row marked", "")
    return drawing
