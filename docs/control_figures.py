"""Print the numbers in docs/control.md that no `jbf control` command prints (half a minute).

`.venv/bin/python docs/control_figures.py`
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from jbf import Model
from jbf.control import TASKS, Learning, Observed, run, thesis_model, tune
from jbf.control.assumptions import on_the_journal_clock
from jbf.control.bench import THESIS_RIG
from jbf.control.schemes import LISTED_VOLTS
from jbf.control.tuning import LAW_RAD_S

LOGGED = 11
"""Interval of the log in the program of Cohn (1998), in steps of a 50 s run."""


def ablation() -> None:
    """Print the tracking errors of the compensator with an observer, without each of its parts."""
    model, rigid = thesis_model(), thesis_model(elastic="nothing")
    settings = tune(model)
    variants = {
        "observed": Observed(model),
        "with the thesis's position gains": Observed(
            model, replace(settings, loop_rad_s=LAW_RAD_S)
        ),
        "without a model of the elastic belt": Observed(rigid),
        "the observer without a model": Observed(
            thesis_model(elastic="nothing", f_m=1e-4, gamma=1e-3), settings
        ),
        "the model, no disturbance learned": Observed(
            model, replace(settings, level_limit_v=0.0, rest_limit_v=0.0)
        ),
    }
    best = [min(run(None, s, t).true_rms for s in ("learning", "coulomb")) for t in TASKS.values()]
    print("| | " + " | ".join(TASKS) + " |")
    print("| better of the thesis's two | " + " | ".join(f"{e:.3g}" for e in best) + " |")
    for name, scheme in variants.items():
        errors = (run(None, scheme, task).true_rms for task in TASKS.values())
        print(f"| {name} | " + " | ".join(f"{e:.3g}" for e in errors) + " |")


def starts() -> None:
    """Print the peak errors at the start, with friction that grows while the rig is at rest."""
    values = {n: p.value for n, p in thesis_model().parameters.items()}
    for a in (0.0, 0.05, 0.1):
        model = Model(
            THESIS_RIG,
            effects=("drive_compliance", "dwell_stiction"),
            parameters={**values, "dwell_stiction.a": a, "dwell_stiction.t_0_s": 1.0},
            clock="thesis",
        )
        for row in ("position sine", "position triangle"):
            peaks = [run(model, s, TASKS[row]).peak for s in ("none", Learning(), "coulomb")]
            print(f"dwell_stiction {a:g}, {row}: " + ", ".join(f"{p:.3f}" for p in peaks))


def reversals() -> None:
    """Print the peak errors at slow reversals: all steps, logged steps, and more damping."""
    damped = thesis_model(**{"drive_compliance.c": 1.0})
    for row in ("velocity sine", "velocity triangle"):
        for scheme in ("learning", "coulomb"):
            r = run(None, scheme, TASKS[row])
            error = np.abs(r.error[r.time_s >= r.task.skip_s])
            logged = min(float(np.max(error[first::LOGGED])) for first in range(LOGGED))
            more = run(damped, Learning() if scheme == "learning" else scheme, TASKS[row]).peak
            print(
                f"{row}, {scheme}: peak {r.peak:.3f}, logged at least {logged:.3f}, "
                f"twice the damping {more:.3f}"
            )


def relay() -> None:
    """Print the rate of reversals in the position sine, and the largest compensation voltage."""
    for volts in (None, LISTED_VOLTS):
        r = run(None, Learning(volts=volts), replace(TASKS["position sine"], seconds=25.0))
        turns = np.sum(np.diff(np.sign(r.velocity_rad_s)) != 0.0) / r.task.seconds
        most = np.max(np.abs(r.compensation_v))
        print(f"scale {volts or 'of the rig'}: {turns:.0f} turns per second, {most:.2f} V")


if __name__ == "__main__":
    ablation()
    starts()
    reversals()
    relay()
    print(
        f"film on the journal clock: worst fitted cell {100.0 * on_the_journal_clock():.0f} % off"
    )
