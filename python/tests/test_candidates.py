"""How far each model is fitted, and from where: the states of a candidate, notes for fits."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from by_hand import coulomb, four_runs
from jbf import Rig, Run
from jbf.diagnosis import candidates as module
from jbf.diagnosis.candidates import Candidates
from jbf.estimation.approach import Look
from jbf.estimation.campaign import Campaign
from jbf.estimation.left_out import LeftOut
from jbf.estimation.problem import Problem
from jbf.estimation.solution import Solution
from made_up import BARE_N, N, solution

RING = "drive_compliance"


@pytest.fixture(scope="module")
def campaign() -> Campaign:
    runs = []
    for run in four_runs(lambda t, v, a: coulomb(t, v, a) + 0.2 * a, noise_n=0.1):
        steps = 0.5 * (run.velocity_m_s[1:] + run.velocity_m_s[:-1]) * np.diff(run.time_s)
        place = np.concatenate(([0.0], np.cumsum(steps)))
        runs.append(
            Run.from_arrays(
                run.time_s, run.velocity_m_s, run.friction_n, position_m=place, name=run.name
            )
        )
    return Campaign.prepare(Rig(), runs)


class Fits:
    """In place of the fits: solutions of gains as told, and a note of each call."""

    def __init__(self, fresh: float = 0.0, peaks: float = 0.0) -> None:
        self.fresh, self.peaks = fresh, peaks
        self.notes: list[tuple[str, Any]] = []

    def approach(
        self, problem: Problem, seeds: Sequence[Mapping[str, float]], *_: Any, **__: Any
    ) -> Solution:
        return self.begin(problem, seeds).follow()

    def begin(
        self, problem: Problem, seeds: Sequence[Mapping[str, float]], **_: Any
    ) -> SimpleNamespace:
        made = replace(solution(problem.effects, self.fresh), values=problem.starts({})[0])

        def look(near: Solution) -> Look:
            self.notes.append(("look", [dict(seed) for seed in seeds]))
            return Look(made.values, 1.0, 30.0, None)

        def follow(*_: Any) -> Solution:
            self.notes.append(("approach", [dict(seed) for seed in seeds]))
            return made

        return SimpleNamespace(look=look, follow=follow, solution_of=lambda look, near: made)

    def settle(self, problem: Problem, near: Solution, *_: Any) -> Solution:
        self.notes.append(("settle", near))
        return near

    def search_peaks(self, problem: Problem, near: Solution) -> Solution:
        self.notes.append(("peaks", near))
        return solution(problem.effects, self.peaks) if self.peaks else near

    def called(self) -> list[str]:
        return [name for name, _ in self.notes]


@pytest.fixture
def fits(monkeypatch: pytest.MonkeyPatch) -> Fits:
    found = Fits()
    for name in ("approach", "settle", "search_peaks"):
        monkeypatch.setattr(module, name, getattr(found, name))
    monkeypatch.setattr(module, "Approach", found.begin)
    # Solutions that are made up have no residual of the campaign's.
    monkeypatch.setattr(Candidates, "_least_square", lambda *_: np.inf)

    def left_out(problem: Problem, near: Solution) -> list[LeftOut]:
        every = np.ones(N, dtype=bool)
        return [LeftOut((0,), (every,), np.ones(near.free, dtype=bool), tuple(near.residuals))]

    monkeypatch.setattr(module, "left_out", left_out)
    return found


def test_each_state_is_reached_once(campaign: Campaign, fits: Fits) -> None:
    every = Candidates(campaign, "coulomb", "journal")
    first = every.converge(["sensor_lag"])
    assert fits.called() == ["approach", "settle"]
    assert every.rank(["sensor_lag"]) is first
    assert every.converge(("sensor_lag",)) is first
    assert fits.called() == ["approach", "settle"]


def test_a_first_look_goes_on_where_it_ended(campaign: Campaign, fits: Fits) -> None:
    every = Candidates(campaign, "coulomb", "journal")
    near = every.converge([])
    fits.notes.clear()
    looked = every.look(["sensor_lag"], near)
    assert (looked.state, looked.promised) == ("looked", 30.0)
    assert every.look(["sensor_lag"], near) is looked
    # Where it was looked at only it is no start for anything.
    assert every.values_of(["sensor_lag"]) is None
    seeds = fits.notes[0][1]
    every.rank(["sensor_lag"])
    assert (looked.state, looked.promised) == ("ranked", np.inf)
    assert fits.notes == [("look", seeds), ("approach", seeds)]
    # What was ranked is not looked at.
    every.look(["sensor_lag"], near)
    assert fits.called() == ["look", "approach"]


def test_a_candidate_starts_from_the_smaller_model_and_anew(campaign: Campaign, fits: Fits) -> None:
    every = Candidates(campaign, "coulomb", "journal")
    near = every.converge(["sensor_lag"])
    every.rank(["sensor_lag", "sensor_offset"], near)
    names = every.fitted(["sensor_lag"]).problem.names
    law, kept = fits.notes[-1][1]
    assert list(law) == names
    # The law anew, the effect that is there kept.
    assert list(kept) == ["sensor_lag.tau_s"]


def test_a_ringing_drive_is_no_start_for_others(campaign: Campaign, fits: Fits) -> None:
    every = Candidates(campaign, "coulomb", "journal")
    every.rank([RING, "sensor_offset"], every.converge([RING]))
    assert fits.notes[-1][1][1] == {}


def test_a_better_peak_voids_what_followed_from_the_other(campaign: Campaign, fits: Fits) -> None:
    every = Candidates(campaign, "coulomb", "journal")
    before = every.left_out_rms(["sensor_lag"])
    assert before == pytest.approx(BARE_N)
    fits.peaks = 200.0
    found = every.search_peaks(["sensor_lag"])
    assert every.converge(["sensor_lag"]) is found
    assert every.left_out_rms(["sensor_lag"]) == pytest.approx(BARE_N * np.exp(-200.0 / 2000.0))
    # Once for each set.
    count = len(fits.notes)
    assert every.search_peaks(["sensor_lag"]) is found
    assert len(fits.notes) == count


@pytest.mark.parametrize(("fresh", "kept"), [(50.0, True), (-50.0, False), (-70.0, False)])
def test_many_peaks_are_sought_as_if_nothing_had_been_found(
    campaign: Campaign, fits: Fits, fresh: float, kept: bool
) -> None:
    every = Candidates(campaign, "coulomb", "journal")
    both = [RING, "sensor_offset"]
    near = every.converge(both)
    fits.notes.clear()
    fits.fresh = fresh
    found = every.search_peaks(both)
    # A fresh start far behind is not followed.
    followed = ["approach", "settle", "peaks"] if fresh > -60.0 else ["approach"]
    assert fits.called() == ["peaks", *followed]
    assert fits.notes[1] == ("approach", [{}])
    assert (found is not near) == kept


def test_one_effect_alone_has_no_fresh_start(campaign: Campaign, fits: Fits) -> None:
    every = Candidates(campaign, "coulomb", "journal")
    every.converge([RING])
    fits.notes.clear()
    every.search_peaks([RING])
    assert fits.called() == ["peaks"]


def test_fewer_effects_are_fitted_from_where_they_are_in_a_richer_model(
    campaign: Campaign,
) -> None:
    every = Candidates(campaign, "coulomb", "journal")
    whole = every.converge(["inertia_leak", "sensor_offset"])
    worse = every.fitted(["inertia_leak"])
    true = every.converge(["inertia_leak"])
    where = worse.problem.names.index("inertia_leak.m_e_kg")
    assert true.values[where] == pytest.approx(0.2, abs=0.03)
    # As if caught in a valley.
    caught = true.values.copy()
    caught[where] = 0.0
    worse.solution = worse.problem.solution(caught, true.samples, true.noise)
    assert worse.solution.cost > true.cost + 50.0
    found = every.refit_from(["inertia_leak"], whole.effects)
    assert found.cost == pytest.approx(true.cost, abs=0.5)
    assert every.converge(["inertia_leak"]) is found


@pytest.mark.parametrize(("times", "taken"), [(1.2, True), (1.3, False)])
def test_a_likelier_fit_that_is_far_off_is_not_taken(
    times: float, taken: bool, campaign: Campaign, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Beside deviations of the runs a law that is wrong may leave more and be likelier."""
    every = Candidates(campaign, "coulomb", "journal")
    every.converge(["inertia_leak", "sensor_offset"])
    near = every.converge(["inertia_leak"])
    residuals = [times * r for r in near.residuals]
    likelier = replace(near, residuals=residuals, cost=near.cost - 100.0)
    monkeypatch.setattr(module, "settle", lambda *_: likelier)
    found = every.refit_from(["inertia_leak"], ["inertia_leak", "sensor_offset"])
    assert (found is likelier) == taken


