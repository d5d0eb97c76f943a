"""Runs whose force is late by times that are known, of a law that made them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from by_hand import LAW, Array, coulomb
from jbf import Rig, Run
from jbf.diagnosis.policy import DEFAULT
from jbf.estimation.campaign import Campaign
from jbf.estimation.lateness import Lateness, lateness
from jbf.estimation.minimum import settle
from jbf.estimation.noise import WHITE
from jbf.estimation.problem import Problem
from jbf.estimation.solution import Solution

CHANCE = DEFAULT.deviation_chance
NOISE_N = 0.03
LASTS_S = 20.0
DIFFER_S = (4e-3, -2e-3, 9e-3, 1e-3)
DELAY = ("time_delay",)


def speed(run: int, t: Array) -> Array:
    """Turns round, in each run at times of its own."""
    rate = 3.0 + 0.4 * run
    v: Array = 0.12 * np.sin(rate * t) + 0.05 * np.sin(0.618 * rate * t + run)
    return v


def campaign(late_s: Sequence[float], drift: float = 0.0, *, seed: int = 0) -> Campaign:
    """Motions as they were, and the law's force at the instants at which it was read."""
    random = np.random.default_rng(seed)
    t = np.arange(0.0, LASTS_S + 0.01, 0.02)
    runs = []
    for i, late in enumerate(late_s):
        at = t - late - drift * (t - 0.5 * LASTS_S)
        v = speed(i, at)
        force = coulomb(at, v, v) + NOISE_N * random.standard_normal(len(t))
        runs.append(Run.from_arrays(t, speed(i, t), force, name=f"run {i}"))
    return Campaign.prepare(Rig(), runs)


def fitted(campaign: Campaign, effects: Sequence[str] = ()) -> tuple[Problem, Solution]:
    """The law that made the runs, fitted to them as they are, from where it truly is."""
    problem = Problem(campaign, "coulomb", "journal", effects, {"F_s_n": 6.0})
    known = {"F_s_n": 6.0, **LAW, "time_delay.tau_s": 0.01}
    start = problem.starts({n: known[n] for n in problem.names})[0]
    near = problem.solution(start, problem.samples_at(start), WHITE, False)
    return problem, settle(problem, near)


def told(
    late_s: Sequence[float], drift: float = 0.0, effects: Sequence[str] = (), *, seed: int = 0
) -> Lateness | None:
    return lateness(*fitted(campaign(late_s, drift, seed=seed), effects), 0, CHANCE)
