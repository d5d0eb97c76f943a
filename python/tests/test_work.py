"""Every fit and diagnosis has an end, counted in steps of the model."""

from __future__ import annotations

import pickle
from pathlib import Path

import jbf
import numpy as np
import pytest
from by_hand import coulomb, four_runs
from campaigns import campaign
from jbf.cli import main
from jbf.diagnosis import recipe
from jbf.diagnosis import which_law as laws
from jbf.errors import Unfinished
from jbf.estimation import work
from jbf.estimation.campaign import Campaign
from jbf.estimation.problem import Problem
from jbf.estimation.work import Work
from jbf.reporting.diagnosis_text import diagnosis_report


def test_steps_are_counted_to_the_end() -> None:
    budget = Work(10.0)
    budget.take(4.0)
    budget.take(6.0)
    with pytest.raises(Unfinished, match="1e\\+01 steps"):
        budget.take(1.0)
    assert budget.part(0.5).most == 5.0
    budget.renew(3.0)
    budget.take(3.0)


def test_a_prediction_costs_its_inner_steps() -> None:
    rig, runs, _ = campaign(5)
    prepared = Campaign.prepare(rig, runs)
    problem = Problem(prepared, "journal", "journal", ())
    values = problem.starts({})[0]
    samples = sum(len(run) for run in runs)
    k0 = problem.names.index("K0")
    few, many = values.copy(), values.copy()
    few[k0], many[k0] = 1e4, 1e7
    costs = [problem.chain.inner_steps(v, prepared.motions) for v in (few, many)]
    assert 2.0 * samples <= costs[0] < costs[1]
    rate = problem.chain.film_rate_1_s(many, prepared.motions)
    seconds = sum(run.duration_s for run in runs)
    # A stable step is so long that no more than the rate's inverse is left out.
    assert costs[1] - samples == pytest.approx(rate * seconds, rel=0.5)
    before = prepared.work.taken
    problem.predict(few)
    assert prepared.work.taken - before == costs[0]
    problem.linearise(few)
    assert prepared.work.taken - before > 2.0 * costs[0]


def test_a_diagnosis_without_end_is_ended_with_what_it_has(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    rig, runs, truth = campaign(7, ("coulomb_drag",))
    monkeypatch.setattr(work, "STEPS_A_SAMPLE", 600.0)
    monkeypatch.setattr(work, "ANY_STEPS", 0.0)
    with pytest.raises(Unfinished, match="the best so far is journal") as ended:
        jbf.diagnose(rig, runs)
    assert "\n" not in str(ended.value)
    assert "check that times are in seconds" in str(ended.value)
    assert ended.value.fit.rms_n > truth["noise_n"]
    assert np.all(np.isfinite(list(ended.value.fit.model.values)))
    again = pickle.loads(pickle.dumps(ended.value))
    assert str(again) == str(ended.value)


def test_a_fit_without_end_is_ended_with_what_it_has(monkeypatch: pytest.MonkeyPatch) -> None:
    rig, runs, _ = campaign(7)
    whole = jbf.fit(rig, runs)
    monkeypatch.setattr(work, "STEPS_A_SAMPLE", 45.0)
    monkeypatch.setattr(work, "ANY_STEPS", 0.0)
    with pytest.raises(Unfinished) as ended:
        jbf.fit(rig, runs)
    assert ended.value.fit.rms_n >= whole.rms_n
    assert not ended.value.fit.converged


def test_the_command_writes_what_it_has_and_says_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    rig, runs, _ = campaign(7, ("coulomb_drag",))
    rig.write(tmp_path / "rig.toml")
    names = [str(tmp_path / f"{run.name}.csv") for run in runs]
    for run, name in zip(runs, names, strict=True):
        run.write_csv(name)
    monkeypatch.setattr(work, "STEPS_A_SAMPLE", 600.0)
    monkeypatch.setattr(work, "ANY_STEPS", 0.0)
    out = tmp_path / "model.toml"
    assert main(["diagnose", str(tmp_path / "rig.toml"), *names, "--out", str(out)]) == 2
    told = capsys.readouterr().err.strip().splitlines()
    assert len(told) == 1
    assert "not finished, written to" in told[0]
    assert names[0] in told[0]
    assert jbf.Model.load(out).law == "journal"


def test_a_law_that_takes_too_long_is_not_compared_and_named(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    rig, runs, _ = campaign(7)
    prepared = Campaign.prepare(rig, runs)
    # Enough for a curve of friction over speed, too little for bristles.
    share = 1500.0 * prepared.samples.count / prepared.work.most
    monkeypatch.setattr(laws, "LAW_SHARE", share)
    tried, refused = laws.which_law(prepared, "journal", jbf.Policy())
    assert "too long" in refused["law seven_parameter"]
    assert "stribeck" in [t.law for t in tried]
    assert not {t.law for t in tried} & {name.removeprefix("law ") for name in refused}
    monkeypatch.setattr(laws, "LAW_SHARE", 0.0)
    with pytest.raises(Unfinished, match="nothing is fitted yet"):
        laws.which_law(prepared, "journal", jbf.Policy())


def test_a_diagnosis_tells_which_laws_were_not_tried(monkeypatch: pytest.MonkeyPatch) -> None:
    tried = (laws.LawTried("coulomb", 2, 0.1, True),)
    refused = {"law lugre": "takes too long"}
    monkeypatch.setattr(recipe, "which_law", lambda *_: (tried, refused))
    found = jbf.diagnose(jbf.Rig(), four_runs(coulomb, noise_n=0.1), law="auto")
    assert found.model.law == "coulomb"
    assert found.to_dict()["not_tried"]["law lugre"] == "takes too long"
    assert "law lugre: takes too long" in diagnosis_report(found)
