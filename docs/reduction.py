"""Draw the error of the model without inertia: `.venv/bin/python docs/reduction.py`."""

from __future__ import annotations

import csv
import subprocess
from pathlib import Path

import numpy as np
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator

HERE = Path(__file__).resolve().parent
COMMAND = ["cargo", "run", "--quiet", "--release", "-p", "jbf-core", "--example", "reduction_map"]
TITLES = {"journal": "journal clock, $U_{tr}/R$", "thesis": "thesis clock, 1 s$^{-1}$"}


def main() -> None:
    """Plot the largest error relative to the peak of the loop, in one panel per time scale."""
    printed = subprocess.run(COMMAND, check=True, capture_output=True, text=True, cwd=HERE.parent)
    rows = list(csv.DictReader(printed.stdout.splitlines()))
    figure = Figure(figsize=(11.0, 4.6), layout="constrained")
    panels = figure.subplots(1, 2, sharey=True)
    levels = 10.0 ** np.arange(-8.0, -2.4, 0.5)
    for panel, clock in zip(panels, TITLES, strict=True):
        mine = [row for row in rows if row["clock"] == clock]
        amplitudes = sorted({float(row["amplitude_m_s"]) for row in mine})
        omegas = sorted({float(row["omega_rad_s"]) for row in mine})
        difference = np.array([float(row["difference"]) for row in mine])
        grid = difference.reshape(len(amplitudes), len(omegas)).clip(levels[0])
        filled = panel.contourf(
            omegas, amplitudes, grid, levels, norm=LogNorm(levels[0], levels[-1]), extend="max"
        )
        lines = panel.contour(
            omegas, amplitudes, grid, [1e-6, 1e-5, 1e-4, 1e-3], colors="white", linewidths=0.9
        )
        panel.axhline(0.06, color="black", linestyle=":", linewidth=1.0)
        panel.text(0.11, 0.064, "$U_{tr}$", fontsize=9)
        panel.plot([0.1, 0.25, 0.5, 1.0, 2.0], [0.127] * 5, "ko", markersize=4, clip_on=False)
        panel.text(0.11, 0.15, "the thesis's two-way runs", fontsize=8)
        panel.set(xscale="log", yscale="log", title=TITLES[clock])
        panel.set_xlabel("frequency of the motion, rad/s")
    panels[0].set_ylabel("amplitude of the speed, m/s")
    bar = figure.colorbar(filled, ax=panels, label="largest difference of f over the loop's peak")
    bar.add_lines(lines)
    bar.ax.yaxis.set_major_locator(LogLocator())
    figure.savefig(HERE / "images" / "reduction.png", dpi=110)


if __name__ == "__main__":
    main()
