"""How often the recording is looked at again: as often as the policy says."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from by_hand import coulomb, four_runs
from jbf import Rig, diagnose
from jbf.diagnosis import late_channels, one_round, recipe, rounds
from jbf.diagnosis.candidates import Candidates
from jbf.diagnosis.policy import DEFAULT
from jbf.diagnosis.rounds import Selected, step
from jbf.estimation.campaign import Campaign
from jbf.estimation.lateness import Lateness
from jbf.estimation.noise import WHITE
from jbf.estimation.problem import Problem
from jbf.estimation.solution import Solution
from policy_gates import linear


@pytest.mark.parametrize("most", [2, DEFAULT.most_looks])
def test_so_many_times_selection_begins_anew(most: int, monkeypatch: pytest.MonkeyPatch) -> None:
    looks, rounds_of = [], []

    def seen(candidates: Candidates, present: tuple[str, ...]) -> Campaign:
        looks.append(candidates.campaign)
        return candidates.campaign

    def selected(candidates: Candidates, noise_n: float, start: Selected | None = None) -> Selected:
        rounds_of.append(candidates)
        assert start is None
        return Selected((), [step(candidates, (), noise_n, ())])

    monkeypatch.setattr(recipe, "_weighed", seen)
    monkeypatch.setattr(recipe, "select", selected)
    monkeypatch.setattr(recipe, "unseen", lambda candidates, present, powers: ())
    runs = four_runs(coulomb, noise_n=0.1)
    diagnose(Rig(), runs, law="coulomb", policy=replace(DEFAULT, most_looks=most))
    assert len(looks) == most
    assert len(rounds_of) == most + 1
    # A round of selection has nothing that another fitted.
    assert len({id(c) for c in rounds_of}) == most + 1


def test_once_an_effect_is_in_the_films_beginning_is_judged_by_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    runs = four_runs(lambda t, v, a: coulomb(t, v, a) + a, noise_n=0.1)
    campaigns: list[Campaign] = []

    def first_half(problem: Problem, solution: Solution) -> Campaign | None:
        campaigns.append(problem.campaign)
        if not problem.effects or len({id(c) for c in campaigns}) > 1:
            return None
        return problem.campaign.without([r.time_s < 5.0 for r in runs])

    monkeypatch.setattr(rounds, "settled_again", first_half)
    found = diagnose(Rig(), runs, law="coulomb")
    assert found.effects == ("inertia_leak",)
    # From the effects that were there, and nothing that was fitted to the other samples.
    first, last = campaigns[0], campaigns[-1]
    assert last.samples.count == pytest.approx(first.samples.count / 2, rel=0.02)
    assert [s.effects for s in found.steps] == [(), ("inertia_leak",)]
    assert found.steps[-1].trials
    assert found.model.parameters["inertia_leak.m_e_kg"].value == pytest.approx(1.0, rel=0.1)


def test_a_round_by_hand_judges_the_films_beginning_by_its_effects_too(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    # The first half has a force more that no law knows.
    runs = [
        replace(r, friction_n=r.friction_n + np.where(r.time_s < 5.0, 3.0, 0.0) * np.sin(r.time_s))
        for r in four_runs(lambda t, v, a: coulomb(t, v, a) + a, noise_n=0.1)
    ]

    def first_half(problem: Problem, solution: Solution) -> Campaign:
        assert problem.effects == solution.effects == ("inertia_leak",)
        return problem.campaign.without([r.time_s < 5.0 for r in runs])

    monkeypatch.setattr(one_round, "settled_again", first_half)
    found = one_round.one_round(Rig(), runs, ["inertia_leak"], law="coulomb")
    assert found.step.effects == ("inertia_leak",)
    assert found.step.holdout_rms_n == pytest.approx(0.1, rel=0.05)
    monkeypatch.setattr(one_round, "settled_again", lambda problem, solution: None)
    found = one_round.one_round(Rig(), runs, ["inertia_leak"], law="coulomb")
    assert found.step.holdout_rms_n > 0.5


@pytest.mark.parametrize("most", [1, DEFAULT.most_shifts])
def test_so_many_times_runs_are_shifted(most: int, monkeypatch: pytest.MonkeyPatch) -> None:
    looks: list[int] = []

    def always(
        problem: Problem, near: object, look: int, chance: float, jumps: bool
    ) -> Lateness | None:
        looks.append(look)
        assert chance == DEFAULT.deviation_chance
        return Lateness((3e-3, 6e-3, 9e-3, 12e-3), 0.0, 3e-3)

    monkeypatch.setattr(late_channels, "lateness", always)
    # What is made up here is not in the runs: asked of them, it would not be found.
    monkeypatch.setattr(late_channels, "jointly", lambda _, found: found)
    monkeypatch.setattr(late_channels, "_differ", lambda found, policy: True)
    problem = linear()
    near = problem.solution(problem.starts({})[0], problem.campaign.samples, WHITE)
    found = late_channels.on_time(problem, near, replace(DEFAULT, most_shifts=most), near, 1e9)
    assert looks == list(range(most))
    assert found is not None
    late = [f.size for f in found.more_findings]
    np.testing.assert_allclose(late, most * 3e-3 * np.arange(1, 5))
