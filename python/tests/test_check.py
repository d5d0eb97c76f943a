"""`jbf check`: how often diagnoses of campaigns like the one at hand are right."""

from __future__ import annotations

import json
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from by_hand import Array, coulomb, four_runs
from jbf import Check, InputError, Rig, Run, check, fit
from jbf.cli import main
from jbf.diagnosis.check import Answer, Rate, answer_of, identity
from jbf.diagnosis.policy import Policy
from jbf.estimation.wild_bootstrap import recorded_by
from scipy import stats

NOISE_N, MASS_KG = 0.1, 1.0


def heavy(time: Array, v: Array, a: Array) -> Array:
    return coulomb(time, v, a) + MASS_KG * a


@pytest.fixture(scope="module")
def runs() -> list[Run]:
    return four_runs(heavy, noise_n=NOISE_N)


@pytest.fixture(scope="module")
def checked(runs: list[Run]) -> Check:
    model = fit(Rig(), runs, ["inertia_leak"], law="coulomb").model
    with ThreadPoolExecutor(2) as executor:
        return check(model, runs, campaigns=2, executor=executor)


# ---- campaigns recorded again -----------------------------------------------------------------


def test_a_campaign_has_the_models_friction_and_noise_like_the_records(runs: list[Run]) -> None:
    model = fit(Rig(), runs, ["inertia_leak"], law="coulomb").model
    with_it = recorded_by(model, runs, ("inertia_leak",), 0)
    without = recorded_by(model, runs, (), 0)
    again = recorded_by(model, runs, ("inertia_leak",), 1)
    for old, new, bare, other in zip(runs, with_it, without, again, strict=True):
        moves = np.abs(old.velocity_m_s) > 0.01
        acceleration = np.gradient(old.velocity_m_s, old.time_s)
        noise = np.asarray(new.friction_n) - heavy(old.time_s, old.velocity_m_s, acceleration)
        assert np.std(noise[moves]) == pytest.approx(NOISE_N, rel=0.15)
        less = np.asarray(bare.friction_n) - coulomb(old.time_s, old.velocity_m_s, acceleration)
        assert np.std(less[moves]) == pytest.approx(NOISE_N, rel=0.15)
        assert not np.array_equal(new.friction_n, other.friction_n)
        np.testing.assert_array_equal(new.time_s, old.time_s)
    np.testing.assert_array_equal(
        with_it[0].friction_n, recorded_by(model, runs, ("inertia_leak",), 0)[0].friction_n
    )


def test_the_noise_is_as_large_as_it_was_and_where_it_was() -> None:
    random = np.random.default_rng(3)
    runs = [
        replace(
            run,
            friction_n=coulomb(run.time_s, run.velocity_m_s, run.velocity_m_s)
            + random.standard_normal(len(run)) * np.where(run.time_s < 5.0, 0.02, 0.3),
        )
        for run in four_runs(coulomb, noise_n=NOISE_N)
    ]
    model = fit(Rig(), runs, law="coulomb").model
    for old, new in zip(runs, recorded_by(model, runs, (), 4), strict=True):
        moves = np.abs(old.velocity_m_s) > 0.01
        left = np.asarray(new.friction_n) - coulomb(old.time_s, old.velocity_m_s, old.velocity_m_s)
        quiet, loud = moves & (old.time_s < 4.9), moves & (old.time_s > 5.1)
        assert np.std(left[quiet]) < 0.05 < 0.2 < np.std(left[loud])


# ---- rates ------------------------------------------------------------------------------------


def test_clear_effects_are_named_and_nothing_is_named_where_nothing_is(checked: Check) -> None:
    assert [a.hidden for a in checked.answers] == [(), (), ("inertia_leak",), ("inertia_leak",)]
    assert all(a.right for a in checked.answers)
    rates = {r.what: r for r in checked.rates}
    assert rates["nothing hidden: adequate"].count == 2
    assert rates["nothing hidden: a false name"].count == 0
    assert rates["inertia_leak hidden: named, and nothing else"].count == 2
    said = checked.summary()
    assert "2 of 2" in said
    assert "4 of 4" in repr(checked)


