"""Influence of a logger's treatment of the force channel on a diagnosis.

    .venv/bin/python benches/logger_artefacts.py

The program takes the demo campaign without hidden effects (five runs at 50 Hz) and changes its
force channel as loggers and exports do. It imports the result as a file, and diagnoses it. Only the
recording changes, so every row should be `adequate` or report the recording artefact.
"""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Callable
from importlib.resources import as_file, files
from pathlib import Path

import jbf
import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Columns = dict[str, Array]


def as_recorded(run: Columns) -> str:
    """Return the CSV text of a run without artefacts."""
    return table(run)


def late(seconds: float) -> Callable[[Columns], str]:
    """Return a function that returns a run as CSV with a delayed force.

    The force is interpolated to the time stamps of the run.
    """

    def treat(run: Columns) -> str:
        time = run["time_s"]
        return table(run | {"friction_n": np.interp(time - seconds, time, run["friction_n"])})

    return treat


def drawn(run: Columns) -> str:
    """Return a run as CSV with a force that is logged at 20 Hz and interpolated linearly."""
    time, force = slow(run)
    return table(run | {"friction_n": np.interp(run["time_s"], time, force)})


def held(run: Columns) -> str:
    """Return a run as CSV with a force that is logged at 20 Hz and held between its samples."""
    time, force = slow(run)
    last = np.searchsorted(time, run["time_s"] + 1e-9, side="right") - 1
    return table(run | {"friction_n": force[last]})


def own_clock(run: Columns) -> str:
    """Return a run as CSV with a force that is logged at 20 Hz with its own time stamps.

    Missing values are empty cells.
    """
    time, force = slow(run)
    motion = [name for name in run if name != "friction_n"]
    rows = {round(t, 6): [run[name][i] for name in motion] for i, t in enumerate(run["time_s"])}
    readings = {round(t, 6): f for t, f in zip(time, force, strict=True)}
    lines = [",".join([*motion, "friction_n"])]
    for t in sorted({*rows, *readings}):
        cells = (
            [f"{x:.9g}" for x in rows[t]] if t in rows else [f"{t:.9g}"] + [""] * len(motion[1:])
        )
        lines.append(",".join([*cells, f"{readings[t]:.9g}" if t in readings else ""]))
    return "\n".join(lines)


def slow(run: Columns) -> tuple[Array, Array]:
    """Return time stamps at 20 Hz (s), and at each the force (N) of the nearest sample."""
    time = np.arange(run["time_s"][0], run["time_s"][-1], 0.05)
    nearest = np.abs(run["time_s"][:, None] - time).argmin(axis=0)
    return run["time_s"][nearest], run["friction_n"][nearest]


def table(run: Columns) -> str:
    """Format the columns of a run as CSV."""
    rows = zip(*run.values(), strict=True)
    return "\n".join([",".join(run), *(",".join(f"{x:.9g}" for x in row) for row in rows)])


COLUMNS = """
[columns]
time_s = "time_s"
angle_rad = "angle_rad"
velocity_m_s = "velocity_m_s"
friction_n = "friction_n"
load_n = "load_n"
"""

TREATMENTS: dict[str, Callable[[Columns], str]] = {
    "as recorded": as_recorded,
    "10 ms late, interpolated": late(0.010),
    "20 ms late": late(0.020),
    "20 Hz, straight lines": drawn,
    "20 Hz, last value held": held,
    "20 Hz on its own clock": own_clock,
}


def main() -> None:
    argparse.ArgumentParser(description=(__doc__ or "").split("\n\n")[0]).parse_args()
    print("| force channel | verdict | named | held-out / noise | findings |")
    print("| --- | --- | --- | --- | --- |")
    with as_file(files("jbf") / "data" / "demo" / "plain") as plain:
        mapping = COLUMNS + (plain / "rig.toml").read_text()
        runs = {path.name: read(path) for path in sorted(plain.glob("*.csv"))}
    for name, treat in TREATMENTS.items():
        with tempfile.TemporaryDirectory() as folder:
            paths = [Path(folder) / run for run in runs]
            for path, columns in zip(paths, runs.values(), strict=True):
                path.write_text(treat(columns))
            (Path(folder) / "map.toml").write_text(mapping)
            recording = jbf.import_files(paths, Path(folder) / "map.toml")
            diagnosis = jbf.diagnose(recording.rig, recording.runs)
        named = ", ".join(diagnosis.effects) or "-"
        kinds = ", ".join(sorted({finding.kind for finding in diagnosis.findings})) or "-"
        error = diagnosis.steps[-1].held_out_rms / diagnosis.steps[-1].noise_rms
        print(f"| {name} | `{diagnosis.verdict}` | {named} | {error:.2f} | {kinds} |", flush=True)


def read(path: Path) -> Columns:
    """Read the columns of a run from a CSV file."""
    rows = np.genfromtxt(path, delimiter=",", names=True)
    return {name: rows[name] for name in rows.dtype.names}


if __name__ == "__main__":
    main()
