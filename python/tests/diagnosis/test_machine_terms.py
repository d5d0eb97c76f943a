"""Weight and inertia of a swinging link, which a diagnosis identifies only together."""

from dataclasses import replace

import numpy as np
import pytest
from jbf import Diagnosis, Rig, Run, diagnose, fit
from jbf.records.drive import Drive

COULOMB, VISCOUS, INERTIA, WEIGHT, NOISE = 0.12, 0.012, 0.009, 0.3, 0.012


def swinging(seed: int) -> Run:
    """Run of 12 s of a link that follows the sum of two sines."""
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


RUNS = [swinging(seed) for seed in (1, 2, 3)]
DRIVE = Rig(drive=Drive("rotary", "torque"))


def assert_machine_is_found(diagnosis: Diagnosis) -> None:
    assert diagnosis.steps[-1].held_out_rms < 1.1 * NOISE
    for name, true in (("inertia.m_e", INERTIA), ("gravity.G", WEIGHT)):
        parameter = diagnosis.model.parameters[name]
        assert parameter.stderr is not None
        assert abs(parameter.value - true) < 3.0 * parameter.stderr, name


def test_weight_and_inertia_of_a_drive_are_machine_terms_and_not_missing_effects() -> None:
    found = diagnose(DRIVE, RUNS, law="coulomb")
    assert found.verdict == "adequate", found.summary()
    assert (found.machine, found.effects) == (("inertia", "gravity"), ())
    assert found.to_dict()["machine"] == ["inertia", "gravity"]
    assert found.steps[0].effects == ("inertia", "gravity")
    assert "inertia and gravity" in " ".join(found.summary().split())
    assert_machine_is_found(found)


def test_weight_and_inertia_of_a_rig_without_a_drive_are_both_named_as_effects() -> None:
    """Neither effect has evidence without the other; without [drive] they are named as effects."""
    found = diagnose(Rig(), RUNS, law="coulomb")
    assert set(found.effects) == {"inertia", "gravity"}
    assert found.machine == ()
    assert_machine_is_found(found)


def test_effect_is_named_in_addition_to_the_machine_terms_of_a_drive() -> None:
    def with_cogging(run: Run) -> Run:
        ripple = 0.08 * np.sin(23.0 * np.asarray(run.angle_rad) + 0.4)
        return replace(run, friction=run.friction + ripple)

    found = diagnose(DRIVE, [with_cogging(run) for run in RUNS], law="coulomb")
    assert found.verdict == "missing", found.summary()
    assert found.effects == ("cogging",)
    assert set(found.machine) == {"inertia", "gravity"}
    assert_machine_is_found(found)


def test_viscous_friction_that_differs_by_direction_is_named_without_an_offset() -> None:
    """With an offset, friction that differs by direction in full gives the same predictions."""

    def with_asymmetry(run: Run) -> Run:
        return replace(run, friction=run.friction + 0.004 * np.abs(run.velocity))

    found = diagnose(DRIVE, [with_asymmetry(run) for run in RUNS])
    assert (found.verdict, found.effects) == ("missing", ("viscous_asymmetry",)), found.summary()
    assert set(found.machine) == {"inertia", "gravity"}
    assert_machine_is_found(found)


def test_default_law_without_a_bearing_is_coulomb_friction() -> None:
    assert fit(DRIVE, RUNS[:1]).model.law == "coulomb"
    time = 0.01 * np.arange(200)
    speed = 0.1 * np.sin(6.0 * time)
    run = Run.from_arrays(time, speed, 5.0 * np.sign(speed) + 8.0 * speed)
    assert fit(Rig(), [run]).model.law == "coulomb"


def test_machine_terms_without_influence_on_the_runs_are_omitted() -> None:
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


