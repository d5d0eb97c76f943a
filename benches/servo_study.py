"""Parameters of simulated servo drives by `jbf.fit` with the right terms, and their intervals.

The drives of `simulator/servosim` have closed-loop motions, four kinds of time stamps, counted
positions, filtered and differenced velocities, offsets between clocks, and torque commands.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any

import jbf
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "simulator"))

import servosim

RIGHT = 3.0
"""Largest error of a right parameter, in standard errors."""
CLOSE = 0.03
"""Largest relative error of a parameter that is assessed as close, in addition to `RIGHT`."""
INTERVAL = 1.96
"""Half-width of a 95 % interval in standard errors."""


def runs_of(campaign: servosim.Campaign) -> tuple[jbf.Rig, list[jbf.Run]]:
    """Convert a simulated campaign to a `jbf.Rig` and its runs."""
    with tempfile.TemporaryDirectory() as folder:
        servosim.write(campaign, Path(folder))
        rig = jbf.read_rig(Path(folder) / "rig.toml")
        return rig, [jbf.read_run(path, rig) for path in sorted(Path(folder).glob("run_*.csv"))]


def study(seed: int) -> dict[str, Any]:
    """Simulate and fit the campaign of one seed, and return its row of results."""
    campaign = servosim.simulate(seed)
    drawn = campaign.drawn
    plant, logger = drawn.plant, drawn.logger
    effects = {"inertia.m_e": plant.inertia}
    if plant.gravity:
        name = "gravity.G" if plant.swings else "sensor_offset.b"
        effects[name] = plant.gravity
    true = {"F_c": plant.coulomb, "F_v": plant.viscous, **effects}
    row: dict[str, Any] = {
        "seed": seed,
        "kind": drawn.kind,
        "rotary": drawn.rotary,
        "rate_hz": logger.rate_hz,
        "stamps": logger.stamps,
        "speed": logger.speed,
        "force": logger.force,
        "speed_late": logger.speed_late,
        "force_late": logger.force_late,
    }
    started = time.process_time()
    try:
        rig, runs = runs_of(campaign)
        fit = jbf.fit(rig, runs, [n.split(".")[0] for n in effects], law="coulomb")
    except Exception as error:
        return row | {"error": f"{type(error).__name__}: {error}"[:200], "right": False}
    row["seconds"] = time.process_time() - started
    estimates = {name: fit.parameters[name] for name in true}
    row["z"] = {
        n: (estimates[n].value - t) / estimates[n].stderr if estimates[n].stderr else math.inf
        for n, t in true.items()
    }
    row["relative"] = {n: estimates[n].value / t - 1.0 for n, t in true.items()}
    row["right"] = all(abs(z) <= RIGHT for z in row["z"].values())
    row["close"] = all(abs(r) <= CLOSE for r in row["relative"].values())
    row["findings"] = sorted({f.kind for f in fit.findings})
    return row


def line(row: dict[str, Any]) -> str:
    """Format the results of one campaign as a line."""
    head = (
        f"{row['seed']:5d} {'right' if row['right'] else 'WRONG'} {row['kind']:14s} "
        f"{row['rate_hz']:5.0f} Hz {row['stamps']:8s} {row['speed']:11s} {row['force']:9s} "
        f"late {row['speed_late']:+.2f} {row['force_late']:+.2f} "
    )
    if "error" in row:
        return head + str(row["error"])
    parts = [
        f"{name.split('.')[-1]} {100.0 * row['relative'][name]:+.2f} % ({z:+.1f})"
        for name, z in row["z"].items()
    ]
    return head + ", ".join(parts) + " " + ",".join(row["findings"])


def summary(rows: list[dict[str, Any]]) -> str:
    """Return the rates of right parameters and the coverage, over all campaigns and by kind."""
    fitted = [row for row in rows if "error" not in row]
    lines = [
        f"right: {sum(r['right'] for r in rows)} of {len(rows)}; all within {CLOSE:.0%}: "
        f"{sum(r.get('close', False) for r in rows)}; errors: {len(rows) - len(fitted)}"
    ]
    groups = {
        "F_c": ["F_c"],
        "F_v": ["F_v"],
        "inertia": ["inertia.m_e"],
        "gravity": ["gravity.G", "sensor_offset.b"],
    }
    for label, names in groups.items():
        z = [abs(r["z"][n]) for r in fitted for n in names if n in r["z"]]
        off = [abs(r["relative"][n]) for r in fitted for n in names if n in r["relative"]]
        if z:
            lines.append(
                f"{label:8s} 95 % intervals cover {100.0 * np.mean(np.array(z) < INTERVAL):.0f} %, "
                f"within three standard errors {100.0 * np.mean(np.array(z) < RIGHT):.0f} %, "
                f"median error {100.0 * np.median(off):.2f} %"
            )
    for key in ("kind", "rate_hz", "stamps", "speed", "force"):
        values = sorted({r[key] for r in rows}, key=str)
        shares = [
            f"{v}: {sum(r['right'] for r in rows if r[key] == v)}/"
            f"{sum(1 for r in rows if r[key] == v)}"
            for v in values
        ]
        lines.append(f"{key:8s} " + ", ".join(shares))
    lines.append(f"processor time of the fits: {sum(r['seconds'] for r in fitted):.0f} s")
    return "\n".join(lines)


def main() -> None:
    """Read the arguments, run the study and print it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--first", type=int, default=1, help="first seed (default 1)")
    parser.add_argument("--count", type=int, default=20, help="campaigns (default 20)")
    parser.add_argument("--jobs", type=int, default=1, help="processes (default 1)")
    parser.add_argument("--json", type=Path, help="write all rows to this file")
    arguments = parser.parse_args()
    seeds = range(arguments.first, arguments.first + arguments.count)
    with ProcessPoolExecutor(arguments.jobs) as pool:
        rows = []
        for row in pool.map(study, seeds):
            rows.append(row)
            print(line(row), flush=True)
    print(summary(rows))
    if arguments.json is not None:
        arguments.json.write_text(json.dumps(rows, indent=1))


if __name__ == "__main__":
    main()
