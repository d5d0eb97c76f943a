"""Rates of correct diagnoses of campaigns that `check` simulates like the given one."""

import json
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from by_hand import coulomb, four_runs
from jbf import InputError, Model, Rig, Run, check, fit
from jbf.cli import main
from jbf.diagnosis.check import Answer, Rate, answer_of, identity
from jbf.diagnosis.policy import Policy
from jbf.records.drive import Drive
from linear_campaigns import mass
from scipy import stats
from shared import shared

RUNS = four_runs(mass(1.0), noise_rms=0.1)


@shared
def _model() -> Model:
    return fit(Rig(), RUNS, ["inertia"], law="coulomb").model


@pytest.mark.parametrize("campaigns", [1, pytest.param(8, marks=pytest.mark.extended)])
def test_strong_effect_is_named_in_all_and_only_the_campaigns_that_simulate_it(
    campaigns: int,
) -> None:
    with ThreadPoolExecutor(1) as executor:
        checked = check(_model(), RUNS, campaigns=campaigns, executor=executor)
    hidden = [answer.hidden for answer in checked.answers]
    assert hidden == [()] * campaigns + [("inertia",)] * campaigns
    assert all(answer.right for answer in checked.answers)
    assert not any(answer.false for answer in checked.answers)
    rates = {rate.what: rate for rate in checked.rates}
    assert rates["nothing hidden: adequate"].count == campaigns
    assert rates["nothing hidden: a false name"].count == 0
    assert rates["inertia hidden: named, and nothing else"].count == campaigns
    assert {rate.campaigns for rate in checked.rates} == {campaigns}


def test_confidence_interval_of_a_rate_is_that_of_clopper_and_pearson() -> None:
    rare = Rate.of("x", [False] * 200)
    assert rare.low == 0.0
    assert rare.high == pytest.approx(1.0 - 0.025 ** (1.0 / 200.0))
    some = Rate.of("x", [True] * 3 + [False] * 17)
    assert (some.count, some.campaigns) == (3, 20)
    assert some.low == pytest.approx(stats.beta.ppf(0.025, 3, 18))
    assert some.high == pytest.approx(stats.beta.ppf(0.975, 4, 17))


@pytest.mark.parametrize(
    ("named", "alternatives", "right", "false"),
    [
        (("a",), {}, True, False),
        (("b",), {}, False, True),
        (("b",), {"b": ("a",)}, False, False),
        (("a", "b"), {}, False, True),
        ((), {}, False, False),
    ],
)
def test_check_answer_is_false_if_neither_effect_nor_alternative_is_simulated(
    named: tuple[str, ...], alternatives: dict[str, tuple[str, ...]], right: bool, false: bool
) -> None:
    answer = Answer(("a",), 0, "missing", named, alternatives)
    assert (answer.right, answer.false) == (right, false)


def test_answer_of_a_check_is_unchanged_after_writing_and_reading_json() -> None:
    answer = Answer(("a",), 0, "missing", ("b",), {"b": ("a",)})
    assert answer_of(json.loads(json.dumps(answer.to_dict()))) == answer


def test_failed_diagnosis_counts_as_wrong_even_if_no_effect_is_simulated() -> None:
    assert not Answer((), 0, "failed", (), {}).right
    assert Answer((), 0, "adequate", (), {}).right


def test_answers_of_an_earlier_check_are_not_computed_again() -> None:
    done = [
        Answer((), 0, "adequate", (), {}),
        Answer(("inertia",), 0, "ambiguous", ("sensor_lag",), {}),
    ]
    new: list[Answer] = []
    found = check(_model(), RUNS, campaigns=1, done=done, keep=new.append)
    assert (found.answers, new) == (tuple(done), [])
    counts = {rate.what: rate.count for rate in found.rates}
    assert counts["inertia hidden: a false name"] == 1


def test_check_of_zero_campaigns_is_rejected() -> None:
    with pytest.raises(InputError, match="0 campaigns"):
        check(_model(), RUNS, campaigns=0)


