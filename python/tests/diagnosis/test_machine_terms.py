"""Weight and inertia of a swinging link, which a diagnosis finds only together."""

import numpy as np
from jbf import Rig, Run, diagnose
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


def test_weight_and_inertia_that_hide_each_other_are_found_together() -> None:
    rig = Rig(drive=Drive("rotary", "torque"))
    found = diagnose(rig, [swinging(seed) for seed in (1, 2, 3, 4)], law="coulomb")
    assert found.verdict == "missing", found.summary()
    assert set(found.effects) == {"inertia_leak", "gravity"}
    assert found.steps[-1].holdout_rms_n < 1.1 * NOISE
    for name, true in (("inertia_leak.m_e_kg", INERTIA), ("gravity.G_n", WEIGHT)):
        parameter = found.model.parameters[name]
        assert parameter.stderr is not None
        assert abs(parameter.value - true) < 3.0 * parameter.stderr, name
