"""Whether the runs agree on the parameters."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from by_hand import Array, Friction, coulomb, four_runs
from campaigns import campaign
from jbf import Rig, Run, diagnose
from jbf.diagnosis.constancy import disagreement, find_disagreement, own_step
from jbf.diagnosis.policy import DEFAULT
from jbf.estimation.between_runs import BetweenRuns
from jbf.estimation.campaign import Campaign
from jbf.estimation.minimum import minimum
from jbf.estimation.problem import Problem
from jbf.estimation.solution import Solution


def _solved(rig: Rig, runs: list[Run], effects: tuple[str, ...] = ()) -> tuple[Problem, Solution]:
    problem = Problem(Campaign.prepare(rig, runs), "journal", "journal", effects)
    return problem, minimum(problem, [{}])


@pytest.mark.parametrize("coloured", [False, True])
@pytest.mark.parametrize("effects", [(), ("sensor_lag",), ("wear_in",)])
def test_runs_of_one_rig_agree(effects: tuple[str, ...], coloured: bool) -> None:
    rig, runs, _ = campaign(11, effects, coloured=coloured)
    problem, solution = _solved(rig, runs, effects)
    found = disagreement(problem, solution)
    # A chi-square is within four of its standard deviations of its mean.
    assert abs(found.gain - found.degrees) < 4.0 * np.sqrt(2.0 * found.degrees), found
    assert 0 < found.degrees <= (len(runs) - 1) * len(solution.values)
    assert find_disagreement(problem, solution, DEFAULT) == []


def test_the_run_of_another_rig_is_named() -> None:
    rig, runs, _ = campaign(11)
    assert runs[2].friction_n is not None
    # A cell calibrated anew before the third run.
    mixed = [*runs[:2], replace(runs[2], friction_n=1.08 * runs[2].friction_n), *runs[3:]]
    problem, solution = _solved(rig, mixed)
    found = disagreement(problem, solution)
    assert found.beyond_chance()
    (said,) = find_disagreement(problem, solution, DEFAULT)
    assert said.axis == "parameters"
    assert runs[2].name in said.where
    d = diagnose(rig, mixed)
    # Of the whole campaign it is a finding: the gain has a spread between runs.
    assert d.verdict == "adequate"
    assert d.effects == ()
    assert "gain_by_run" in {f.kind for f in d.findings}


def test_what_a_run_asks_for_is_said_with_its_size() -> None:
    """Dry friction of 5 N in three runs and of 6 N in the fourth, or 8 N s/m more."""

    def more(t: Array, v: Array, a: Array) -> Array:
        return coulomb(t, v, a) + np.sign(v)

    def said(other: Friction) -> str:
        runs = four_runs(coulomb, noise_n=0.05)
        runs[3] = four_runs(other, noise_n=0.05)[3]
        problem = Problem(Campaign.prepare(Rig(), runs), "coulomb", "journal", ())
        (found,) = find_disagreement(problem, minimum(problem, [{}]), DEFAULT)
        return found.where

    found = re.search(r"run d asks for F_c_n (\d+\.?\d*) % higher \((\d+) times", said(more))
    assert found is not None
    # A quarter of the 1 N went into the common 5.25 N.
    assert float(found[1]) == pytest.approx(100.0 * 0.75 / 5.25, rel=0.15)
    assert int(found[2]) > 100

    def thicker(t: Array, v: Array, a: Array) -> Array:
        return coulomb(t, v, a) + 8.0 * v

    words = said(thicker)
    assert "check its load, zero and temperature" in words
    found = re.search(r"run d asks for F_v_n_s_m (\S+) N s/m higher", words)
    assert found is not None
    assert float(found[1]) == pytest.approx(6.0, rel=0.25)


def test_what_a_run_asks_for_is_said_to_three_digits() -> None:
    """With next to no noise the step is what the runs were made with: 6 N where the others have a
    common fit, to first order in the logarithm."""

    def more(t: Array, v: Array, a: Array) -> Array:
        return coulomb(t, v, a) + np.sign(v)

    runs = [*four_runs(coulomb, noise_n=1e-6)[:3], four_runs(more, noise_n=1e-6)[3]]
    problem = Problem(Campaign.prepare(Rig(), runs), "coulomb", "journal", ())
    solution = minimum(problem, [{}])
    common = dict(zip(problem.names, solution.values, strict=True))["F_c_n"]
    found = re.match(r"F_c_n (\S+) % higher", own_step(problem, solution, "d"))
    assert found is not None
    assert float(found[1]) == pytest.approx(100.0 * np.expm1(6.0 / common - 1.0), rel=2e-3)


def test_one_run_cannot_disagree() -> None:
    rig, runs, _ = campaign(11)
    problem, solution = _solved(rig, runs[:1])
    # Wherever the parameters stand: what they would gain is no disagreement.
    off = problem.solution(1.05 * solution.values, solution.samples, solution.noise)
    for there in (solution, off):
        assert disagreement(problem, there).degrees == 0
        assert find_disagreement(problem, there, DEFAULT) == []


def test_parameters_in_common_that_are_off_are_no_disagreement() -> None:
    rig, runs, _ = campaign(11)
    problem, solution = _solved(rig, runs)
    at = disagreement(problem, solution)
    values = solution.values * [1.02, 1.0, 1.0, 1.0]
    off = problem.solution(values, solution.samples, solution.noise)
    # The runs would gain much, but all the same.
    assert disagreement(problem, off).gain < at.gain + 4.0 * np.sqrt(2.0 * at.degrees)


def test_in_what_runs_are_known_to_deviate_they_need_not_agree() -> None:
    rig, runs, _ = campaign(11)
    problem, solution = _solved(rig, runs)
    # One oil in the first two runs, a thicker one in the others.
    place = [problem.names[i] for i in problem.open].index("gamma")
    thicker = [
        e + 0.15 * (1 if i < 2 else -1) * j[:, place]
        for i, (e, j) in enumerate(zip(solution.residuals, solution.jacobian, strict=True))
    ]
    off = replace(solution, residuals=thicker)
    assert disagreement(problem, off).beyond_chance()
    # Directions so small that they whiten nothing: it is the parameter that is set aside.
    tiny = tuple(np.full((len(e), 1), 1e-12) for e in thicker)
    known = replace(off.samples, between=BetweenRuns(("gamma",), tiny, 1.0))
    assert not disagreement(problem, replace(off, samples=known)).beyond_chance()
    other = replace(off.samples, between=BetweenRuns(("zero",), tiny, 1.0))
    assert disagreement(problem, replace(off, samples=other)).beyond_chance()


def test_each_run_may_have_its_peak_of_a_ringing_drive() -> None:
    rig, runs, _ = campaign(34, ("drive_compliance",))
    problem, solution = _solved(rig, runs, ("drive_compliance",))
    found = disagreement(problem, solution)
    # Of seven parameters four are asked of the runs.
    assert 0 < found.degrees <= 4 * (len(runs) - 1)
    assert not found.beyond_chance()
