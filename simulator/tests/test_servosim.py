"""Tests of the servo drives: equations of motion, and parameters by least squares."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import servosim
from servosim.campaign import draw
from servosim.hidden import (
    NOTHING,
    Cogging,
    Hidden,
    PitchRipple,
    StribeckExcess,
    Together,
    TorqueProportional,
    ViscousAsymmetry,
    ViscousThinning,
    WarmUp,
)
from servosim.plant import Plant, run

SEEDS = range(1, 25)
OF_EVERY_KIND = (2, 3, 4, 7, 15, 20)
"""Seeds without a delay, with every kind of motion, stamps and channels between them."""


def test_drive_without_gravity_slides_to_a_stop_after_its_kinetic_energy_is_lost() -> None:
    """Without gravity and with almost no viscous friction, a drive stops after J v^2 / (2 F_c)."""
    plant = Plant(0.5, 0.8, 1e-4, 0.0, False)
    push = 2.0
    pushed = 500
    motion = run(plant, lambda tick, x, v: push if tick < pushed else 0.0, 1e-3, 2000, 0.0)
    speed = (push - plant.coulomb) / plant.inertia * pushed * 1e-3
    distance = 0.5 * speed * pushed * 1e-3 + 0.5 * plant.inertia * speed**2 / plant.coulomb
    assert motion.position[-1] == pytest.approx(distance, rel=1e-3)
    assert motion.velocity[-1] == 0.0


def test_drive_sticks_under_a_torque_below_its_friction_and_breaks_away_above() -> None:
    plant = Plant(0.5, 0.8, 0.1, 0.0, False)
    motion = run(plant, lambda tick, x, v: 0.79 if tick < 100 else 0.81, 1e-3, 300, 0.2)
    position, _, acceleration, _ = motion.at(np.array([0.05, 0.1005]))
    assert position[0] == 0.2
    assert acceleration[1] == pytest.approx(0.01 / 0.5, rel=1e-3)


def test_viscous_drive_approaches_its_speed_exponentially() -> None:
    plant = Plant(0.5, 0.8, 2.0, 0.0, False)
    motion = run(plant, lambda tick, x, v: 2.8, 1e-3, 1000, 0.0)
    t = np.linspace(0.0, 0.999, 50)
    _, velocity, acceleration, _ = motion.at(t)
    np.testing.assert_allclose(velocity, 1.0 - np.exp(-4.0 * t), atol=1e-5)
    np.testing.assert_allclose(acceleration, 4.0 * np.exp(-4.0 * t), atol=1e-4)


@pytest.mark.parametrize(
    "hidden",
    [
        Cogging(0.3, 0.2, 0.4),
        PitchRipple(0.3, 0.2, 0.4),
        StribeckExcess(0.5, 0.5, 1.5),
        ViscousThinning(0.5),
        TorqueProportional(0.2),
    ],
    ids=lambda effect: effect.name,
)
def test_error_of_the_motion_decreases_with_the_square_of_the_step(hidden: Hidden) -> None:
    """The pendulum slides in one direction, so no event limits the order."""
    plant = Plant(0.5, 0.8, 0.4, 0.6, True, Together((hidden,)))

    def positions(steps_per_tick: int) -> Any:
        step_s = 4e-3 / steps_per_tick
        motion = run(plant, lambda tick, x, v: 4.0, step_s, 250 * steps_per_tick, 0.2)
        return motion.at(np.linspace(0.1, 0.99, 50))[0]

    exact = positions(64)
    coarse, fine = (np.max(np.abs(positions(n) - exact)) for n in (4, 8))
    assert coarse / fine == pytest.approx(4.0, rel=0.2)


def moving_samples(campaign: servosim.Campaign) -> tuple[Any, Any]:
    """Return regressors computed from the true motion, and the recorded forces."""
    plant, rows, forces = campaign.drawn.plant, [], []
    for r in campaign.records:
        columns = [np.sign(r.true_velocity), r.true_velocity, r.true_acceleration]
        if plant.gravity:
            columns.append(np.sin(r.position) if plant.swings else np.ones(len(r.force)))
        kept = np.abs(r.true_velocity) > 1e-3 * campaign.drawn.demand.top
        rows.append(np.column_stack(columns)[kept])
        forces.append(r.force[kept])
    return np.concatenate(rows), np.concatenate(forces)


@pytest.mark.parametrize(
    "seed",
    [s if s in OF_EVERY_KIND else pytest.param(s, marks=pytest.mark.extended) for s in SEEDS],
)
def test_parameters_of_a_drive_are_recovered_if_the_force_has_no_delay(seed: int) -> None:
    if draw(seed).logger.force_late:
        return
    campaign = servosim.simulate(seed)
    plant = campaign.drawn.plant
    rows, forces = moving_samples(campaign)
    estimate, _, rank, _ = np.linalg.lstsq(rows, forces, rcond=None)
    assert rank == rows.shape[1]
    residual = forces - rows @ estimate
    sd = np.sqrt(np.diag(np.linalg.inv(rows.T @ rows)) * (residual @ residual) / len(residual))
    true = [plant.coulomb, plant.viscous, plant.inertia, plant.gravity][:rank]
    # The tolerance allows for encoder counts and pieces of constant weight besides the noise.
    share = np.abs(rows).max(axis=0) / np.std(forces)
    assert np.all(np.abs(estimate - true) * share < 4.5 * sd * share + 0.005)


def test_seeds_draw_every_kind_of_motion_stamps_and_channels() -> None:
    drawn = [draw(seed) for seed in range(200)]
    assert len({d.kind for d in drawn}) == 6
    assert len({d.logger.stamps for d in drawn}) == 5
    assert len({d.logger.speed for d in drawn}) == 4
    assert len({d.logger.force for d in drawn}) == 3
    assert {d.rotary for d in drawn} == {True, False}


def test_stamps_of_every_logger_increase() -> None:
    seeds = {draw(seed).logger.stamps: seed for seed in SEEDS}
    assert len(seeds) == 5
    for seed in seeds.values():
        for r in servosim.simulate(seed, runs=1).records:
            assert np.all(np.diff(r.time_s) > 0.0)


def hidden_in(plant: Plant, *effects: Hidden) -> Plant:
    return replace(plant, hidden=Together(effects))


def test_drive_with_a_stribeck_peak_sticks_below_it_and_breaks_away_above() -> None:
    plant = hidden_in(Plant(0.5, 0.8, 0.1, 0.0, False), StribeckExcess(0.4, 0.05, 1.0))
    motion = run(plant, lambda tick, x, v: 1.19 if tick < 100 else 1.21, 1e-3, 300, 0.0)
    position, *_ = motion.at(np.array([0.0999, 0.3]))
    assert position[0] == 0.0
    assert position[1] > 0.0


def test_loss_in_the_transmission_adds_its_share_of_the_weight_to_a_steady_torque() -> None:
    """Lifting requires W (1 + mu) + F_c + F_v v, lowering W (1 - mu) - F_c - F_v v."""
    plant = hidden_in(Plant(0.5, 0.8, 2.0, 3.0, False), TorqueProportional(0.2))
    for torque, speed in ((3.0 * 1.2 + 0.8 + 1.0, 0.5), (3.0 * 0.8 - 0.8 - 1.0, -0.5)):
        motion = run(plant, lambda tick, x, v, u=torque: u, 1e-3, 6000, 0.0)
        assert motion.velocity[-1] == pytest.approx(speed, rel=1e-3)


def test_warm_up_decreases_all_friction_with_time() -> None:
    plant = hidden_in(Plant(0.5, 0.8, 2.0, 0.0, False), WarmUp(0.5, 1.0))
    motion = run(plant, lambda tick, x, v: 2.8, 1e-3, 12_000, 0.0)
    _, velocity, *_ = motion.at(np.array([3.0, 11.9]))
    factor = 1.0 + 0.5 * np.exp(-3.0)
    assert velocity[0] == pytest.approx((2.8 / factor - 0.8) / 2.0, rel=0.03)
    assert velocity[1] == pytest.approx(1.0, rel=1e-3)


@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_viscous_friction_of_both_directions_thins_and_warms_up(direction: float) -> None:
    """The steady torque is (F_c + (F_v + sgn(v) b) |v| / (1 + w |v|)) (1 + a) when cold."""
    effects = ViscousAsymmetry(-0.6), ViscousThinning(2.0), WarmUp(0.5, 1e6)
    plant = hidden_in(Plant(0.5, 0.8, 2.0, 0.0, False), *effects)
    speed = 1.5
    torque = 1.5 * (0.8 + (2.0 - 0.6 * direction) * speed / (1.0 + 2.0 * speed))
    motion = run(plant, lambda tick, x, v: direction * torque, 2e-3, 25_000, 0.0)
    assert motion.velocity[-1] == pytest.approx(direction * speed, rel=1e-3)


def test_hidden_effects_do_not_change_the_drawn_drive_and_logger() -> None:
    for seed in range(1, 6):
        plain, other = draw(seed), draw(seed, ("cogging",))
        assert plain.logger == other.logger
        assert replace(other.plant, hidden=NOTHING) == plain.plant
