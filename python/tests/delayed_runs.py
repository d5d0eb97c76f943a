"""Coulomb friction recorded with known delays and clock drifts, and fits with true starting values.

With delay d and clock drift c the force recorded at time t of a run of duration T is

- `F(t - d - c (t - T / 2))` in `reversing_campaign`: d is the delay in the middle of the run;
- `F(t - d - c t)` in `one_way_campaign`: d is the delay at the start of the run, and the delay in
  its middle is `d + c T / 2`.

Reversing motions reverse about once a second. The friction `F_c + F_v v` of unidirectional motions
is linear in every parameter.
"""

from collections.abc import Sequence

import numpy as np
from by_hand import Array, coulomb
from jbf import Rig, Run
from jbf.estimation.campaign import Campaign
from jbf.estimation.problem import Problem
from jbf.estimation.solution import Solution
from linear_campaigns import fit_from_truth

STEP_S = 0.02
DURATION_S = 20.0
DELAY = ("time_delay",)
TAU = "time_delay.tau_s"
NOISE_N = 0.03
ONE_WAY_NOISE_N = 0.005


def reversing_speed(run: int, t: Array) -> Array:
    """Speed of a reversing run, m/s; its frequencies depend on the number of the run."""
    rate = 3.0 + 0.4 * run
    v: Array = 0.12 * np.sin(rate * t) + 0.05 * np.sin(0.618 * rate * t + run)
    return v


def one_way_speed(run: int, t: Array, swing: float = 0.05) -> Array:
    """Speed that varies about 0.1 m/s, m/s; constant if `swing` is zero."""
    rate = 3.0 + 0.4 * run
    v: Array = 0.1 + swing * (0.6 * np.sin(rate * t) + 0.4 * np.sin(0.618 * rate * t + run))
    return v


def one_way_acceleration(run: int, t: Array, swing: float = 0.05) -> Array:
    """Derivative of `one_way_speed` with the same `swing` with respect to time, m/s^2."""
    rate = 3.0 + 0.4 * run
    slow = 0.618 * rate
    a: Array = swing * (0.6 * rate * np.cos(rate * t) + 0.4 * slow * np.cos(slow * t + run))
    return a


def reversing_campaign(
    delays_s: Sequence[float],
    drift: float = 0.0,
    *,
    seed: int = 0,
    noise_rms: float = NOISE_N,
    speed_noise_m_s: float = 0.0,
) -> Campaign:
    """Reversing runs of 20 s; `delays_s` are those in the middle of each run.

    Without noise on the speed the sign of the motion is known at every sample.
    """
    random, runs = np.random.default_rng(seed), []
    t = np.arange(0.0, DURATION_S + 0.01, STEP_S)
    for i, delay_s in enumerate(delays_s):
        v = reversing_speed(i, t - delay_s - drift * (t - 0.5 * DURATION_S))
        force = coulomb(t, v, v) + noise_rms * random.standard_normal(len(t))
        speed = reversing_speed(i, t) + speed_noise_m_s * random.standard_normal(len(t))
        runs.append(Run.from_arrays(t, speed, force, name=f"run {i}"))
    return Campaign.prepare(Rig(), runs)


def one_way_campaign(
    delays_s: Sequence[float],
    drift: float = 0.0,
    *,
    seed: int = 0,
    noise_rms: float = ONE_WAY_NOISE_N,
    constant_speed: int | None = None,
    durations_s: Sequence[float] | None = None,
) -> Campaign:
    """Unidirectional runs of 20 s by default; `delays_s` are those at the start of each run.

    The run with the number `constant_speed` has a constant speed.
    """
    durations = (DURATION_S,) * len(delays_s) if durations_s is None else durations_s
    random, runs = np.random.default_rng(seed), []
    for i, (delay_s, duration_s) in enumerate(zip(delays_s, durations, strict=True)):
        swing = 0.0 if i == constant_speed else 0.05
        t = np.arange(0.0, duration_s + 0.01, STEP_S)
        v = one_way_speed(i, t - delay_s - drift * t, swing)
        force = coulomb(t, v, v) + noise_rms * random.standard_normal(len(t))
        runs.append(Run.from_arrays(t, one_way_speed(i, t, swing), force, name=f"run {i}"))
    return Campaign.prepare(Rig(), runs)


def fitted(campaign: Campaign, effects: Sequence[str] = ()) -> tuple[Problem, Solution]:
    """Coulomb's law fitted to the uncorrected runs."""
    return fit_from_truth(campaign, *effects)


def value(problem: Problem, solution: Solution, name: str) -> float:
    """The value of a parameter in a solution."""
    return float(solution.values[problem.names.index(name)])
