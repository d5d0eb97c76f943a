"""The bias of readings in coarse steps is taken off where the model says at which force it lies."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, cast

import numpy as np
import pytest
from campaigns import campaign
from jbf.diagnosis import recipe
from jbf.diagnosis.candidates import Candidates
from jbf.diagnosis.converter_bias import without_bias
from jbf.diagnosis.policy import DEFAULT
from jbf.estimation.campaign import Campaign
from jbf.estimation.converter import bias_n, origin_n
from jbf.estimation.minimum import approach
from jbf.estimation.noise import WHITE
from jbf.estimation.problem import Problem
from jbf.estimation.solution import Solution

STEP_N, NOISE_N, ZERO_N = 4.0, 0.8, 1.1
"""Of a converter whose readings are no whole multiples of its step."""


@pytest.mark.parametrize("noise_n", [0.15, 0.4, 0.8])
@pytest.mark.parametrize("zero_n", [0.0, 0.7])
def test_the_bias_is_what_simulated_readings_are_off_by(noise_n: float, zero_n: float) -> None:
    random, step_n = np.random.default_rng(3), 2.0
    force = np.linspace(0.0, 4.0, 41)
    noisy = force[:, None] + noise_n * random.standard_normal((41, 40_000))
    read = zero_n + step_n * np.round((noisy - zero_n) / step_n)
    assert origin_n(step_n, read.ravel()) == pytest.approx(zero_n, abs=1e-9)
    off = np.mean(read, axis=1) - force
    # Harmonics beyond the third are left out.
    assert bias_n(step_n, noise_n, force - zero_n) == pytest.approx(off, abs=0.03 * step_n)
    # One that rounds down, seen with the zero that it has.
    down = zero_n + step_n * np.floor((noisy - zero_n) / step_n)
    expected = force - step_n / 2.0
    off = np.mean(down, axis=1) - expected
    assert bias_n(step_n, noise_n, expected - zero_n) == pytest.approx(off, abs=0.03 * step_n)


def stepped(off_n: float = 0.0) -> tuple[Problem, Solution]:
    """A problem whose readings come in steps, and a model that is off by a slow error."""
    rig, runs, _ = campaign(7)
    ideal = Problem(Campaign.prepare(rig, runs), "journal", "journal", ())
    near = approach(ideal, [{}], 8)
    random = np.random.default_rng(1)
    forces = ideal.predict(near.values)
    read = []
    for run, force in zip(runs, forces, strict=True):
        noisy = force + NOISE_N * random.standard_normal(len(force))
        steps = np.round((noisy - ZERO_N) / STEP_N)
        read.append(replace(run, friction_n=ZERO_N + STEP_N * steps))
    whole = Campaign.prepare(rig, read)
    model = [f + off_n * np.sin(0.01 * np.arange(len(f))) for f in forces]
    left = [p.friction_n - m for p, m in zip(whole.prepared, model, strict=True)]
    problem = Problem(whole, "journal", "journal", ())
    return problem, replace(near, residuals=left, noise=WHITE, samples=whole.samples)


def moved(campaign: Campaign) -> float:
    """RMS of what was taken off, in steps."""
    off = [p.readings_n - p.friction_n for p in campaign.prepared]
    return campaign.samples.rms(off) / STEP_N


def test_it_is_taken_off_once() -> None:
    problem, near = stepped()
    corrected = without_bias(problem, near, DEFAULT)
    assert corrected is not None
    # Noise of a fifth of a step: `exp(-2 (pi / 5)^2) / (pi sqrt 2)`.
    assert moved(corrected) == pytest.approx(0.102, rel=0.15)
    assert corrected.steps_rms_n(1.0) < 0.4 * problem.campaign.steps_rms_n(1.0)
    left = [
        p.friction_n - (q.friction_n - e)
        for p, q, e in zip(
            corrected.prepared, problem.campaign.prepared, near.residuals, strict=True
        )
    ]
    again = replace(near, residuals=left)
    assert without_bias(Problem(corrected, "journal", "journal", ()), again, DEFAULT) is None
    # What shifts a run in time begins with its readings.
    shifted = corrected.prepared[0].shifted(0.0, 0.0)
    assert np.array_equal(shifted.friction_n, problem.campaign.prepared[0].friction_n)


def test_it_stays_off_once_the_model_is_fitted_again() -> None:
    problem, _ = stepped()
    corrected = without_bias(problem, approach(problem, [{}], 30), DEFAULT)
    assert corrected is not None
    again = Problem(corrected, "journal", "journal", ())
    assert without_bias(again, approach(again, [{}], 30), DEFAULT) is None


def test_how_far_it_must_move_is_the_policys() -> None:
    problem, near = stepped()
    assert without_bias(problem, near, replace(DEFAULT, bias_moves=0.09)) is not None
    assert without_bias(problem, near, replace(DEFAULT, bias_moves=0.12)) is None


def test_a_model_that_is_off_by_steps_takes_little() -> None:
    right, wrong = (without_bias(*stepped(off), DEFAULT) for off in (0.0, 3.0 * STEP_N))
    assert right is not None
    assert wrong is None or moved(wrong) < 0.35 * moved(right)


@pytest.mark.parametrize(("worse", "lost"), [(1.02, False), (1.04, True)])
def test_weights_that_lead_a_fit_astray_are_given_up(worse: float, lost: bool) -> None:
    _, near = stepped()

    class Made:
        policy = DEFAULT

        def __init__(self, times: float) -> None:
            self.times = times

        def converge(self, effects: tuple[str, ...]) -> Solution:
            return replace(near, residuals=[self.times * e for e in near.residuals])

    def made(times: float) -> Candidates:
        return cast(Candidates, cast(Any, Made(times)))

    assert recipe._lost(made(1.0), made(worse), ("backlash",), ("backlash",)) is lost
    # Other effects are another answer.
    assert not recipe._lost(made(1.0), made(worse), ("backlash",), ())
