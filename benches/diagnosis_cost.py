"""Time of a diagnosis, by number of samples: `python benches/diagnosis_cost.py`.

Bearings of `simulator/rigsim` at 50 Hz and servo drives of `simulator/servosim`, without hidden
effects and with one or two. The runs are cut to a fraction of their duration. `--csv` and
`--picture` write the figures of docs/how/time_limit.md; `--draw` draws an existing CSV file.
"""

from __future__ import annotations

import argparse
import csv
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import jbf
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "simulator"))

import servosim
from matplotlib.figure import Figure
from rigruns import simulated
from servo_study import runs_of

FRACTIONS = (0.125, 0.25, 0.5, 1.0)
COLUMNS = ("series", "samples", "runs", "processor_s", "elapsed_s", "verdict")
BEARINGS: dict[str, tuple[str, ...]] = {
    "bearing, nothing hidden": (),
    "bearing, one effect": ("thermal_thinning",),
    "bearing, two effects": ("stribeck_excess", "sensor_lag"),
}
DRIVES: dict[str, tuple[tuple[str, ...], str]] = {
    "drive, nothing hidden": ((), "coulomb"),
    "drive, one effect": (("torque_proportional",), "coulomb"),
    "drive, two effects": (("torque_proportional", "stribeck_excess"), "coulomb"),
    "drive, one effect, --law auto": (("torque_proportional",), "auto"),
}


def cut(runs: list[jbf.Run], fraction: float) -> list[jbf.Run]:
    """Return the first part of each run."""
    parts = []
    for run in runs:
        keep = np.arange(len(run)) < fraction * len(run)
        parts.append(run.select(keep))
    return parts


def campaigns(seed: int) -> Iterator[tuple[str, jbf.Rig, list[jbf.Run], str | None]]:
    """Generate the series: name, rig, complete runs and law (None for the default)."""
    for series, effects in BEARINGS.items():
        rig, runs, _ = simulated(seed, effects, campaign="full")
        yield series, rig, runs, None
    for series, (hidden, law) in DRIVES.items():
        rig, runs = runs_of(servosim.simulate(seed, hidden, 3))
        yield series, rig, runs, law


def measured(seed: int) -> Iterator[dict[str, object]]:
    """Diagnose each campaign at each fraction of its duration, and yield the rows of the table."""
    for series, rig, runs, law in campaigns(seed):
        for fraction in FRACTIONS:
            part = cut(runs, fraction)
            law_option = {} if law is None else {"law": law}
            processor, elapsed = time.process_time(), time.monotonic()
            verdict = jbf.diagnose(rig, part, **law_option).verdict
            yield {
                "series": series,
                "samples": sum(len(run) for run in part),
                "runs": len(part),
                "processor_s": round(time.process_time() - processor, 2),
                "elapsed_s": round(time.monotonic() - elapsed, 2),
                "verdict": verdict,
            }


def draw(rows: list[dict[str, str]], path: Path) -> None:
    """Plot the processor time against the number of samples, one line for each series."""
    figure = Figure(figsize=(7.0, 4.4), layout="constrained")
    ax = figure.subplots()
    for number, series in enumerate(dict.fromkeys(row["series"] for row in rows)):
        own = [row for row in rows if row["series"] == series]
        style = "o-" if series.startswith("bearing") else "s--"
        x = [float(row["samples"]) for row in own]
        y = [float(row["processor_s"]) for row in own]
        ax.loglog(x, y, style, color=f"C{number}", label=series)
    ax.set_xlabel("samples of all runs")
    ax.set_ylabel("processor time of a diagnosis, s")
    ax.grid(which="both", alpha=0.3)
    ax.legend(fontsize="small")
    figure.savefig(path, dpi=110)


def main() -> None:
    """Measure, print and store the times, or draw those of a file."""
    parser = argparse.ArgumentParser(prog="diagnosis_cost", description=__doc__.split("\n", 1)[0])
    parser.add_argument("--seed", type=int, default=8873, help="seed of the campaigns")
    parser.add_argument("--csv", type=Path, help="file for the figures")
    parser.add_argument("--draw", type=Path, metavar="CSV", help="draw these figures only")
    parser.add_argument("--picture", type=Path, help="file for the plot")
    options = parser.parse_args()
    if options.draw is None:
        # The first diagnosis of a process imports modules.
        rig, runs, _ = simulated(options.seed, (), campaign="short")
        jbf.diagnose(rig, runs)
        rows = []
        for row in measured(options.seed):
            print(" | ".join(str(row[name]) for name in COLUMNS), flush=True)
            rows.append({name: str(value) for name, value in row.items()})
        if options.csv is not None:
            with options.csv.open("w", newline="", encoding="utf-8") as file:
                writer = csv.DictWriter(file, COLUMNS)
                writer.writeheader()
                writer.writerows(rows)
    else:
        with options.draw.open(newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
    if options.picture is not None:
        draw(rows, options.picture)


if __name__ == "__main__":
    main()