def test_identity_of_a_check_differs_by_model_runs_and_policy() -> None:
    model = _model()
    names = {
        identity(model, RUNS),
        identity(fit(Rig(), RUNS, law="coulomb").model, RUNS),
        identity(model, RUNS[1:]),
        identity(model, RUNS, Policy(false_alarm_rate=0.1)),
    }
    assert len(names) == 4
    assert identity(model, four_runs(mass(1.0), noise_rms=0.1)) == identity(model, RUNS)


@pytest.fixture
def command(tmp_path: Path) -> list[str]:
    """Run `jbf check` for a base law and two runs, with a file of stored results."""
    paths = []
    for run in four_runs(coulomb, noise_rms=0.1)[:2]:
        paths.append(str(tmp_path / f"{run.name}.csv"))
        run.write_csv(paths[-1])
    (tmp_path / "rig.toml").write_text('[drive]\nmotion = "linear"\nfriction = "force"\n')
    model = str(tmp_path / "model.toml")
    assert main(["fit", str(tmp_path), "--law", "coulomb", "--out", model]) == 0
    return ["check", model, *paths, "--jobs", "1", "--resume", str(tmp_path / "kept.jsonl")]


def test_stored_answers_are_reused_unless_damaged_or_of_another_policy(
    command: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    kept, answers = tmp_path / "kept.jsonl", tmp_path / "check.json"
    assert main([*command, "-n", "1"]) == 0
    first = kept.read_text()
    assert len(first.splitlines()) == 1
    capsys.readouterr()
    assert main([*command, "-n", "1", "--json", str(answers)]) == 0
    assert kept.read_text() == first
    (answer,) = json.loads(answers.read_text())["answers"]
    assert answer.items() <= json.loads(first).items()
    capsys.readouterr()
    assert main([*command, "-n", "2", "--false-alarm-rate", "0.1"]) == 2
    assert capsys.readouterr().err.count("\n") == 1
    kept.write_text("no answer\n" + first)
    assert main([*command, "-n", "2"]) == 2
    assert "kept.jsonl, row 1" in capsys.readouterr().err


@pytest.mark.extended
def test_interrupted_check_continues_from_its_answers(command: list[str], tmp_path: Path) -> None:
    kept = tmp_path / "kept.jsonl"
    assert main([*command, "-n", "1"]) == 0
    first = kept.read_text()
    # A partially written result is computed again.
    kept.write_text(first[: len(first) // 2])
    assert main([*command, "-n", "1"]) == 0
    assert kept.read_text() == first
    # The line break of the last result may be missing.
    kept.write_text(first.rstrip("\n"))
    assert main([*command, "-n", "2"]) == 0
    assert kept.read_text().startswith(first)
    assert len(kept.read_text().splitlines()) == 2


def test_machine_terms_of_a_drive_are_in_the_campaigns_without_hidden_effects() -> None:
    """A model with inertia and weight, and the runs of a reciprocating joint."""
    rig = Rig(drive=Drive("rotary", "torque"))
    time = np.arange(0.0, 12.0, 0.02)
    runs = []
    for k in (5.0, 6.0, 7.0):
        angle = 0.9 * np.sin(1.9 * time) + 0.35 * np.sin(k * time)
        speed = 1.71 * np.cos(1.9 * time) + 0.35 * k * np.cos(k * time)
        run = Run.from_arrays(time, speed, np.zeros(600), angle_rad=angle, name=f"run_{k}")
        runs.append(replace(run, quantities=rig.quantities))
    values = {"F_c": 0.12, "F_s": 0.12, "F_v": 0.012, "inertia.m_e": 0.009}
    values |= {"gravity.G": 0.3, "gravity.theta_0_rad": 0.0}
    model = Model(rig, "coulomb", ["inertia", "gravity"], values)
    rng = np.random.default_rng(2)
    runs = [replace(run, friction=model.predict(run) + 0.01 * rng.normal(size=600)) for run in runs]
    found = check(model, runs, campaigns=1)
    assert [answer.hidden for answer in found.answers] == [("inertia", "gravity")]
    assert [answer.right for answer in found.answers] == [True]
    assert {r.what: r.count for r in found.rates}["nothing hidden: adequate"] == 1
