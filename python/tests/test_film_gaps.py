"""Rows that are missing, and what a film remembers of them."""

from __future__ import annotations

import sys
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from by_hand import Array
from jbf import Rig, Run
from jbf.estimation.campaign import Campaign
from jbf.estimation.film_gaps import EDGE, _gaps, _through, behind_gaps
from jbf.estimation.prepared import Prepared
from jbf.estimation.problem import Problem
from jbf.estimation.run_start import settled_campaign
from jbf.estimation.samples import Samples

LEAST_N = 0.02
module = sys.modules["jbf.estimation.film_gaps"]


def corner(t: Array) -> Array:
    """Slow, then setting out at 8 s."""
    v: Array = 0.01 + 0.1 * np.clip((t - 8.0) / 0.1, 0.0, 1.0)
    return v


def run_with_gap(first_s: float, last_s: float) -> tuple[Run, Run]:
    """A run with its friction by the law, and the same without the rows of a gap."""
    t = np.arange(0.0, 16.0, 0.02)
    whole = Run.from_arrays(t, corner(t), np.ones(len(t)), name="whole")
    problem, values = posed(whole)
    whole = replace(whole, friction_n=problem.predict(values)[0])
    return whole, whole.select((t < first_s) | (t > last_s))


def posed(*runs: Run) -> tuple[Problem, Array]:
    prepared = [Prepared.of(Rig.thesis(), run) for run in runs]
    campaign = Campaign(Rig.thesis(), tuple(prepared), Samples.of(prepared))
    problem = Problem(campaign, "journal", "journal", ())
    return problem, problem.starts({})[0]


def test_what_the_film_makes_of_a_gap_is_within_what_is_set_aside() -> None:
    whole, gap = run_with_gap(7.0, 8.11)
    problem, values = posed(gap)
    error = np.abs(problem.residuals(values)[0])
    (mask,) = behind_gaps(problem, values, LEAST_N)
    # A line through the gap is wrong behind it, and right again once that is forgotten.
    assert np.max(error) > 5.0 * LEAST_N
    wrong = error > 2.0 * LEAST_N
    assert mask[wrong].all()
    at = gap.time_s[mask]
    assert 8.1 < at.min() < 8.2
    assert 0.05 < at.max() - at.min() < 3.0
    assert whole.time_s[-1] == gap.time_s[-1]


@pytest.mark.parametrize(("first_s", "last_s"), [(3.0, 4.0), (12.0, 13.0), (8.01, 8.05)])
def test_a_gap_that_hides_nothing_costs_nothing(first_s: float, last_s: float) -> None:
    # At one speed on both sides, or too short to hide a corner.
    _, gap = run_with_gap(first_s, last_s)
    problem, values = posed(gap)
    (mask,) = behind_gaps(problem, values, LEAST_N)
    assert not mask.any()


@pytest.mark.parametrize(("missing", "gaps"), [(1, 0), (3, 0), (4, 1), (9, 1)])
def test_a_gap_is_four_rows_that_are_missing(missing: int, gaps: int) -> None:
    """Jitter and a row that was lost are none."""
    t = np.arange(0.0, 16.0, 0.02)
    kept = np.ones(len(t), dtype=bool)
    kept[398 : 398 + missing] = False
    whole = Run.from_arrays(t, corner(t), np.ones(len(t)), name="whole")
    problem, _ = posed(whole.select(kept))
    assert len(_gaps(problem.campaign.prepared[0])) == gaps


def test_a_law_without_a_film_has_nothing_to_forget() -> None:
    _, gap = run_with_gap(7.0, 8.11)
    campaign = Campaign.prepare(Rig(), [gap])
    problem = Problem(campaign, "coulomb", "journal", ())
    (mask,) = behind_gaps(problem, problem.starts({})[0], LEAST_N)
    assert not mask.any()


def test_a_campaign_leaves_those_samples_out() -> None:
    whole, gap = run_with_gap(7.0, 8.11)
    noise = 0.02 * np.random.default_rng(4).standard_normal(len(gap))
    noisy = replace(gap, friction_n=gap.friction_n + noise)
    campaign = Campaign.prepare(Rig.thesis(), [noisy])
    settled = settled_campaign(campaign, "journal", "journal")
    behind = (gap.time_s > 8.1) & (gap.time_s < 8.2)
    assert campaign.samples.counted[0][behind].any()
    assert not settled.samples.counted[0][behind].any()
    assert settled.samples.counted[0][gap.time_s > 13.0].all()
    assert whole.name == "whole"


@pytest.mark.parametrize("late", [False, True])
def test_an_imagined_motion_changes_its_speed_at_an_end_of_the_gap(
    late: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It keeps the speed from before until a thousandth of the gap is left, or has the one behind
    from its first thousandth on; all that was recorded stays."""
    t = np.arange(0.0, 16.0, 0.02)
    kept = ((t < 7.0) | (t > 8.11)) & ((t < 10.0) | (t > 10.49))
    run = Run.from_arrays(t[kept], 0.02 * (1.0 + t[kept]), np.ones(int(kept.sum())), name="broken")
    problem, _ = posed(run)
    (p,) = problem.campaign.prepared
    asked: list[Any] = []
    real = module.core_motion

    def seen(rig: Rig, run: Run, motion: Any) -> Any:
        asked.append((run, motion))
        return real(rig, run, motion)

    monkeypatch.setattr(module, "core_motion", seen)
    driven = _through(p, late=late)
    ((whole, motion),) = asked
    gaps = _gaps(p)
    begin, end = run.time_s[gaps], run.time_s[gaps + 1]
    assert end - begin == pytest.approx([1.14, 0.52])
    new = end - EDGE * (end - begin) if late else begin + EDGE * (end - begin)
    assert EDGE == 1e-3
    assert whole.time_s == pytest.approx(np.sort(np.concatenate((run.time_s, new))))
    assert driven.kept is not None
    assert whole.time_s[driven.kept].tolist() == run.time_s.tolist()
    at = np.searchsorted(whole.time_s, new - 1e-9)
    held = p.motion.velocity_m_s[gaps if late else gaps + 1]
    assert motion.velocity_m_s[at].tolist() == held.tolist()
    assert motion.acceleration_m_s2[at].tolist() == [0.0, 0.0]
    assert motion.velocity_m_s[driven.kept] == pytest.approx(p.motion.velocity_m_s)
