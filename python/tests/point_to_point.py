"""Simulated axis whose position controller moves it from point to point and holds it between."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from jbf import Run
from scipy import signal

STEP_S, SUBSTEPS = 0.002, 4
COULOMB_N, BREAKAWAY_N, VISCOUS_N_S_M, MASS_KG = 8.0, 10.0, 15.0, 2.0
TRUTH = {"F_c": COULOMB_N, "F_v": VISCOUS_N_S_M, "inertia.m_e": MASS_KG}
STIFFNESS_N_M, DAMPING_N_S_M = 4.0e3, 160.0
ROUNDED_S = 0.1
COUNT_M, SPEED_NOISE_M_S, FORCE_NOISE_N = 1e-7, 1e-4, 0.3


def trapezoids(random: Any, duration_s: float) -> Any:
    """Reference speed (m/s) at each substep: rounded trapezoids in both directions, with pauses."""
    step_s, parts, direction = STEP_S / SUBSTEPS, [np.zeros(200)], 1.0
    while sum(map(len, parts)) * step_s < duration_s:
        top, ramp_s, flat_s, pause_s = random.uniform([0.1, 0.1, 0.1, 0.4], [0.5, 0.3, 0.5, 1.5])
        time_s = np.arange(0.0, 2.0 * ramp_s + flat_s, step_s)
        ends_s = np.minimum(time_s, 2.0 * ramp_s + flat_s - time_s)
        parts += [
            direction * top * np.clip(ends_s / ramp_s, 0.0, 1.0),
            np.zeros(int(pause_s / step_s)),
        ]
        direction = -direction
    speed = np.concatenate(parts)[: int(duration_s / step_s)]
    round_corners = np.full(int(ROUNDED_S / step_s), step_s / ROUNDED_S)
    return np.convolve(speed, round_corners)[: len(speed)]


def controlled(demand: Any, integral_1_s: float, bias_n: float) -> tuple[Any, Any, Any]:
    """Position (m), speed (m/s) and force of the drive (N) at each substep."""
    step_s = STEP_S / SUBSTEPS
    x, v, sum_m_s, target = 0.0, 0.0, 0.0, 0.0
    states = np.empty((len(demand), 3))
    for k, speed in enumerate(demand):
        target += speed * step_s
        sum_m_s += (target - x) * step_s
        follow = target - x + integral_1_s * sum_m_s
        force = STIFFNESS_N_M * follow + DAMPING_N_S_M * (speed - v) + bias_n
        if v == 0.0 and abs(force - bias_n) <= BREAKAWAY_N:
            states[k] = x, v, force
            continue
        # Viscous friction acts at the mean speed of the step.
        half = 0.5 * VISCOUS_N_S_M * step_s / MASS_KG
        free = ((1.0 - half) * v + (force - bias_n) * step_s / MASS_KG) / (1.0 + half)
        brake = COULOMB_N * step_s / MASS_KG / (1.0 + half)
        # Friction stops the axis within a step, but does not reverse it.
        new = np.sign(free) * max(abs(free) - brake, 0.0)
        new = 0.0 if v * new < 0.0 else float(new)
        # The force of a step is that at its midpoint.
        states[k] = x + 0.25 * (v + new) * step_s, 0.5 * (v + new), force
        x, v = x + 0.5 * (v + new) * step_s, new
    return states[:, 0], states[:, 1], states[:, 2]


def point_to_point(
    seeds: Sequence[int],
    *,
    duration_s: float = 20.0,
    integral_1_s: float = 0.0,
    bias_n: float = 0.0,
    lag_s: float = 0.0,
) -> list[Run]:
    """Recorded runs of 500 Hz.

    Parameters
    ----------
    integral_1_s
        Rate of the integral part: with it the force at rest rises until the axis creeps on.
    bias_n
        Constant load, which the controller holds at rest together with friction.
    lag_s
        Time constant of a first-order low-pass filter of the force.
    """
    runs = []
    for seed in seeds:
        random = np.random.default_rng(seed)
        x, v, force = controlled(trapezoids(random, duration_s), integral_1_s, bias_n)
        if lag_s > 0.0:
            decay = np.exp(-STEP_S / SUBSTEPS / lag_s)
            force, _ = signal.lfilter([1.0 - decay], [1.0, -decay], force, zi=[decay * force[0]])
        x, v, force = (state[::SUBSTEPS] for state in (x, v, force))
        runs.append(
            Run.from_arrays(
                STEP_S * np.arange(len(x)),
                v + SPEED_NOISE_M_S * random.standard_normal(len(x)),
                force + FORCE_NOISE_N * random.standard_normal(len(x)),
                position_m=np.round(x / COUNT_M) * COUNT_M,
                name=f"run_{seed}",
            )
        )
    return runs
