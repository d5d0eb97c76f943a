"""Weight and inertia of a swinging link, which a diagnosis finds only together."""

from dataclasses import replace

import numpy as np
from jbf import Diagnosis, Rig, Run, diagnose
from jbf.records.drive import Drive

COULOMB, VISCOUS, INERTIA, WEIGHT, NOISE = 0.12, 0.012, 0.009, 0.3, 0.012


def swinging(seed: int) -> Run:
    """Twelve seconds of a link that is driven to and fro by two sines."""
    random = np.random.default_rng(seed)
    time_s = np.arange(0.0, 12.0, 0.02)
    angle = velocity = acceleration = 0.0
    for size, rad_s in ((0.9, 1.9), (0.35, random.uniform(5.0, 7.0))):
        phase = rad_s * time_s + random.uniform(0.0, 6.28)
        angle = angle + size * np.sin(phase)
        velocity = velocity + size * rad_s * np.cos(phase)
        acceleration = acceleration - size * rad_s**2 * np.sin(phase)
    torque = COULOMB * np.sign(velocity) + VISCOUS * velocity
    torque = torque + WEIGHT * np.sin(angle) + INERTIA * acceleration
    return Run.from_arrays(
        time_s,
        velocity + random.normal(0.0, 0.005, len(time_s)),
        torque + random.normal(0.0, NOISE, len(time_s)),
        angle_rad=angle,
        name=f"run_{seed}",
    )


RUNS = [swinging(seed) for seed in (1, 2, 3, 4)]
DRIVE = Rig(drive=Drive("rotary", "torque"))


def assert_machine_is_found(found: Diagnosis) -> None:
    assert found.steps[-1].holdout_rms_n < 1.1 * NOISE
    for name, true in (("inertia_leak.m_e_kg", INERTIA), ("gravity.G_n", WEIGHT)):
        parameter = found.model.parameters[name]
        assert parameter.stderr is not None
        assert abs(parameter.value - true) < 3.0 * parameter.stderr, name


def test_weight_and_inertia_of_a_drive_are_its_machine_and_no_missing_effects() -> None:
    found = diagnose(DRIVE, RUNS, law="coulomb")
    assert found.verdict == "adequate", found.summary()
    assert (found.machine, found.effects) == (("inertia_leak", "gravity"), ())
    assert found.to_dict()["machine"] == ["inertia_leak", "gravity"]
    assert found.steps[0].effects == ("inertia_leak", "gravity")
    assert "the machine's own inertia_leak and gravity" in " ".join(found.summary().split())
    assert_machine_is_found(found)


def test_weight_and_inertia_without_a_drive_are_found_together() -> None:
    """Neither of them alone has evidence; without [drive] they are named."""
    found = diagnose(Rig(), RUNS, law="coulomb")
    assert set(found.effects) == {"inertia_leak", "gravity"}
    assert found.machine == ()
    assert_machine_is_found(found)


def test_effect_is_named_next_to_the_machine_of_a_drive() -> None:
    def with_cogging(run: Run) -> Run:
        ripple = 0.08 * np.sin(23.0 * np.asarray(run.angle_rad) + 0.4)
        return replace(run, friction_n=run.friction_n + ripple)

    found = diagnose(DRIVE, [with_cogging(run) for run in RUNS], law="coulomb")
    assert found.verdict == "missing", found.summary()
    assert found.effects == ("cogging",)
    assert set(found.machine) == {"inertia_leak", "gravity"}
    assert_machine_is_found(found)


def test_machine_terms_that_the_runs_do_not_need_are_left_out() -> None:
    rng = np.random.default_rng(3)
    runs = []
    for k in range(3):
        time = 0.01 * np.arange(2000)
        speed = (0.1 + 0.1 * k) * np.sin(1.3 * time)
        force = 5.0 * np.sign(speed) + 8.0 * speed + 0.05 * rng.normal(size=2000)
        runs.append(Run.from_arrays(time, speed, force, name=f"run{k}"))
    runs = [replace(r, quantities=Drive("linear", "force").quantities) for r in runs]
    found = diagnose(Rig(drive=Drive("linear", "force")), runs, law="coulomb")
    assert (found.verdict, found.machine, found.effects) == ("adequate", (), ())
