"""Motor and load with an elastic belt between them, simulated with steps of 0.1 ms."""

import numpy as np
import pytest
from jbf import Drive, Model, Rig, Run, diagnose
from known_motions import quantised

RIG = Rig(drive=Drive("linear", "force"))
STEP_S = 1e-4
MOTOR_KG, LOAD_KG, STIFFNESS_N_M, DAMPING_N_S_M = 6.0, 14.0, 35e3, 60.0
COULOMB_N, VISCOUS_N_S_M = 25.0, 60.0
TRUTH = {
    "F_c": COULOMB_N,
    "F_s": COULOMB_N,
    "F_v": VISCOUS_N_S_M,
    "inertia.m_e": MOTOR_KG + LOAD_KG,
    "drive_compliance.k": STIFFNESS_N_M,
    "drive_compliance.c": DAMPING_N_S_M,
    "drive_compliance.J": LOAD_KG,
}


def belt_drive(seed: int, every: int, noise: float) -> Run:
    """Motor under position control that moves a load with Coulomb and viscous friction.

    Symplectic Euler steps. The force of a step is recorded half a step after its start. `noise`
    multiplies that of the readings.
    """
    random = np.random.default_rng([2613, seed])
    time_s = np.arange(0.0, 8.0, STEP_S)
    phases = random.uniform(0.0, 2.0 * np.pi, 3)
    waves = list(zip((0.1, 0.03, 0.006), (2.5 + seed, 8.2, 25.8), phases, strict=True))
    target = sum(a * np.sin(w * time_s + p) for a, w, p in waves)
    rate = sum(a * w * np.cos(w * time_s + p) for a, w, p in waves)
    x = load_x = float(target[0])
    v = load_v = float(rate[0])
    states = np.empty((len(time_s), 3))
    for k in range(len(time_s)):
        force = 3e4 * (target[k] - x) + 900.0 * (rate[k] - v)
        states[k] = x + 0.5 * v * STEP_S, v, force
        belt = STIFFNESS_N_M * (x - load_x) + DAMPING_N_S_M * (v - load_v)
        free = load_v + (belt - VISCOUS_N_S_M * load_v) * STEP_S / LOAD_KG
        # Friction may stop the load, but not reverse it.
        load_v = np.sign(free) * max(abs(free) - COULOMB_N * STEP_S / LOAD_KG, 0.0)
        v += (force - belt) * STEP_S / MOTOR_KG
        x, load_x = x + v * STEP_S, load_x + load_v * STEP_S
    x_m, v_m_s, force_n = states[::every].T
    count = len(x_m)
    return Run.from_arrays(
        time_s[::every],
        v_m_s + noise * 0.002 * random.standard_normal(count),
        force_n + noise * 0.6 * random.standard_normal(count),
        position_m=quantised(x_m, 5e-6) if noise > 0.0 else x_m,
        name=f"run {seed}",
    )


@pytest.mark.parametrize(("every", "largest_rms_n"), [(10, 0.15), (20, 0.3), (40, 0.8)])
def test_force_of_a_belt_drive_is_that_of_two_masses(every: int, largest_rms_n: float) -> None:
    """Samples of 1 to 4 ms; an error of the time of 0.1 ms would be one of 0.2 N."""
    run = belt_drive(0, every, 0.0)
    predicted = Model(RIG, "coulomb", ["inertia", "drive_compliance"], TRUTH).predict(run)
    # The initial state of the belt is unknown.
    settled = (run.time_s > 0.5) & np.isfinite(predicted)
    assert np.count_nonzero(settled) > 0.9 * len(run)
    error = (run.friction - predicted)[settled]
    assert np.sqrt(np.mean(error**2)) < largest_rms_n
    jerk = np.gradient(run.friction, run.time_s)[settled]
    delay_s = np.sum(error * jerk) / np.sum(jerk**2)
    assert abs(delay_s) < 1e-4


@pytest.mark.parametrize("stiffness", [0.1, 10.0, 1e3, 1e5, 1e7])
@pytest.mark.parametrize("damping", [1e-5, 1e-2, 1.0, 1e3])
@pytest.mark.parametrize("inertia", [1e-6, 1e-4, 1e-2, 1.0])
def test_force_is_bounded_where_the_steps_do_not_resolve_the_oscillation(
    stiffness: float, damping: float, inertia: float
) -> None:
    """The thesis's bearing with a friction below 30 N, at samples of 20 ms."""
    time_s = np.arange(0.0, 6.0, 0.02)
    angle = 4.0 * np.sin(2.0 * time_s)
    run = Run.from_arrays(time_s, 0.0127 * 8.0 * np.cos(2.0 * time_s), None, angle_rad=angle)
    values = {"f_m": 0.26, "U_tr_m_s": 0.06, "K0": 7.5e5, "gamma": 33.0}
    values |= {"drive_compliance.k": stiffness, "drive_compliance.c": damping}
    values |= {"drive_compliance.J": inertia}
    model = Model(Rig.thesis(), "journal", ["drive_compliance"], values)
    force = model.predict(run)
    assert np.all(np.abs(force[np.isfinite(force)]) < 30.0)
    assert np.count_nonzero(np.isfinite(force)) > 0.9 * len(run)


def test_elastic_belt_is_identified_without_a_delay() -> None:
    runs = [belt_drive(seed, 20, 1.0) for seed in range(3)]
    found = diagnose(RIG, runs, law="coulomb")
    assert found.verdict == "missing", found.summary()
    assert found.effects == ("drive_compliance",)
    assert all(finding.size < 5e-5 for finding in found.findings if finding.kind == "late_channel")
    for name in ("inertia.m_e", "drive_compliance.J", "drive_compliance.k", "F_c"):
        assert found.fit.params[name] == pytest.approx(TRUTH[name], rel=0.01)
    assert found.fit.rms < 1.1 * 0.6
