"""The proposed next run: the best of all motions within the limits, and decisive when recorded."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import jbf
import numpy as np
import numpy.typing as npt
import pytest
from by_hand import four_runs
from campaigns import campaign as simulated
from golden import golden
from jbf import Limits, Rig
from jbf.diagnosis import Experiment, Policy
from jbf.diagnosis.candidates import Candidates
from jbf.diagnosis.experiment import propose
from jbf.diagnosis.policy import DEFAULT
from jbf.diagnosis.separation import Rival, filled_limits, motions
from jbf.estimation.campaign import Campaign
from rigsim.motions import Motion, polyline, sine, sweep

Array = npt.NDArray[np.float64]
LIMITS = Limits(duration_s=10.0)
PAIR = (("sensor_offset",), ("inertia_leak",))
OTHER = (("sensor_drift",), ("quadratic_drag",))


def friction(t: Array, v: Array, a: Array) -> Array:
    """Coulomb friction with a part of each of four effects."""
    law = 5.0 * np.sign(v) + 20.0 * v
    effects: Array = 0.3 + 3.0 * a + 0.03 * t + 60.0 * v * np.abs(v)
    return law + effects


ANY_EVIDENCE = replace(DEFAULT, least_separation=1e-6)


def candidates(policy: Policy = ANY_EVIDENCE) -> Candidates:
    campaign = Campaign.prepare(Rig(), four_runs(friction, noise_n=0.1))
    return Candidates(campaign, "coulomb", "journal", policy)


@cache
def proposed(pairs: int) -> Experiment:
    found = propose(candidates(), (PAIR, OTHER)[:pairs], LIMITS)
    assert isinstance(found, Experiment)
    return found


def residual_square_after_fit(
    rival: Rival, own: tuple[Array, Array], truth: Array, step_s: float
) -> float:
    """Residual sum of squares of a fit to old and new runs, in units of the noise."""
    noise = rival.solution.noise
    x, gap = noise.innovations(own[1], step_s), noise.innovations(truth - own[0], step_s)
    _, j = rival.solution.stacked()
    explained = x.T @ gap
    step = np.linalg.pinv(x.T @ x + j.T @ j) @ explained
    return float(gap @ gap - explained @ step) / rival.noise_n**2


@pytest.mark.parametrize("pairs", [1, 2])
def test_proposed_run_maximises_the_least_separation_of_the_rivals(pairs: int) -> None:
    """Each model of a pair may be the truth; models of different pairs are not compared."""
    tried, groups = candidates(), (PAIR, OTHER)[:pairs]
    limits, step_s = filled_limits(tried, LIMITS)
    rivals = {}
    for effects in (effects for group in groups for effects in group):
        tried.converge(effects)
        rivals[effects] = Rival(tried.fitted(effects))
    least = []
    for excitation, run, motion in motions(tried, limits, step_s):
        at = {effects: rival.at(motion) for effects, rival in rivals.items()}
        separations = [
            residual_square_after_fit(rivals[fitted], at[fitted], at[truth][0], step_s)
            for group in groups
            for fitted, truth in (group, group[::-1])
        ]
        least.append((min(separations), excitation.words, run))
    evidence, words, run = max(least, key=lambda x: x[0])
    found = proposed(pairs)
    assert found.evidence == pytest.approx(evidence, rel=1e-4)
    assert words in found.words
    assert found.run.velocity_m_s == pytest.approx(run.velocity_m_s)


def test_separation_is_the_root_mean_square_over_the_run() -> None:
    found, tried = proposed(1), candidates()
    assert found.separation_sigma == pytest.approx(np.sqrt(found.evidence / len(found.run)))
    noise_n = 0.0
    for effects in PAIR:
        tried.converge(effects)
        noise_n = max(noise_n, Rival(tried.fitted(effects)).noise_n)
    assert found.separation_n == pytest.approx(found.separation_sigma * noise_n)


def test_run_without_sufficient_evidence_is_not_proposed() -> None:
    evidence = proposed(1).evidence
    for part, there in ((0.999, True), (1.001, False)):
        policy = replace(DEFAULT, least_separation=part * evidence)
        found = propose(candidates(policy), [PAIR], LIMITS)
        assert isinstance(found, Experiment) == there
        if not there:
            assert "sensor_offset and inertia_leak" in str(found)


def test_no_run_is_proposed_for_models_with_the_same_predictions() -> None:
    """Without a transmitted load the friction in proportion to it is zero."""
    found = propose(candidates(), [[("torque_proportional",), ()]], LIMITS)
    assert isinstance(found, str)
    assert "torque_proportional" in found


def test_proposal_names_only_effects_that_differ_between_the_rivals() -> None:
    groups = [[("sensor_offset", "inertia_leak"), ("sensor_offset",)]]
    found = propose(candidates(), groups, LIMITS)
    assert isinstance(found, Experiment)
    assert "inertia_leak and nothing more" in found.words
    assert "sensor_offset" not in found.words


ONE_WAY = (
    sine("one_way_0.25", 50.3, 0.0595, 0.25, bias=0.0728),
    sine("one_way_1", 25.2, 0.0595, 1.0, bias=0.0728),
)
"""Runs in one direction: a drag and an offset of the sensor are equivalent in them."""


def played(run: jbf.Run) -> Motion:
    """The motion of a proposed run, for the simulator, through every fifth sample."""
    knots = zip(run.time_s[::5].tolist(), run.velocity_m_s[::5].tolist(), strict=True)
    return polyline("next", list(knots))


def test_diagnosis_with_a_tie_proposes_a_run_that_reverses() -> None:
    result = golden("bearing_one_direction")
    assert result.verdict == "ambiguous"
    experiment = result.experiment
    assert experiment is not None
    assert result.next_experiment == experiment.words
    assert experiment.evidence > 100.0
    v = experiment.run.velocity_m_s
    assert np.min(v) < -0.5 * np.max(v) < 0.0


def test_diagnosis_without_a_tie_proposes_no_run_to_separate_effects() -> None:
    assert golden("bearing_coulomb_drag").experiment is None


@pytest.mark.extended
def test_tie_is_resolved_by_recording_the_proposed_run() -> None:
    experiment = golden("bearing_one_direction").experiment
    assert experiment is not None
    motions = (*ONE_WAY, played(experiment.run))
    rig, runs, _ = simulated(65, ("coulomb_drag",), motions=motions)
    result = jbf.diagnose(rig, runs)
    assert result.verdict == "missing"
    assert result.effects == ("coulomb_drag",)


@pytest.mark.extended
def test_inertia_that_slow_sweeps_do_not_show_is_named_with_the_proposed_run() -> None:
    sweeps = (sweep("sweep", 0.13, 60.0), sine("slow", 140.0, 0.127, 0.045))
    rig, runs, _ = simulated(67, ("inertia_leak",), motions=sweeps)
    first = jbf.diagnose(rig, runs)
    assert first.verdict == "adequate"
    assert "inertia_leak" in first.unseen
    assert "coulomb_drag" not in first.unseen
    assert first.experiment is not None
    assert "inertia_leak" in first.experiment.words
    motions = (*sweeps, played(first.experiment.run))
    rig, runs, _ = simulated(67, ("inertia_leak",), motions=motions)
    assert "inertia_leak" in jbf.diagnose(rig, runs).effects
