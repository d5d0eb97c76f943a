"""A film that the records never see at work is refused in a line, not followed without an end."""

from __future__ import annotations

from pathlib import Path

import jbf
import numpy as np
import pytest
from jbf import Bearing, InputError, Load, Lubricant, Rig, Run
from jbf.diagnosis.which_law import followed
from jbf.estimation.campaign import Campaign
from jbf.estimation.film_rate import ANY_STEPS, MOST_STEPS, check_film
from jbf.estimation.problem import Problem
from jbf.estimation.work import Work

SAMPLES = 3000


def recorded(step_s: float, turns_rad_s: float, samples: int = SAMPLES) -> Run:
    """A sine with dry friction."""
    t = step_s * np.arange(samples)
    v = 0.05 * np.sin(turns_rad_s * t)
    return Run.from_arrays(t, v, 20.0 * np.sign(v) + 30.0 * v, name="sine")


IN_SECONDS = recorded(0.02, 0.8)
IN_MILLISECONDS = recorded(20.0, 0.8e-3)


def said(run: Run, rig: Rig, law: str = "journal") -> str:
    with pytest.raises(InputError) as refusal:
        check_film(Campaign.prepare(rig, [run]), law, "journal")
    return str(refusal.value)


def test_times_in_milliseconds_end_in_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    """Before a first prediction: a fit to milliseconds taken for seconds takes hours."""
    taken: list[float] = []
    monkeypatch.setattr(Work, "take", lambda _, steps: taken.append(steps))
    for call in (jbf.fit, jbf.diagnose):
        with pytest.raises(InputError, match="check that times are in seconds") as refusal:
            call(Rig.thesis(), [IN_MILLISECONDS], law="journal")
        assert (refusal.value.column, refusal.value.file) == ("time_s", "sine")
        assert "a sample every 20 s" in str(refusal.value)
        assert "\n" not in str(refusal.value)
    assert taken == []
    jbf.fit(Rig.thesis(), [IN_SECONDS], law="coulomb")
    assert taken


def test_the_same_run_in_seconds_is_followed() -> None:
    campaign = Campaign.prepare(Rig.thesis(), [IN_SECONDS])
    check_film(campaign, "journal", "journal")
    check_film(campaign, "journal_full", "journal")
    assert {"journal", "journal_full", "stribeck"} <= set(followed(campaign, "journal")[0])


def test_laws_without_a_film_take_any_times() -> None:
    campaign = Campaign.prepare(Rig.thesis(), [IN_MILLISECONDS])
    for law in ("coulomb", "stribeck", "lugre"):
        check_film(campaign, law, "journal")
    left, refused = followed(campaign, "journal")
    assert "stribeck" in left
    assert not {"journal", "journal_full"} & set(left)
    assert "cannot be identified" in refused["law journal"]


def test_the_limit_is_steps_from_sample_to_sample() -> None:
    """By the rate that the chain itself tells, at the slowest of the starting points."""
    rig = Rig.thesis()
    problem = Problem(Campaign.prepare(rig, [IN_SECONDS]), "journal", "journal", ())
    motions = problem.campaign.motions
    rate = min(problem.chain.film_rate_1_s(s, motions) for s in problem.starts({}))
    longest = MOST_STEPS / rate
    check_film(Campaign.prepare(rig, [recorded(0.9 * longest, 0.01)]), "journal", "journal")
    assert said(recorded(1.1 * longest, 0.01), rig)


def test_a_short_slow_record_costs_nothing_and_is_followed() -> None:
    rig = Rig.thesis()
    slow = recorded(20.0, 0.8e-3, samples=30)
    rate = 1e2
    assert rate * slow.duration_s < ANY_STEPS
    check_film(Campaign.prepare(rig, [slow]), "journal", "journal")


def test_a_start_that_the_user_gives_is_judged(tmp_path: Path) -> None:
    """A transition speed far above those on record makes the film as much slower."""
    campaign = Campaign.prepare(Rig.thesis(), [IN_MILLISECONDS])
    rates = [
        Problem(campaign, "journal", "journal", ()).chain.film_rate_1_s(start, campaign.motions)
        for seed in ({}, {"U_tr_m_s": 1e-5})
        for start in Problem(campaign, "journal", "journal", ()).starts(seed)[:1]
    ]
    assert rates[0] != rates[1]
    given = f"answers within {1.0 / rates[1]:.1g} s"
    with pytest.raises(InputError, match="answers within") as refusal:
        check_film(campaign, "journal", "journal", {"U_tr_m_s": 1e-5})
    assert given in str(refusal.value)


def test_a_rig_of_no_bearing() -> None:
    """Seconds by themselves are no fault: the bearing's numbers are."""
    bearing = Bearing(radius_m=1.7e-3, length_m=2e-3, clearance_m=5e-5, mass_kg=1.0, count=1)
    rig = Rig(bearing, Lubricant(viscosity_pa_s=1e-4), Load(normal_n=1e5))
    assert "answers within" in said(recorded(0.05, 0.8), rig)