def test_the_score_test_promises_what_a_linear_effect_gains(campaign: Campaign) -> None:
    every = Candidates(campaign, "coulomb", "journal")
    bare, found = every.converge([]), every.converge(["inertia_leak"])
    n = campaign.samples.count
    # Of a linear effect one step is the whole way, under the noise of the bare law.
    square = [
        campaign.samples.stacked(s.residuals, s.jacobian, bare.noise)[0] for s in (bare, found)
    ]
    gain = n * np.log(np.sum(square[0] ** 2) / np.sum(square[1] ** 2))
    assert every.score_test(["inertia_leak"], bare) == pytest.approx(gain, rel=0.05)
    assert every.score_test(["sensor_drift"], bare) < 10.0
    # The null of a stiff contact is at infinity: no step leads there.
    assert every.score_test(["presliding"], bare) == np.inf
    # A jump that moves by less than a sample moves none: at their null these show nothing.
    assert every.score_test(["backlash"], bare) == np.inf
    assert every.score_test(["time_delay"], bare) == np.inf
    # Of what rounds a jump the samples beside it tell most, and nothing at the null.
    assert every.score_test(["sensor_lag"], bare) == np.inf
    assert every.fitted(["sensor_lag"]).directions is not None


def test_every_effect_is_tried_or_said_not_to_be(campaign: Campaign) -> None:
    every = Candidates(campaign, "coulomb", "journal")
    assert RING in every.names
    of_loads = {f"{what}_load_dependence" for what in ("dry", "viscous", "zero")}
    of_warmth = {f"{what}_temperature_dependence" for what in ("dry", "viscous")}
    assert set(every.not_tried) == {"position_ripple", "gravity", *of_loads, *of_warmth}
    # An axis has a place, if no angle.
    assert {"cogging", "pitch_ripple"} <= {*every.names}
    assert not {"coulomb_drag", "film_memory"} & {*every.names, *every.not_tried}