def swept(size: float, hertz: float, rng: np.random.Generator) -> Run:
    """A joint with Coulomb friction 3 N m, viscous friction 12 N m s/rad, inertia 5.9 kg m^2,
    weight 3.9 N m, offset 0.4 N m and noise 0.2 N m."""
    time = 0.01 * np.arange(2400)
    rates = 2.0 * np.pi * hertz * np.array([1.0, 0.37])
    phases = np.outer(rates, time) + np.array([[0.0], [1.0]])
    sizes = size * np.array([1.0, 0.3])
    angle = sizes @ np.sin(phases)
    speed = (sizes * rates) @ np.cos(phases)
    acceleration = -(sizes * rates**2) @ np.sin(phases)
    torque = 3.0 * np.sign(speed) + 12.0 * speed + 5.9 * acceleration
    torque += 3.9 * np.sin(angle) + 0.4 + 0.2 * rng.normal(size=len(time))
    read = angle + 2e-5 * rng.normal(size=len(time))
    made = Run.from_arrays(time, speed, torque, angle_rad=read, name=f"{size}_{hertz}")
    return replace(made, quantities=DRIVE.quantities)


@pytest.mark.extended
def test_weight_is_identified_in_the_presence_of_a_large_inertia() -> None:
    """A joint search from the starting values of all terms ends at a weight of zero."""
    rng = np.random.default_rng(5)
    plan = ((0.6, 0.3), (0.4, 0.6), (0.8, 0.25))
    found = diagnose(DRIVE, [swept(*motion, rng) for motion in plan], law="coulomb")
    assert set(found.machine) == {"sensor_offset", "inertia", "gravity"}, found.summary()
    assert found.verdict == "adequate"
    parameters = found.model.parameters
    for name, true in {"gravity.G": 3.9, "inertia.m_e": 5.9, "F_c": 3.0}.items():
        assert abs(parameters[name].value / true - 1.0) < 0.01, name


def test_friction_that_differs_by_direction_is_an_alternative_of_the_offset() -> None:
    """5.6 N forward and 4.4 N back equal 5 N and an offset of 0.6 N at constant friction."""
    rng = np.random.default_rng(4)
    runs = []
    for k in range(3):
        time = 0.01 * np.arange(2000)
        speed = (0.1 + 0.1 * k) * np.sin(1.3 * time)
        force = np.where(speed > 0.0, 5.6, -4.4) + 8.0 * speed + 0.05 * rng.normal(size=2000)
        runs.append(Run.from_arrays(time, speed, force, name=f"run{k}"))
    runs = [replace(r, quantities=Drive("linear", "force").quantities) for r in runs]
    found = diagnose(Rig(drive=Drive("linear", "force")), runs, law="coulomb")
    assert (found.verdict, found.machine) == ("adequate", ("sensor_offset",))
    assert "dry_asymmetry" in found.alternatives["sensor_offset"]
    assert "dry_asymmetry" in found.summary(full=True).partition("Measurement")[0]


def test_effect_that_fits_as_well_and_makes_the_offset_unnecessary_replaces_another() -> None:
    """An offset and friction that differs by direction in full resemble `viscous_asymmetry`."""
    random, runs = np.random.default_rng(7), []
    thinning, asymmetry = random.uniform(3.0, 12.0), random.uniform(6.0, 20.0)
    asymmetry *= random.choice([-1.0, 1.0])
    time_s = 0.01 * np.arange(800)
    for k in range(3):
        rad_s, size_m = random.uniform(1.0, 5.0, (2, 1)), random.uniform(0.02, 0.2, (2, 1))
        phase = rad_s * time_s
        x = np.sum(size_m * np.sin(phase), axis=0)
        v = np.sum(size_m * rad_s * np.cos(phase), axis=0)
        a = np.sum(-size_m * rad_s**2 * np.sin(phase), axis=0)
        viscous = (40.0 * v + asymmetry * np.abs(v)) / (1.0 + thinning * np.abs(v))
        force = 5.0 * np.sign(v) + viscous + 2.0 * a + 0.15 * random.standard_normal(len(v))
        speed = v + 1e-4 * random.standard_normal(len(v))
        runs.append(Run.from_arrays(time_s, speed, force, position_m=x, name=f"run_{k}"))
    found = diagnose(Rig(drive=Drive("linear", "force")), runs, law="coulomb")
    assert set(found.effects) == {"viscous_asymmetry", "viscous_thinning"}, found.summary()
    assert (found.verdict, found.machine) == ("missing", ("inertia",))
