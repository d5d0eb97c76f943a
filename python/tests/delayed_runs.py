"""Coulomb friction recorded with known delays and clock drifts, and fits that start at the truth.

A force with delay d and drift c is recorded as `F(t - d - c (t - t_mid))`, `t_mid` in the middle of
the run. Two kinds of motion are used: reversing ones, which turn round about once a second, and
one-way ones, whose friction `F_c + F_v v` is linear in every parameter.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from by_hand import LAW, Array, coulomb
from jbf import Rig, Run
from jbf.estimation.campaign import Campaign
from jbf.estimation.minimum import settle
from jbf.estimation.noise import WHITE
from jbf.estimation.problem import Problem
from jbf.estimation.solution import Solution

STEP_S = 0.02
DURATION_S = 20.0
DELAY = ("time_delay",)
TAU = "time_delay.tau_s"
NOISE_N = 0.03
ONE_WAY_NOISE_N = 0.005


def reversing_speed(run: int, t: Array) -> Array:
    """Speed of a run that turns round, at rates of its own, m/s."""
    rate = 3.0 + 0.4 * run
    v: Array = 0.12 * np.sin(rate * t) + 0.05 * np.sin(0.618 * rate * t + run)
    return v


def one_way_speed(run: int, t: Array, swing: float = 0.05) -> Array:
    """Speed about 0.1 m/s, m/s; constant without `swing`."""
    rate = 3.0 + 0.4 * run
    v: Array = 0.1 + swing * (0.6 * np.sin(rate * t) + 0.4 * np.sin(0.618 * rate * t + run))
    return v


def one_way_acceleration(run: int, t: Array) -> Array:
    """Derivative of `one_way_speed` with respect to time, m/s^2."""
    rate = 3.0 + 0.4 * run
    slow = 0.618 * rate
    a: Array = 0.05 * (0.6 * rate * np.cos(rate * t) + 0.4 * slow * np.cos(slow * t + run))
    return a


def reversing_campaign(
    delays_s: Sequence[float],
    drift: float = 0.0,
    *,
    seed: int = 0,
    noise_n: float = NOISE_N,
    speed_noise_m_s: float = 0.0,
    durations_s: Sequence[float] = (DURATION_S,) * 4,
) -> Campaign:
    """Reversing runs; `delays_s` are those in the middle of each run.

    Without noise on the speed the sign of the motion is known at every sample.
    """
    random, runs = np.random.default_rng(seed), []
    for i, (delay_s, duration_s) in enumerate(zip(delays_s, durations_s, strict=False)):
        t = np.arange(0.0, duration_s + 0.01, STEP_S)
        v = reversing_speed(i, t - delay_s - drift * (t - 0.5 * duration_s))
        force = coulomb(t, v, v) + noise_n * random.standard_normal(len(t))
        speed = reversing_speed(i, t) + speed_noise_m_s * random.standard_normal(len(t))
        runs.append(Run.from_arrays(t, speed, force, name=f"run {i}"))
    return Campaign.prepare(Rig(), runs)


def one_way_campaign(
    delays_s: Sequence[float],
    drift: float = 0.0,
    *,
    seed: int = 0,
    noise_n: float = ONE_WAY_NOISE_N,
    constant_speed: int | None = None,
    durations_s: Sequence[float] = (DURATION_S,) * 4,
) -> Campaign:
    """One-way runs whose clock was right when each run started; one may keep its speed."""
    random, runs = np.random.default_rng(seed), []
    for i, (delay_s, duration_s) in enumerate(zip(delays_s, durations_s, strict=False)):
        swing = 0.0 if i == constant_speed else 0.05
        t = np.arange(0.0, duration_s + 0.01, STEP_S)
        v = one_way_speed(i, t - delay_s - drift * t, swing)
        force = coulomb(t, v, v) + noise_n * random.standard_normal(len(t))
        runs.append(Run.from_arrays(t, one_way_speed(i, t, swing), force, name=f"run {i}"))
    return Campaign.prepare(Rig(), runs)


def fitted(campaign: Campaign, effects: Sequence[str] = ()) -> tuple[Problem, Solution]:
    """Coulomb's law fitted to the runs as they are recorded, started at the truth."""
    problem = Problem(campaign, "coulomb", "journal", effects, {"F_s_n": 6.0})
    known = {"F_s_n": 6.0, **LAW, TAU: 0.01, "sensor_lag.tau_s": 0.01}
    start = problem.starts({name: known[name] for name in problem.names})[0]
    near = problem.solution(start, problem.samples_at(start), WHITE, False)
    return problem, settle(problem, near)


def value(problem: Problem, solution: Solution, name: str) -> float:
    """The value of a parameter in a solution."""
    return float(solution.values[problem.names.index(name)])
