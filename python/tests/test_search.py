"""Searches that share what they evaluated, and a first look that the approach goes on from."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from by_hand import coulomb, four_runs
from jbf import Rig, Run
from jbf.estimation import approach as module
from jbf.estimation.approach import LOOKED, Approach, approach
from jbf.estimation.campaign import Campaign
from jbf.estimation.minimum import settle
from jbf.estimation.noise import WHITE, Noise
from jbf.estimation.problem import Problem
from jbf.estimation.search import Place, Visited, _joins, search
from jbf.estimation.solution import Solution


def lagging(time: Any, velocity: Any, acceleration: Any) -> Any:
    return coulomb(time, velocity, acceleration) + 0.2 * acceleration


@pytest.fixture(scope="module")
def campaign() -> Campaign:
    runs = []
    for run in four_runs(lagging, noise_n=0.1):
        steps = 0.5 * (run.velocity_m_s[1:] + run.velocity_m_s[:-1]) * np.diff(run.time_s)
        place = np.concatenate(([0.0], np.cumsum(steps)))
        runs.append(
            Run.from_arrays(
                run.time_s, run.velocity_m_s, run.friction_n, position_m=place, name=run.name
            )
        )
    return Campaign.prepare(Rig(), runs)


def counted(problem: Problem, monkeypatch: pytest.MonkeyPatch) -> list[bytes]:
    """Where derivatives were asked for, in turn."""
    asked: list[bytes] = []
    linearise = problem.linearise

    def noted(values: Any, *more: Any, **named: Any) -> Any:
        asked.append(values.tobytes())
        return linearise(values, *more, **named)

    monkeypatch.setattr(problem, "linearise", noted)
    return asked


def base(campaign: Campaign) -> Solution:
    problem = Problem(campaign, "coulomb", "journal", ())
    return settle(problem, approach(problem, [{}], 8))


def test_a_search_does_not_come_twice(campaign: Campaign, monkeypatch: pytest.MonkeyPatch) -> None:
    problem = Problem(campaign, "stribeck", "journal", ("inertia_leak",))
    asked = counted(problem, monkeypatch)
    start, visited = problem.starts({})[0], Visited()
    first = search(problem, campaign.samples, start, WHITE, 5, visited=visited)
    count = len(asked)
    assert count >= 3
    # From where the first one ended: its place is known. It has not joined itself.
    visited.ended.clear()
    again = search(problem, campaign.samples, first.values, WHITE, 5, visited=visited)
    assert again.message != "joined another search"
    assert len(set(asked)) == len(asked)
    # Without a memory the same values.
    alone = search(problem, campaign.samples, start, WHITE, 5)
    assert alone.values == pytest.approx(first.values, rel=1e-12)


def test_a_search_ends_where_another_has_been(campaign: Campaign) -> None:
    problem = Problem(campaign, "coulomb", "journal", ("inertia_leak",))
    start, visited = problem.starts({})[0], Visited()
    lowest = search(problem, campaign.samples, start, WHITE, 20, visited=visited)
    elsewhere = start * 1.7
    joined = search(problem, campaign.samples, elsewhere, WHITE, 20, visited=visited)
    assert joined.message == "joined another search"
    assert not joined.converged
    assert problem.square(joined.values) >= problem.square(lowest.values)
    # Alone it goes to the end.
    alone = search(problem, campaign.samples, elsewhere, WHITE, 20)
    assert problem.square(alone.values) == pytest.approx(problem.square(lowest.values), rel=1e-6)


def place(x: float, residual: tuple[float, float], slope: tuple[float, float]) -> Place:
    value = np.array([x])
    return Place(np.log(value), value, value, np.array(residual), np.array([slope]).T, count=2)


def test_what_makes_two_places_one() -> None:
    here = place(1.0, (1.0, 0.0), (0.1, 0.0))
    lower = place(3.0, (0.5, 0.0), (0.1, 0.0))
    near = place(1.1, (1.0, 0.0), (0.1, 0.0))
    assert _joins(here, [near, lower])
    # Another that has not come lower than this has nothing to tell.
    higher = place(1.1, (1.2, 0.0), (0.1, 0.0))
    assert not _joins(here, [higher])
    # Two parameters a third apart are two places, whatever is predicted there.
    assert not _joins(here, [place(1.5, (1.0, 0.0), (0.01, 0.0)), lower])
    # But one that the data do not tell may be anywhere.
    nothing = place(9.0, (1.0, 0.0), (0.0, 0.0))
    assert _joins(place(1.0, (1.0, 0.0), (0.0, 0.0)), [nothing, lower])
    # So are those whose predictions differ by a fifth of the residual, by either's derivatives.
    steep = place(1.1, (1.0, 0.0), (2.0, 0.0))
    assert not _joins(here, [steep, lower])
    assert not _joins(steep, [here, lower])


def test_an_approach_goes_on_from_its_first_look(
    campaign: Campaign, monkeypatch: pytest.MonkeyPatch
) -> None:
    near = base(campaign)
    near = Solution(**{**vars(near), "noise": WHITE})
    problem = Problem(campaign, "coulomb", "journal", ("inertia_leak",))
    whole = approach(problem, [{}], 8)
    asked = counted(problem, monkeypatch)
    way = Approach(problem, [{}])
    look = way.look(near)
    assert 2 <= len(asked) <= LOOKED
    found = way.follow(8)
    # The place where it ends may be asked for once more: what all samples say is not kept.
    assert len(asked) - len(set(asked)) <= 1
    assert found.values == pytest.approx(whole.values, rel=1e-9)
    # What it promises is what the fit gains, nearly: the model is linear in all its numbers.
    gained = near.samples.count * np.log(
        near.samples.square(near.residuals) / near.samples.square(found.residuals)
    )
    assert look.promised == pytest.approx(gained, rel=0.01)
    assert 0.0 < look.gain <= look.promised * (1.0 + 1e-9)
    seen = way.solution_of(look, near)
    assert seen.noise is near.noise
    assert seen.samples.square(seen.residuals) == pytest.approx(
        near.samples.square(near.residuals) * np.exp(-look.gain / near.samples.count)
    )


def test_a_start_far_off_promises_more_than_it_has(
    campaign: Campaign, monkeypatch: pytest.MonkeyPatch
) -> None:
    near = Solution(**{**vars(base(campaign)), "noise": WHITE})
    problem = Problem(campaign, "coulomb", "journal", ("inertia_leak",))
    monkeypatch.setattr(module, "LOOKED", 1)
    look = Approach(problem, [{}]).look(near)
    assert look.gain < 0.0
    assert look.promised == pytest.approx(628.0, abs=1.0)


def test_beside_a_smooth_noise_a_sharp_feature_counts_for_what_it_is(campaign: Campaign) -> None:
    near = base(campaign)
    smooth = Solution(**{**vars(near), "noise": Noise(0.3, 0.9)})
    problem = Problem(campaign, "coulomb", "journal", ("inertia_leak",))
    white = Approach(problem, [{}]).look(near)
    coloured = Approach(problem, [{}]).look(smooth)
    assert coloured.promised >= white.promised
    assert coloured.gain >= white.gain


def test_beside_a_slow_wave_a_mass_is_seen_by_its_innovations() -> None:
    def wavy(t: Any, v: Any, a: Any) -> Any:
        return coulomb(t, v, a) + 0.3 * a + 2.0 * np.sin(0.5 * t)

    slow = Campaign.prepare(Rig(), four_runs(wavy, noise_n=0.1))
    near = base(slow)
    problem = Problem(slow, "coulomb", "journal", ("inertia_leak",))
    plain, seen = (
        Approach(problem, [{}]).look(Solution(**{**vars(near), "noise": noise}))
        for noise in (WHITE, Noise(0.6, 0.95))
    )
    # By squares the wave hides it.
    assert seen.gain > 3.0 * max(plain.gain, 1.0)
    assert seen.promised > 3.0 * max(plain.promised, 1.0)


@pytest.mark.parametrize(("effect", "met"), [("inertia_leak", True), ("drive_compliance", False)])
def test_ways_that_meet_end_but_among_many_peaks(
    campaign: Campaign, monkeypatch: pytest.MonkeyPatch, effect: str, met: bool
) -> None:
    problem = Problem(campaign, "coulomb", "journal", (effect,))
    messages: list[str] = []

    def noted(*given: Any, **named: Any) -> Any:
        found = search(*given, **named)
        messages.append(found.message)
        return found

    monkeypatch.setattr(module, "search", noted)
    start = dict(zip(problem.names, problem.starts({})[0].tolist(), strict=True))
    Approach(problem, [start, start]).follow(8)
    assert ("joined another search" in messages) == met
