"""Missing rows: samples after a gap are excluded until the film does not depend on it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from by_hand import Array
from jbf import Rig, Run
from jbf.estimation.campaign import Campaign
from jbf.estimation.film_gaps import behind_gaps
from jbf.estimation.initial_state import REMEMBERED
from jbf.estimation.prepared import Prepared
from jbf.estimation.problem import Problem
from jbf.estimation.run_start import settled_campaign
from jbf.estimation.samples import Samples

LEAST_N = 0.02
TIME = np.arange(0.0, 16.0, 0.02)


def step(at_s: float, up: bool) -> Array:
    """A speed that rises tenfold at an instant, or falls to a tenth."""
    rise = np.clip((TIME - at_s) / 0.04, 0.0, 1.0)
    v: Array = 0.01 + 0.1 * (rise if up else 1.0 - rise)
    return v


def journal_problem(run: Run) -> tuple[Problem, Array]:
    """The bearing's law along a motion, and its parameters."""
    prepared = (Prepared.of(Rig.thesis(), run),)
    problem = Problem(
        Campaign(Rig.thesis(), prepared, Samples.of(prepared)), "journal", "journal", ()
    )
    return problem, problem.starts({})[0]


def with_gap(first_s: float, last_s: float, at_s: float = 8.0, up: bool = True) -> Run:
    """The friction of the bearing, without the rows between two instants."""
    whole = Run.from_arrays(TIME, step(at_s, up), np.ones(len(TIME)), name="gap")
    problem, values = journal_problem(whole)
    whole = replace(whole, friction_n=problem.predict(values)[0])
    return whole.select((first_s > TIME) | (last_s < TIME))


@pytest.mark.parametrize(
    ("at_s", "up", "last_s", "least_n"),
    [(8.0, True, 8.11, LEAST_N), (8.0, False, 8.11, LEAST_N), (7.05, False, 7.6, 4.0)],
    ids=["faster at its end", "slower at its end", "slower at its start"],
)
def test_samples_whose_film_depends_on_the_motion_in_a_gap_are_excluded(
    at_s: float, up: bool, last_s: float, least_n: float
) -> None:
    """The model interpolates the speed across a gap from 7 s on; the speed changes at one end."""
    run = with_gap(7.0, last_s, at_s, up)
    problem, values = journal_problem(run)
    error = np.abs(problem.residuals(values)[0])
    (mask,) = behind_gaps(problem, values, least_n)
    wrong = error > 1.2 * least_n
    assert wrong.any()
    assert mask[wrong].all()
    set_aside = run.time_s[mask]
    assert last_s < set_aside.min() < last_s + 0.1
    assert set_aside.max() - set_aside.min() < 3.0
    assert behind_gaps(problem, values, 1e3)[0].sum() == 0


@pytest.mark.parametrize(("first_s", "last_s"), [(3.0, 4.0), (12.0, 13.0), (8.01, 8.05)])
def test_no_samples_are_excluded_after_a_gap_at_constant_speed_or_of_two_rows(
    first_s: float, last_s: float
) -> None:
    problem, values = journal_problem(with_gap(first_s, last_s))
    assert not behind_gaps(problem, values, LEAST_N)[0].any()


@pytest.mark.parametrize(("missing", "gap"), [(3, False), (4, True)])
def test_four_missing_rows_are_a_gap_and_three_are_not(missing: int, gap: bool) -> None:
    """A gap is a step above 4.5 times the usual one; here it is within the change of speed."""
    kept = np.ones(len(TIME), dtype=bool)
    kept[401 : 401 + missing] = False
    run = Run.from_arrays(TIME, step(8.0, True), np.ones(len(TIME)), name="a").select(kept)
    problem, values = journal_problem(run)
    assert bool(behind_gaps(problem, values, 1e-4)[0].any()) == gap


def test_no_samples_are_excluded_after_a_gap_for_a_law_without_a_film() -> None:
    problem = Problem(Campaign.prepare(Rig(), [with_gap(7.0, 8.11)]), "coulomb", "journal", ())
    assert not behind_gaps(problem, problem.starts({})[0], LEAST_N)[0].any()


def test_samples_after_a_gap_are_excluded_if_their_error_exceeds_a_fifth_of_the_noise() -> None:
    run, noise_n = with_gap(7.0, 8.11, up=False), 0.02
    noise = noise_n * np.random.default_rng(4).standard_normal(len(run))
    campaign = Campaign.prepare(Rig.thesis(), [replace(run, friction_n=run.friction_n + noise)])
    settled = settled_campaign(campaign, "journal", "journal")
    gone = run.time_s[campaign.samples.counted[0] & ~settled.samples.counted[0]]
    (behind,) = behind_gaps(*journal_problem(run), REMEMBERED * noise_n)
    found, expected = gone[gone > 8.0], run.time_s[behind]
    assert (found[0], found[-1]) == pytest.approx((expected[0], expected[-1]), abs=0.15)


def test_samples_excluded_after_a_gap_do_not_depend_on_the_zero_of_time() -> None:
    run = with_gap(7.0, 8.11)
    later = Run.from_arrays(run.time_s + 1000.0, run.velocity_m_s, run.friction_n, name="later")
    masks = [behind_gaps(*journal_problem(r), LEAST_N)[0] for r in (run, later)]
    assert masks[0].any()
    np.testing.assert_array_equal(*masks)
