"""One campaign: simulate, diagnose, predict runs of the same rig that were never shown."""

from __future__ import annotations

import math
import time
from typing import Any

import jbf
import numpy as np
from plan import Task
from rigsim import Record, simulate_campaign
from score import judge

SLOWEST_M_S = 5e-4
Row = dict[str, Any]


def read(records: dict[str, Record]) -> list[jbf.Run]:
    """Simulated records as runs."""
    return [
        jbf.Run.from_arrays(
            r.time_s,
            r.velocity_m_s,
            r.friction_n,
            angle_rad=r.angle_rad,
            load_n=r.load_n,
            name=name,
        )
        for name, r in records.items()
    ]


def rig_of(truth: dict[str, Any]) -> jbf.Rig:
    """The rig whose load the simulator drew."""
    return jbf.Rig.thesis("4.2" if truth["base"]["load_n"] == 104.0 else "4.3")


def held_out(model: jbf.Model, runs: list[jbf.Run]) -> dict[str, float]:
    """RMS and mean absolute error of a model on runs, N, where the sign of the speed is known."""
    errors = []
    for run in runs:
        assert run.friction_n is not None
        kept = np.abs(run.velocity_m_s) >= SLOWEST_M_S
        errors.append((run.friction_n - model.predict(run))[kept])
    all_ = np.concatenate(errors)
    return {"rms_n": float(np.sqrt(np.mean(all_**2))), "mae_n": float(np.mean(np.abs(all_)))}


def simulate(task: Task, campaign: str) -> tuple[list[jbf.Run], dict[str, Any]]:
    """Runs of a task and the truth behind them."""
    records, truth = simulate_campaign(
        task.seed,
        task.effects,
        strength=task.strength,
        coloured=task.coloured,
        campaign=campaign,
        foreign=task.foreign,
    )
    return read(records), truth


def rivals(rig: jbf.Rig, runs: list[jbf.Run], others: list[jbf.Run]) -> dict[str, list[str]]:
    """What simpler rules name on the same runs.

    `lowest_mae`: the single effect (or none) that predicts other runs best, as whole models are
    ranked elsewhere. `bic`: effects added one by one while the Bayesian information criterion of
    a white residual falls.
    """

    def bic(fit: jbf.Fit) -> float:
        return fit.samples * 2.0 * math.log(fit.rms_n) + len(fit.parameters) * math.log(fit.samples)

    names = [e.name for e in jbf.effects().values()]
    bare = jbf.fit(rig, runs)
    best, lowest = [], held_out(bare.model, others)["mae_n"]
    chosen: list[str] = []
    score = bic(bare)
    while len(chosen) < 3:
        found = None
        for name in names:
            if name in chosen:
                continue
            try:
                fit = jbf.fit(rig, runs, effects=[*chosen, name])
            except jbf.InputError:
                continue
            if not chosen:
                error = held_out(fit.model, others)["mae_n"]
                if error < lowest:
                    best, lowest = [name], error
            if bic(fit) < score:
                score, found = bic(fit), name
        if found is None:
            break
        chosen.append(found)
    return {"lowest_mae": best, "bic": chosen, "always_adequate": []}


def work(task: Task, with_rivals: bool) -> Row:
    """Everything that the tables need of one campaign."""
    runs, truth = simulate(task, task.campaign)
    others, _ = simulate(task, "heldout")
    rig = rig_of(truth)
    begun = time.monotonic()
    found = jbf.diagnose(rig, runs)
    seconds = time.monotonic() - begun
    colour = math.sqrt(1.25) if task.coloured else 1.0
    alternatives = {k: list(v) for k, v in found.alternatives.items()}
    foreign = bool(task.foreign)
    row: Row = {
        "key": task.key,
        "kind": task.kind,
        "hidden": task.hidden,
        "strength": task.strength,
        "coloured": task.coloured,
        "verdict": found.verdict,
        "named": list(found.effects),
        "alternatives": alternatives,
        "judged": judge(task.effects, found.verdict, found.effects, alternatives, foreign=foreign),
        "held_out_over_noise": held_out(found.model, others)["rms_n"] / (truth["noise_n"] * colour),
        "effect_over_noise": max(truth["effect_to_noise"].values(), default=0.0) / colour,
        "unexplained": [str(r.description) for r in found.unexplained],
        "seconds": seconds,
    }
    if with_rivals:
        named = rivals(rig, runs, others)
        row["rivals"] = {
            rule: judge(task.effects, "missing" if names else "adequate", names, {})
            if not foreign
            else ("wrong" if names else "abstained")
            for rule, names in named.items()
        }
    return row
