"""Draw the pictures of docs/control.md: `.venv/bin/python docs/control_pictures.py`."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from jbf import control
from jbf.control.robustness import robustness
from jbf.control.schemes import LISTED_VOLTS, Coulomb, Learning
from jbf.control.thesis_tables import tables
from jbf.reporting.control_plots import plot_robustness, plot_tables
from jbf.reporting.control_run_plot import plot_runs
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, NullFormatter, ScalarFormatter

IMAGES = Path(__file__).resolve().parent / "images"
SCHEMES = ("none", "learning", "coulomb", "observed")
SEEDS = 2


def runs(row: str) -> Figure:
    """Plot the runs of four compensators for one row of Tables 6.1 and 6.2 of Cohn (1998)."""
    return plot_runs([control.run(None, scheme, control.TASKS[row]) for scheme in SCHEMES])


def _ratios(ax: Axes, values: np.ndarray, lines: dict[str, list[float]], label: str) -> None:
    for row, ratios in lines.items():
        ax.plot(values, ratios, "o-", markersize=3, linewidth=1.0, label=row)
    ax.axhspan(0.5, 2.0, color="black", alpha=0.07)
    ax.axhline(1.0, color="black", linewidth=0.8)
    ax.set(xscale="log", yscale="log", xlabel=label, ylim=(0.06, 6.0))
    ax.yaxis.set_major_locator(FixedLocator([0.1, 0.2, 0.5, 1.0, 2.0, 5.0]))
    ax.yaxis.set_major_formatter(ScalarFormatter())
    ax.grid(alpha=0.25)


def settled() -> Figure:
    """Plot RMS errors relative to Cohn (1998) against friction scale and belt stiffness."""
    figure = Figure(figsize=(11.0, 4.6), layout="constrained")
    left, right = figure.subplots(1, 2, sharey=True)
    bench, model = control.THESIS_BENCH, control.thesis_model()

    scales = np.array([2.0, 2.5, 2.94, 3.5, 4.2, 5.5, 8.0, 12.0, 17.0, LISTED_VOLTS])
    lines: dict[str, list[float]] = {row: [] for row in control.TASKS}
    for volts in scales:
        scheme = {"learning": Learning(volts=float(volts))}
        for cell in tables(model, bench, schemes=scheme, seeds=SEEDS).column("learning"):
            lines[cell.row].append(cell.ratio or np.nan)
    _ratios(left, scales, lines, "scale of the compensator, V for a friction coefficient of 1")
    rig = bench.volts_per_n * 104.0
    for x, word, side in ((rig, "the rig's own", "left"), (LISTED_VOLTS, "as listed", "right")):
        left.axvline(x, color="black", linestyle=":", linewidth=1.0)
        left.text(x, 5.5, f"  {word}  ", ha=side, va="top", fontsize=8)
    left.xaxis.set_major_locator(FixedLocator([2.0, 3.0, 5.0, 10.0, 20.0]))
    left.xaxis.set_major_formatter(ScalarFormatter())
    left.xaxis.set_minor_formatter(NullFormatter())
    left.set_title("dynamic model, learned")
    left.set_ylabel("RMS error, bench / thesis")
    named = left.get_legend_handles_labels()
    figure.legend(*named, fontsize=8, frameon=False, loc="outside lower center", ncols=len(lines))

    belts = np.array([10.0, 20.0, 30.0, 40.0, 60.0, 100.0, 200.0, 400.0, 1000.0])
    lines = {row: [] for row in control.TASKS if row != "velocity square"}
    for k in belts:
        soft = control.thesis_model(**{"drive_compliance.k": float(k)})
        result = tables(soft, bench, schemes={"coulomb": Coulomb()}, seeds=SEEDS)
        for row, ratios in lines.items():
            ratios.append(result[row, "coulomb"].ratio or np.nan)
    _ratios(right, belts, lines, "stiffness of the belt, N m/rad")
    right.axvline(40.0, color="black", linestyle=":", linewidth=1.0)
    right.set_title("Coulomb observer")
    return figure


def main() -> None:
    """Draw all pictures (one minute)."""
    figures = {
        "control_velocity_sine": runs("velocity sine"),
        "control_position_triangle": runs("position triangle"),
        "control_settled": settled(),
        "control_tables": plot_tables(tables(control.thesis_model(), control.THESIS_BENCH)),
        "control_robustness": plot_robustness(robustness()),
    }
    for name, figure in figures.items():
        figure.savefig(IMAGES / f"{name}.png", dpi=80 if "_sine" in name or "_tri" in name else 100)


if __name__ == "__main__":
    main()
