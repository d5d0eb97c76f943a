"""Fit every law in newtons to recordings of real machines, and diagnose them.

    .venv/bin/python benches/real_records.py FOLDER

FOLDER holds `emps/run.csv` (a ball-screw axis; its friction is the whole drive force) and
`tribometer/run.csv` (reciprocating sliding); columns time_s, position_m, velocity_m_s, friction_n.
The recordings are not distributed with jbf: without them a message is printed and nothing is done.
"""

from __future__ import annotations

import argparse
import sys
import time
from dataclasses import replace
from pathlib import Path

import jbf
import numpy as np
from jbf.records.motion.estimated_motion import estimate_motion

MASS_KG, OFFSET_N = 95.1, -3.2
"""Mass (kg) and force offset (N) of the ball-screw axis in its publication."""


def without_inertia(run: jbf.Run) -> jbf.Run:
    """Return the run with the inertial force and the offset subtracted from the drive force."""
    assert run.friction is not None
    acceleration = estimate_motion(run, None).acceleration
    friction = run.friction - MASS_KG * acceleration - OFFSET_N
    return replace(run, friction=friction, name=f"{run.name}, inertia taken off")


def table(title: str, run: jbf.Run) -> None:
    """Fit each law to a recording and print its RMS, its time and its parameters."""
    assert run.friction is not None
    print(f"{title}: {len(run)} samples, RMS of the record {np.std(run.friction):.3g} N")
    for law in jbf.laws().values():
        if law.needs_bearing:
            continue
        begun = time.monotonic()
        fit = jbf.fit(jbf.Rig(), [run], law=law.name)
        took = time.monotonic() - begun
        values = ", ".join(f"{n} {p.value:.4g}" for n, p in fit.parameters.items())
        print(f"  {law.name:16}{fit.rms:8.3f} N  {took:5.1f} s  {values}", flush=True)


def diagnosed(title: str, run: jbf.Run) -> None:
    """Diagnose a recording with the Coulomb law; print the added effects and the errors."""
    diagnosis = jbf.diagnose(jbf.Rig(), [run], law="coulomb")
    print(f"{title}: law coulomb, diagnosed in {diagnosis.elapsed_s:.0f} s: {diagnosis.verdict}")
    for step in diagnosis.steps:
        names = ", ".join(step.effects) or "the law alone"
        print(f"  {step.rms:8.3f} N, held-out half {step.held_out_rms:8.3f} N  {names}")


def main() -> int:
    """Fit and diagnose each available recording and print the results."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n\n")[0])
    parser.add_argument("folder", type=Path, nargs="?", help="the recordings")
    folder = parser.parse_args().folder
    if folder is None:
        print("skipped: name the folder of the recordings: python benches/real_records.py FOLDER")
        return 0
    for name in ("emps", "tribometer"):
        path = folder / name / "run.csv"
        if not path.is_file():
            print(f"skipped: there is no {path}")
            continue
        run = jbf.read_run(path)
        table(name, run)
        diagnosed(name, run)
        if name == "emps":
            table(f"{name}, inertia and offset taken off", without_inertia(run))
    return 0


if __name__ == "__main__":
    sys.exit(main())
