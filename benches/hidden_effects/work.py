"""Simulation, diagnosis and held-out prediction of one campaign."""

from __future__ import annotations

import math
import time
from typing import Any

import jbf
import numpy as np
from jbf.diagnosis.experiment_design.excitations import Limits, excitations, run_from_motion
from jbf.estimation.campaign import Campaign as Prepared
from motion_errors import held_out
from plan import Task
from rigruns import errors_in_sigma, simulated
from rigsim import Campaign
from rigsim.campaign import standard
from rigsim.motions import polyline
from rivals import RULES, Rivals
from score import judge

Row = dict[str, Any]
WIDTH = 1.959964
"""Half-width of a 95 % interval in standard errors."""


def simulate(task: Task, campaign: str | Campaign) -> tuple[jbf.Rig, list[jbf.Run], dict[str, Any]]:
    """Simulate the campaign of a task; return the rig, its runs and the true values."""
    return simulated(
        task.seed,
        task.effects,
        strength=task.strength,
        coloured=task.coloured,
        campaign=campaign,
        foreign=task.foreign,
    )


def after_run(task: Task, run: jbf.Run) -> str:
    """Assess the diagnosis of the task's campaign with an additional run."""
    # Every sample is used as a knot because a fast sine has few samples.
    knots = zip(run.time_s.tolist(), run.velocity.tolist(), strict=True)
    first = standard(task.campaign)
    more = Campaign(first.name, (*first.motions, polyline("next", list(knots))), first.load_shares)
    rig, runs, _ = simulate(task, more)
    again = jbf.diagnose(rig, runs)
    alternatives = {k: list(v) for k, v in again.alternatives.items()}
    return judge(task.effects, again.verdict, again.effects, alternatives)


def at_random(task: Task, rig: jbf.Rig, runs: list[jbf.Run], like: jbf.Run) -> jbf.Run:
    """Return a run with a random motion of the rig, as long as the run `like`."""
    step_s = float(np.median(np.diff(like.time_s)))
    limits = Limits(duration_s=len(like) * step_s).filled(Prepared.prepare(rig, runs))
    every = list(excitations(limits, step_s))
    chosen = every[int(np.random.default_rng(task.seed).integers(len(every)))]
    return run_from_motion(rig, chosen, step_s, linear=False)


def next_runs(task: Task, diagnosis: jbf.Diagnosis, rig: jbf.Rig, runs: list[jbf.Run]) -> Row:
    """Assess the diagnosis with the proposed run added, and with a random run added.

    Both results are None if no run was proposed.
    """
    if diagnosis.experiment is None:
        return {"after_next_run": None}
    proposed = diagnosis.experiment.run
    return {
        "after_next_run": after_run(task, proposed),
        "after_random_run": after_run(task, at_random(task, rig, runs, proposed)),
    }


def work(task: Task, with_rivals: bool) -> Row:
    """Simulate and diagnose a campaign; return its row of results for the tables."""
    rig, runs, truth = simulate(task, task.campaign)
    _, others, _ = simulate(task, "heldout")
    begun = time.monotonic()
    diagnosis = jbf.diagnose(rig, runs)
    seconds = time.monotonic() - begun
    colour = math.sqrt(1.25) if task.coloured else 1.0
    alternatives = {k: list(v) for k, v in diagnosis.alternatives.items()}
    foreign = bool(task.foreign)
    row: Row = {
        "key": task.key,
        "kind": task.kind,
        "hidden": task.hidden,
        "strength": task.strength,
        "coloured": task.coloured,
        "verdict": diagnosis.verdict,
        "named": list(diagnosis.effects),
        "alternatives": alternatives,
        "judged": judge(
            task.effects,
            diagnosis.verdict,
            diagnosis.effects,
            alternatives,
            foreign=foreign,
            unseen=diagnosis.not_detectable,
        ),
        "not_detectable": list(diagnosis.not_detectable),
        "held_out_over_noise": held_out(diagnosis.model, others)["rms"]
        / (truth["noise_n"] * colour),
        "effect_over_noise": max(truth["effect_to_noise"].values(), default=0.0) / colour,
        "residual_structure": [str(r.where) for r in diagnosis.residual_structure],
        "rms_over_floor": diagnosis.steps[-1].rms / diagnosis.steps[-1].noise_rms,
        "held_out_over_rms": diagnosis.steps[-1].held_out_rms / diagnosis.steps[-1].rms,
        "seconds": seconds,
    }
    if row["judged"] == "right" and not foreign:
        errors = errors_in_sigma(diagnosis.fit, truth["base"], truth["effects"]).values()
        known = [abs(z) for z in errors if math.isfinite(z)]
        row["intervals"], row["covered"] = len(known), sum(z < WIDTH for z in known)
    if task.kind == "tied":
        row |= next_runs(task, diagnosis, rig, runs)
    if with_rivals:
        rivals = Rivals(rig, runs, others)
        row["rivals"] = {}
        for rule, choose in RULES.items():
            names = choose(rivals)
            verdict = "missing" if names else "adequate"
            row["rivals"][rule] = judge(task.effects, verdict, names, {}, foreign=foreign)
    return row
