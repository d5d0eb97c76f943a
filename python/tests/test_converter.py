"""A converter's steps: what they make of a mean reading is no structure of the machine's."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from campaigns import campaign
from jbf.diagnosis.policy import DEFAULT
from jbf.diagnosis.remainder import find_remainder
from jbf.estimation.campaign import Campaign
from jbf.estimation.converter import curve_rms_n
from jbf.estimation.minimum import approach
from jbf.estimation.noise import WHITE
from jbf.estimation.problem import Problem
from jbf.records.findings.finding import Finding

STEP_N = 4.0


@pytest.mark.parametrize("noise_n", [0.1, 0.2, 0.4])
def test_the_curve_is_what_simulated_readings_leave(noise_n: float) -> None:
    random, step_n = np.random.default_rng(4), 1.0
    force = np.linspace(0.0, 1.0, 40, endpoint=False)[:, None]
    read = step_n * np.round((force + noise_n * random.standard_normal((40, 50_000))) / step_n)
    off = np.mean(read - force, axis=1)
    rms = float(np.sqrt(np.mean((read - force) ** 2)))
    # All harmonics are in the readings, the first alone is counted: of little noise they are more.
    assert curve_rms_n(step_n, rms) == pytest.approx(float(np.std(off)), rel=0.1, abs=0.005)


def test_without_steps_there_is_none() -> None:
    assert curve_rms_n(0.0, 1.0) == 0.0


def test_what_steps_make_of_a_mean_is_nothing_that_remains() -> None:
    rig, runs, _ = campaign(7)
    whole = Campaign.prepare(rig, runs)
    problem = Problem(whole, "journal", "journal", ())
    near = approach(problem, [{}], 8)
    random = np.random.default_rng(1)
    left = []
    for force in problem.predict(near.values):
        noisy = force + 0.15 * STEP_N * random.standard_normal(len(force))
        left.append(STEP_N * np.round(noisy / STEP_N) - force)
    off = replace(near, residuals=left, noise=WHITE)
    axes = {r.axis for r in find_remainder(problem, off, DEFAULT)}
    assert {"force", "velocity"} <= axes
    known = Finding("steps", "friction_n", "a", STEP_N, "N", "counted as noise", "")
    stepped = Problem(whole.with_findings([known]), "journal", "journal", ())
    assert find_remainder(stepped, off, DEFAULT) == ()
    # A force that is off by as much as a step is no converter's.
    for e, force in zip(left, problem.predict(near.values), strict=True):
        e += 0.7 * STEP_N * np.sign(force)
    assert "force" in {r.axis for r in find_remainder(stepped, off, DEFAULT)}
