"""A converter's steps: what they make of a mean reading is no structure of the machine's."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from campaigns import campaign
from jbf.diagnosis.policy import DEFAULT
from jbf.diagnosis.remainder import find_remainder
from jbf.estimation.campaign import Campaign
from jbf.estimation.converter import curve_rms_n, noise_before
from jbf.estimation.minimum import approach
from jbf.estimation.noise import WHITE
from jbf.estimation.problem import Problem

STEP_N = 4.0


@pytest.mark.parametrize("noise_n", [0.1, 0.2, 0.4])
def test_the_curve_is_what_simulated_readings_leave(noise_n: float) -> None:
    random, step_n = np.random.default_rng(4), 1.0
    force = np.linspace(0.0, 1.0, 40, endpoint=False)[:, None]
    read = step_n * np.round((force + noise_n * random.standard_normal((40, 50_000))) / step_n)
    off = np.mean(read - force, axis=1)
    # All harmonics are in the readings, the first alone is counted: of little noise they are more.
    assert curve_rms_n(step_n, noise_n) == pytest.approx(float(np.std(off)), rel=0.1, abs=0.001)


@pytest.mark.parametrize("noise", [0.05, 0.2, 0.4, 1.0])
def test_the_noise_before_a_converter(noise: float) -> None:
    random, step_n = np.random.default_rng(6), 2.5
    force = 20.0 * step_n * np.sin(np.linspace(0.0, 6.0, 20_000))
    read = step_n * np.round(force / step_n + noise * random.standard_normal(len(force)))
    assert noise_before(step_n, np.diff(read)) == pytest.approx(noise * step_n, rel=0.1)


def test_readings_that_never_move_have_no_noise() -> None:
    assert noise_before(1.0, np.zeros(50)) == 0.0
    assert noise_before(1.0, np.zeros(0)) == 0.0
    assert curve_rms_n(1.0, 0.0) == pytest.approx(1.0 / np.pi / np.sqrt(2.0))
    # And those that never stay hide their steps.
    assert curve_rms_n(1.0, noise_before(1.0, np.full(50, 7.0))) < 1e-12


def test_what_steps_make_of_a_mean_is_nothing_that_remains() -> None:
    rig, runs, _ = campaign(7)
    ideal = Problem(Campaign.prepare(rig, runs), "journal", "journal", ())
    near = approach(ideal, [{}], 8)
    random = np.random.default_rng(1)
    forces = ideal.predict(near.values)
    read = []
    for run, force in zip(runs, forces, strict=True):
        noisy = force + 0.15 * STEP_N * random.standard_normal(len(force))
        read.append(replace(run, friction_n=STEP_N * np.round(noisy / STEP_N)))
    campaign_read = Campaign.prepare(rig, read)
    assert campaign_read.step_n == pytest.approx(STEP_N)
    left = [r.friction_n - f for r, f in zip(read, forces, strict=True) if r.friction_n is not None]

    def axes(whole: Campaign) -> set[str]:
        off = replace(near, residuals=left, noise=WHITE)
        found = find_remainder(Problem(whole, "journal", "journal", ()), off, DEFAULT)
        return {r.axis for r in found}

    unknown = tuple(
        replace(p, examined=replace(p.examined, findings=())) for p in campaign_read.prepared
    )
    assert {"force", "velocity"} <= axes(replace(campaign_read, prepared=unknown))
    assert axes(campaign_read) == set()
    # A force that is off by as much as a step is no converter's.
    for e, force in zip(left, forces, strict=True):
        e += 0.7 * STEP_N * np.sign(force)
    assert "force" in axes(campaign_read)
