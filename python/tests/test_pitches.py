"""Pitches at which a force comes again along the way, found in the data."""

from __future__ import annotations

import numpy as np
import pytest
from jbf import Rig, Run
from jbf.diagnosis.level import Level
from jbf.diagnosis.policy import DEFAULT
from jbf.estimation.campaign import Campaign
from jbf.estimation.pitches import LEAST_PERIODS, known_pitches, longest_pitch, pitches
from jbf.estimation.problem import Problem
from jbf.records.drive import Drive

STEP_S = 0.01
NOISE_N = 0.2


def runs(pitch_m: float | None, *, along: bool = False, seed: int = 0) -> list[Run]:
    """Two runs of an axis to and fro under dry and viscous friction, a weight and a mass."""
    found = []
    for i in range(2):
        rng = np.random.default_rng([seed, i])
        t = np.arange(0.0, 20.0, STEP_S)
        v = 0.06 * np.sin(0.9 * t + i) + 0.03 * np.sin(2.3 * t + 2.0 * i)
        a = 0.054 * np.cos(0.9 * t + i) + 0.069 * np.cos(2.3 * t + 2.0 * i)
        x = -0.06 / 0.9 * np.cos(0.9 * t + i) - 0.03 / 2.3 * np.cos(2.3 * t + 2.0 * i)
        force = (5.0 + i) * np.sign(v) + 30.0 * v + 3.0 * a + 20.0 * np.sin(x - 1.0)
        if pitch_m is not None:
            wave = 0.3 * np.sin(2.0 * np.pi * x / pitch_m - 0.7)
            force = force + (wave * np.sign(v) if along else wave)
        force = force + NOISE_N * rng.standard_normal(len(t))
        found.append(Run.from_arrays(t, v, force, position_m=x, name=f"{i}"))
    return found


@pytest.mark.parametrize("along", [False, True])
@pytest.mark.parametrize("pitch_m", [0.0041, 0.0123, 0.031])
def test_a_pitch_is_the_likeliest(pitch_m: float, along: bool) -> None:
    campaign = Campaign.prepare(Rig(), runs(pitch_m, along=along))
    span = np.ptp(np.concatenate([p.run.position_m for p in campaign.prepared]))
    found = pitches(campaign, along=along)
    # A search starts within the width of the likelihood's peak, half a period over the whole way.
    assert abs(span / found[0] - span / pitch_m) < 0.25


def test_of_noise_the_highest_line_gains_less_than_its_parameters_cost() -> None:
    gains = []
    for seed in range(20):
        some = runs(None, seed=seed)
        campaign = Campaign.prepare(Rig(), some)
        noise = np.concatenate(
            [
                NOISE_N * np.random.default_rng([seed, i]).standard_normal(len(r))
                for i, r in enumerate(some)
            ]
        )
        place = np.concatenate([r.position_m for r in some])
        for pitch in pitches(campaign, along=False):
            wave = np.exp(2j * np.pi * place / pitch)
            pair = np.stack([wave.real, wave.imag], axis=1)
            fitted = pair @ np.linalg.lstsq(pair, noise, rcond=None)[0]
            gains.append(float(np.sum(fitted**2)) / NOISE_N**2)
    samples = sum(len(r) for r in some)
    asked = Level.shared(DEFAULT, 20, samples, NOISE_N).price(3, samples)
    # More than two parameters of noise alone would gain: the search does find something.
    assert 4.0 < np.median(gains) < 0.8 * asked
    assert max(gains) < asked


def test_a_lower_wave_is_found_beside_a_higher_one() -> None:
    some = []
    for r in runs(0.0123):
        low = 0.06 * np.sin(2.0 * np.pi * np.asarray(r.position_m) / 0.0079 + 0.3)
        some.append(
            Run.from_arrays(
                r.time_s, r.velocity_m_s, r.friction_n + low, position_m=r.position_m, name=r.name
            )
        )
    found = pitches(Campaign.prepare(Rig(), some), along=False)
    assert found[:2] == pytest.approx((0.0123, 0.0079), rel=0.01)


def test_a_rig_tells_the_turn_of_its_screw_and_of_its_motor() -> None:
    assert known_pitches(Rig()) == ()
    screw = Drive("linear", "force", pitch_m=0.02, gear_ratio=4.0)
    assert known_pitches(Rig(drive=screw)) == pytest.approx((0.02, 0.005))
    assert known_pitches(Rig(drive=Drive("linear", "force"))) == ()
    joint = Drive("rotary", "torque", gear_ratio=100.0)
    assert known_pitches(Rig(drive=joint)) == pytest.approx((0.02 * np.pi,))
    assert known_pitches(Rig(drive=Drive("rotary", "torque"))) == ()
    campaign = Campaign.prepare(Rig(drive=screw), runs(None))
    page = Problem(campaign, "coulomb", "journal", ("cogging",)).parameters["cogging.pitch_m"]
    assert {0.02, 0.005} <= set(page.starts)


def test_a_way_that_holds_no_pitch_has_none() -> None:
    t = np.arange(0.0, 0.5, STEP_S)
    v = np.full(len(t), 0.01)
    run = Run.from_arrays(t, v, np.full(len(t), 5.0), position_m=0.01 * t)
    assert pitches(Campaign.prepare(Rig(), [run]), along=False) == ()


def test_a_way_of_no_sample_that_counts_bounds_no_pitch() -> None:
    t = np.arange(0.0, 20.0, STEP_S)
    v = 0.05 * np.sin(t)
    run = Run.from_arrays(t, v, 5.0 * np.sign(v), position_m=-0.05 * np.cos(t))
    campaign = Campaign.prepare(Rig(), [run])
    assert 0.0 < longest_pitch(campaign) <= 0.1 / LEAST_PERIODS
    assert longest_pitch(campaign.without([np.ones(len(t), dtype=bool)])) == np.inf
