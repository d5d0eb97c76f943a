"""Whose gain it is: evidence at the same samples, with their noise, beyond a converter's steps."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from by_hand import coulomb
from jbf import Rig, Run
from jbf.diagnosis.candidates import Candidates
from jbf.diagnosis.evidence import _within_steps, evidence, evidence_alone, swap_cost
from jbf.estimation.campaign import Campaign
from jbf.estimation.converter import curve_rms_n
from jbf.estimation.likelihood import likelihood_gain
from jbf.estimation.noise import WHITE, Noise
from made_up import SAMPLES, N


def left(size: float) -> Any:
    """A solution that leaves so much, RMS, its sign turning from sample to sample."""
    residual = size * np.where(np.arange(N) % 2, 1.0, -1.0)
    return SimpleNamespace(residuals=[residual], samples=SAMPLES, rms_n=size)


@pytest.mark.parametrize(("apart", "within"), [(0.099, True), (0.101, False)])
def test_models_that_differ_by_a_converters_steps_are_one(apart: float, within: bool) -> None:
    richer, simpler = left(1.0), left(1.0 + apart)
    asked: list[float] = []

    def steps(rms_n: float) -> float:
        asked.append(rms_n)
        return 0.1

    campaign: Any = SimpleNamespace(steps_rms_n=steps)
    assert _within_steps(campaign, richer, simpler) == within
    half: Any = SimpleNamespace(steps_rms_n=lambda rms_n: 0.5)
    assert not _within_steps(half, left(1.0), left(1.5))
    assert asked == pytest.approx([1.0 + apart])


def test_what_the_samples_set_aside_cost_is_no_evidence() -> None:
    """A law led astray by three wild samples at a start; a delay that sets them aside."""
    t = np.arange(0.0, 20.0, 0.02)
    runs = []
    for i in range(2):
        v = 0.1 * np.sin((1.0 + 0.2 * i) * t + 0.4)
        noise = 0.1 * np.random.default_rng(i).standard_normal(len(t))
        runs.append(Run.from_arrays(t, v, coulomb(t, v, v) + noise, name=str(i)))
    campaign = Campaign.prepare(Rig(), runs)
    candidates = Candidates(campaign, "coulomb", "journal")
    problem = candidates.fitted(()).problem
    right = candidates.converge(())
    every = [np.ones(len(t), dtype=bool) for _ in runs]
    every[0][500:503] = False
    fewer = right.samples.within(every)
    # As if those three had bent the law, and a delay of nothing had set them aside.
    moved = right.values * np.where(np.array(problem.names) == "F_c_n", 1.02, 1.0)
    astray = problem.solution(moved, right.samples, WHITE)
    delay = candidates.converge(("time_delay",))
    richer = replace(delay, samples=fewer, values=np.append(right.values, 1e-4))
    cost = fewer.cost(right.residuals, WHITE)
    richer = replace(richer, residuals=right.residuals, noise=WHITE, cost=cost)
    assert evidence(candidates, richer, astray) > 60.0
    assert evidence_alone(candidates, richer, astray) < 0.0
    # Nor does it come in another's place by that.
    there = candidates.fitted(("time_delay",))
    there.solution, there.score = richer, np.inf
    rival = candidates.converge(("sensor_offset",))
    lost = swap_cost(candidates, ("time_delay",), replace(rival, residuals=right.residuals), astray)
    assert lost > 60.0
    # Nor is what a noise costs that was described with those samples in it.
    smooth = problem.solution(right.values, right.samples, Noise(0.5, 0.9))
    assert likelihood_gain(richer, smooth) > 60.0
    assert evidence(candidates, richer, smooth) < 0.0
    assert evidence_alone(candidates, richer, smooth) < 0.0
    # On the same samples the two are one.
    whole = astray.samples.cost(right.residuals, WHITE)
    same = replace(richer, samples=astray.samples, cost=whole)
    alone = evidence_alone(candidates, same, astray)
    assert alone == evidence(candidates, same, astray) > 60.0


@pytest.mark.parametrize(("noise_n", "counts"), [(0.10, False), (0.35, True)])
def test_what_a_converters_steps_do_is_no_evidence(noise_n: float, counts: bool) -> None:
    """0.03 N that an effect moves, read in steps of 0.4 N: noise of a quarter of a step hides no
    curve of the converter, noise of a step does."""
    step_n, random = 0.4, np.random.default_rng(2)
    force = np.linspace(-6.0, 6.0, 200000)
    read = step_n * np.round((force + noise_n * random.standard_normal(len(force))) / step_n)
    off = float(np.std([np.mean((read - force)[k : k + 1000]) for k in range(0, 200000, 1000)]))
    # By simulation: is the converter's own curve larger than what the effect moves?
    assert (off > 0.03 / np.sqrt(2.0)) == (not counts)
    rms = float(np.hypot(noise_n, step_n / np.sqrt(12.0)))
    near = SimpleNamespace(rms_n=rms, residuals=[np.zeros(N)], samples=SAMPLES)
    more = SimpleNamespace(rms_n=rms, residuals=[0.03 * np.sin(np.arange(N))], samples=SAMPLES)
    stepped = SimpleNamespace(steps_rms_n=lambda _: curve_rms_n(step_n, noise_n))
    fine = SimpleNamespace(steps_rms_n=lambda _: 0.0)
    found = [_within_steps(cast(Any, c), cast(Any, more), cast(Any, near)) for c in (stepped, fine)]
    assert found == [not counts, False]
