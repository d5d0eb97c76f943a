"""Plot of the detection rate against the size of the hidden effect."""

from __future__ import annotations

import itertools
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from work import Row

EDGES = (0.0, 0.5, 1.0, 2.0, 4.0, 8.0, np.inf)


def detection(rows: list[Row], path: Path) -> None:
    """Plot the fraction of single hidden effects that are named against their size.

    The size is the largest RMS of the effect in a run, relative to the noise.
    """
    single = [row for row in rows if row["kind"] == "single"]
    size = np.array([row["effect_over_noise"] for row in single])
    good = np.array([row["judged"] in ("right", "tied") for row in single])
    figure, axes = plt.subplots(figsize=(6, 3.2), layout="constrained")
    for i, (low, high) in enumerate(itertools.pairwise(EDGES)):
        inside = (size >= low) & (size < high)
        if inside.any():
            axes.bar(i, 100.0 * good[inside].mean(), color="#3b6ea5")
            axes.annotate(f"{good[inside].sum()}/{inside.sum()}", (i, 50), ha="center", color="w")
    axes.set_xticks(range(len(EDGES) - 1))
    axes.set_xticklabels([f"{a:g} to {b:g}" for a, b in itertools.pairwise(EDGES)])
    axes.set_xlabel("RMS of the hidden effect over the noise, in the run that shows most of it")
    axes.set_ylabel("named, %")
    figure.savefig(path, dpi=110)
    plt.close(figure)