def test_intervals_are_clopper_and_pearsons() -> None:
    # None of 200: below 1.83 %, as (1 - p)^200 = 0.025.
    rate = Rate.of("x", [False] * 200)
    assert rate.low == 0.0
    assert rate.high == pytest.approx(1.0 - 0.025 ** (1.0 / 200.0))
    some = Rate.of("x", [True] * 3 + [False] * 17)
    assert some.low == pytest.approx(stats.beta.ppf(0.025, 3, 18))
    assert some.high == pytest.approx(stats.beta.ppf(0.975, 4, 17))


@pytest.mark.parametrize(
    ("named", "others", "right", "false"),
    [
        (("a",), {}, True, False),
        (("b",), {}, False, True),
        (("b",), {"b": ("a",)}, False, False),
        (("a", "b"), {}, False, True),
        ((), {}, False, False),
    ],
)
def test_what_is_right_and_what_is_false(
    named: tuple[str, ...], others: dict[str, tuple[str, ...]], right: bool, false: bool
) -> None:
    answer = Answer(("a",), 0, "missing", named, others)
    assert (answer.right, answer.false) == (right, false)
    assert answer_of(json.loads(json.dumps(answer.to_dict()))) == answer


def test_a_campaign_that_cannot_be_diagnosed_is_wrong(
    runs: list[Run], monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails(*_: object, **__: object) -> None:
        raise InputError(problem="nothing moves", mend="move")

    monkeypatch.setattr("jbf.diagnosis.check.diagnose", fails)
    found = check(fit(Rig(), runs, law="coulomb").model, runs, campaigns=1)
    (answer,) = found.answers
    assert answer.verdict == "failed"
    assert not answer.right


def test_no_campaign_tells_no_rate(runs: list[Run]) -> None:
    with pytest.raises(InputError, match="0 campaigns tell no rate"):
        check(fit(Rig(), runs, law="coulomb").model, runs, campaigns=0)


# ---- the command ------------------------------------------------------------------------------


@pytest.fixture
def rig(tmp_path: Path, runs: list[Run]) -> Path:
    for run in runs[:2]:
        run.write_csv(tmp_path / f"{run.name}.csv")
    (tmp_path / "rig.toml").write_text('[drive]\nmotion = "linear"\nfriction = "force"\n')
    command = ["fit", str(tmp_path), "--law", "coulomb", "--out", str(tmp_path / "model.toml")]
    assert main(command) == 0
    return tmp_path


def test_answers_are_kept_and_gone_on_from(rig: Path, capsys: pytest.CaptureFixture[str]) -> None:
    kept, told = rig / "kept.jsonl", rig / "check.json"
    command = ["check", str(rig / "model.toml"), *map(str, sorted(rig.glob("*.csv")))]
    command += ["--jobs", "1", "--resume", str(kept), "--json", str(told)]
    assert main([*command, "-n", "1"]) == 0
    first = kept.read_text()
    assert len(first.splitlines()) == 1
    assert main([*command, "-n", "2"]) == 0
    assert kept.read_text().startswith(first)
    assert len(kept.read_text().splitlines()) == 2
    assert len(json.loads(told.read_text())["answers"]) == 2
    assert "95 % interval" in capsys.readouterr().out
    # Other numbers, other answers.
    assert main([*command, "-n", "2", "--false-alarms", "0.1"]) == 2
    assert "another level" in capsys.readouterr().err
    kept.write_text("no answer\n" + first)
    assert main([*command, "-n", "2"]) == 2
    assert "kept.jsonl, row 1" in capsys.readouterr().err


def test_a_half_written_answer_is_asked_for_again(rig: Path) -> None:
    kept = rig / "kept.jsonl"
    command = ["check", str(rig / "model.toml"), *map(str, sorted(rig.glob("*.csv")))]
    command += ["--jobs", "1", "--resume", str(kept), "-n", "1"]
    assert main(command) == 0
    first = kept.read_text()
    kept.write_text(first[: len(first) // 2])
    assert main(command) == 0
    assert kept.read_text() == first
    # Only the end of its line is missing: it is whole, and the next one begins another line.
    kept.write_text(first.rstrip("\n"))
    assert main([*command[:-1], "2"]) == 0
    assert kept.read_text().startswith(first)
    assert len(kept.read_text().splitlines()) == 2


def test_a_campaign_is_known_by_model_runs_and_level(runs: list[Run]) -> None:
    model = fit(Rig(), runs, law="coulomb").model
    name = identity(model, runs)
    assert identity(model, runs) == name
    assert identity(model, runs[1:]) != name
    assert identity(model, runs, Policy(false_alarms=0.1)) != name
