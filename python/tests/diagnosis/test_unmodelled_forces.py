"""Forces on a drive that are neither friction nor errors of the motion, such as impacts."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from jbf import Drive, Rig, Run, diagnose
from jbf.diagnosis.policy import DEFAULT
from jbf.diagnosis.residual_structure import find_residual_structure
from jbf.diagnosis.residual_structure.momentum import find_disturbances
from jbf.estimation.campaign import Campaign
from jbf.estimation.generalised_least_squares import with_motion_errors
from jbf.estimation.minimum import minimum
from jbf.estimation.problem import Problem
from jbf.estimation.solution import Solution
from known_motions import Array, quantised

RIG = Rig(drive=Drive("linear", "force"))
FINE_S, EVERY, DURATION_S = 0.001, 8, 14.0
INERTIA_KG_M2, COULOMB_N_M = 0.12, 0.9
MASS_KG, COULOMB_N, VISCOUS_N_S_M, NOISE_N = 95.0, 38.0, 30.0, 2.0


def shape(within: Array) -> Array:
    """Acceleration in a ramp relative to its mean; it rises and falls in a tenth of the ramp."""
    return np.clip(np.minimum(within, 1.0 - within) / 0.1, 0.0, 1.0) / 0.9


def strokes(random: np.random.Generator) -> tuple[Array, Array, Array]:
    """Position, speed and acceleration of strokes of 0.9 m, with rests between them."""
    time_s = np.arange(0.0, DURATION_S, FINE_S)
    acceleration = np.zeros(len(time_s))
    begin_s, direction = 0.5, 1.0
    while begin_s < DURATION_S:
        ramp_s, flat_s = random.uniform(0.5, 0.9), random.uniform(0.6, 1.2)
        top = 0.9 / (ramp_s + flat_s)
        for at_s, sign in ((begin_s, 1.0), (begin_s + ramp_s + flat_s, -1.0)):
            within = np.clip((time_s - at_s) / ramp_s, 0.0, 1.0)
            acceleration += direction * sign * top / ramp_s * shape(within)
        begin_s += 2.0 * ramp_s + flat_s + random.uniform(0.4, 1.0)
        direction = -direction
    speed = np.cumsum(acceleration) * FINE_S
    return np.cumsum(speed) * FINE_S, speed, acceleration


def none(position: Array, random: np.random.Generator) -> Array:
    return np.zeros(len(position))


def impacts(position: Array, random: np.random.Generator) -> Array:
    """A pulse of 40 ms and random size at each passage of one place."""
    force = np.zeros(len(position))
    for k in np.flatnonzero(np.diff(np.sign(position - 0.12)) != 0):
        pulse = np.sin(np.pi * np.arange(40) / 40.0)[: len(force) - k]
        force[k : k + 40] += random.uniform(50.0, 140.0) * pulse
    return force


def recorded(seed: int, more: Callable[..., Array]) -> Run:
    """Record of 125 Hz with a counted position, and no speed."""
    random = np.random.default_rng([2611, seed])
    position, speed, acceleration = strokes(random)
    force = COULOMB_N * np.sign(np.where(np.abs(speed) < 1e-9, 0.0, speed)) + VISCOUS_N_S_M * speed
    force += MASS_KG * acceleration + more(position, random)
    force = force[::EVERY] + NOISE_N * random.standard_normal(len(force[::EVERY]))
    time_s = np.arange(len(force)) * FINE_S * EVERY
    counted = quantised(position[::EVERY], 1e-4)
    return Run.from_arrays(time_s, None, force, position_m=counted, name=f"run {seed}")


def controlled(seed: int, knock_n_m: float) -> Run:
    """Joint under position control that is knocked for 15 ms once a second; record of 250 Hz."""
    random = np.random.default_rng([2612, seed])
    time_s = np.arange(0.0, 12.0, FINE_S)
    phases = random.uniform(0.0, 2.0 * np.pi, 3)
    waves = list(zip((0.5, 0.2, 0.05), (1.1 + 0.3 * seed, 2.9, 6.7), phases, strict=True))
    target = sum(a * np.sin(w * time_s + p) for a, w, p in waves)
    rate = sum(a * w * np.cos(w * time_s + p) for a, w, p in waves)
    push = np.zeros(len(time_s))
    for begin in np.arange(700, len(time_s) - 20, 1000) + random.integers(-200, 200):
        push[begin : begin + 15] = knock_n_m * random.choice([-1.0, 1.0])
    x, v, states = float(target[0]), float(rate[0]), np.empty((len(time_s), 2))
    for k in range(len(time_s)):
        torque = 60.0 * (target[k] - x) + 4.0 * (rate[k] - v)
        states[k] = x, torque
        free = v + (torque + push[k]) * FINE_S / INERTIA_KG_M2
        # Friction may stop the joint, but not reverse it.
        new = np.sign(free) * max(abs(free) - COULOMB_N_M * FINE_S / INERTIA_KG_M2, 0.0)
        x, v = x + 0.5 * (v + new) * FINE_S, float(new)
    angle = quantised(states[::4, 0], 2.0 * np.pi / 2**18)
    torque = states[::4, 1] + 0.05 * random.standard_normal(len(angle))
    return Run.from_arrays(time_s[::4], None, torque, angle_rad=angle, name=f"run {seed}")


@pytest.mark.parametrize(("more", "axes"), [(none, []), (impacts, ["momentum"])])
def test_impacts_are_not_taken_for_errors_of_the_motion(
    more: Callable[..., Array], axes: list[str]
) -> None:
    runs = [recorded(seed, more) for seed in range(3)]
    found = diagnose(RIG, runs, law="coulomb")
    assert found.effects == ()
    assert found.verdict == ("unexplained" if axes else "adequate"), found.summary()
    assert [r.axis for r in found.residual_structure] == axes
    assert found.fit.params["inertia.m_e"] == pytest.approx(MASS_KG, rel=0.01)


def fitted_without_disturbance() -> tuple[Problem, Solution]:
    """A fit with errors of the motion to two runs without impacts."""
    campaign = Campaign.prepare(RIG, [recorded(seed, none) for seed in range(2)])
    plain = Problem(campaign, "coulomb", "journal", ("inertia",))
    return with_motion_errors(plain, minimum(plain, [{}]))


def test_errors_of_the_motion_beyond_three_times_their_standard_errors_are_structure() -> None:
    problem, solution = fitted_without_disturbance()
    motion = solution.samples.motion
    assert motion is not None
    assert motion.scale < 1.0
    for scale, axes in ((2.9, []), (3.1, ["motion"])):
        samples = replace(solution.samples, motion=replace(motion, scale=scale))
        found = find_residual_structure(problem, replace(solution, samples=samples))
        assert [r.axis for r in found] == axes


def test_momentum_does_not_depend_on_the_estimated_acceleration() -> None:
    """The acceleration is wrong by 2 m/s^2 at each sample, and the residual by the mass times it.

    A pulse of the force is found nevertheless.
    """
    problem, solution = fitted_without_disturbance()
    samples, motion = solution.samples, solution.samples.motion
    assert motion is not None
    policy = DEFAULT.with_values({"momentum.min_share": 0.0})
    prepared, residuals = [], []
    for run, (p, residual) in enumerate(
        zip(problem.campaign.prepared, solution.residuals, strict=True)
    ):
        error = 2.0 * np.random.default_rng(run).standard_normal(len(residual))
        moved = replace(p.motion, acceleration=p.motion.acceleration + error)
        prepared.append(replace(p, motion=moved))
        residuals.append(residual - motion.sensitivity[run][:, 2] * error)
    assert find_disturbances(prepared, samples, residuals, policy) == []
    moving = np.flatnonzero(samples.counted[1] & (np.abs(prepared[1].motion.velocity) > 0.3))
    residuals[1][moving[20:26]] += 200.0
    (found,) = find_disturbances(prepared, samples, residuals, policy)
    assert found.where.startswith("1 disturbance")
    assert f"at {prepared[1].run.time_s[moving[22]]:.1f} s in run 1" in found.where


@pytest.mark.parametrize(("knock_n_m", "axes"), [(0.0, set()), (3.0, {"momentum"})])
def test_knocks_that_move_a_joint_are_not_taken_for_errors_of_its_motion(
    knock_n_m: float, axes: set[str]
) -> None:
    runs = [controlled(seed, knock_n_m) for seed in range(2)]
    found = diagnose(Rig(drive=Drive("rotary", "torque")), runs, law="coulomb")
    assert found.effects == ()
    assert {r.axis for r in found.residual_structure} == axes, found.summary()
    assert found.fit.params["inertia.m_e"] == pytest.approx(INERTIA_KG_M2, rel=0.02)
    assert found.fit.params["F_c"] == pytest.approx(COULOMB_N_M, rel=0.02)
