"""Of many starting points the likely ones are tried on all runs, and the best is among them."""

from __future__ import annotations

import numpy as np
import pytest
from campaigns import campaign
from jbf.estimation import approach
from jbf.estimation.approach import MANY, Approach
from jbf.estimation.campaign import Campaign
from jbf.estimation.problem import Problem

BESIDE = ("sensor_offset", "inertia_leak", "gravity")


@pytest.fixture(scope="module")
def problem() -> Problem:
    rig, runs, _ = campaign(11)
    return Problem(Campaign.prepare(rig, runs), "stribeck", "journal", BESIDE)


def test_the_best_start_is_found_by_a_look_at_one_run(problem: Problem) -> None:
    every = problem.starts({})
    assert len(every) > 2 * MANY
    squares = [problem.square(start) for start in every]
    kept = Approach(problem, [{}]).starts
    assert len(kept) == max(MANY, len(every) // approach.LIKELY)
    assert problem.square(kept[0]) == min(squares)
    # And none of the better half of the best is lost.
    best = np.sort(squares)[: MANY // 2]
    assert {problem.square(start) for start in kept} >= set(best)


def test_a_few_starts_are_all_tried(problem: Problem, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(approach, "MANY", len(problem.starts({})))
    assert len(Approach(problem, [{}]).starts) == len(problem.starts({}))


def test_one_run_has_no_other_to_look_at(problem: Problem) -> None:
    alone = Problem(problem.campaign.only([0]), "stribeck", "journal", BESIDE)
    assert len(Approach(alone, [{}]).starts) == len(alone.starts({}))
