"""Many campaigns in one call: sequentially, in threads, in processes, from the command line."""

import json
import multiprocessing
import pickle
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path
from typing import Any

import jbf
import numpy as np
import pytest
from jbf import Diagnosis, Drive, InputError, Lubricant, Rig, diagnose_many
from jbf.cli import main
from jbf.errors import JbfError
from jbf.models.chain import default_law_of_diagnosis
from linear_campaigns import linear_diagnosis, linear_runs

SLIDE = '[drive]\nmotion = "linear"\nfriction = "force"\n'


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder of the valid campaign `mass` and the invalid campaign `without_rig`."""
    for name in ("mass", "without_rig"):
        (tmp_path / "all" / name).mkdir(parents=True)
        for run in linear_runs("mass"):
            run.write_csv(tmp_path / "all" / name / f"{run.name}.csv")
    (tmp_path / "all" / "mass" / "rig.toml").write_text(SLIDE)
    return tmp_path / "all"


def test_diagnosis_of_a_folder_equals_that_of_its_runs_if_another_folder_is_invalid(
    folder: Path,
) -> None:
    progress: list[tuple[str, int, int]] = []
    found = diagnose_many(
        {"lost": folder / "without_rig", "mass": folder / "mass"},
        progress=lambda *message: progress.append(message),
        law="coulomb",
    )
    assert list(found) == ["lost", "mass"]
    assert isinstance(found["lost"], InputError)
    assert "rig.toml" in str(found["lost"])
    diagnosis = found["mass"]
    assert isinstance(diagnosis, Diagnosis)
    expected = linear_diagnosis("mass")
    assert diagnosis.model.effects == expected.model.effects
    for name, estimate in expected.fit.parameters.items():
        difference = diagnosis.fit.parameters[name].value - estimate.value
        assert abs(difference) < 0.01 * (estimate.stderr or np.inf)
    assert [(done, total) for _, done, total in progress] == [(1, 2), (2, 2)]


def test_diagnosis_in_a_thread_is_that_of_a_single_call() -> None:
    with ThreadPoolExecutor(2) as executor:
        found = diagnose_many(
            {"b": (Rig(), linear_runs("mass")), "a": (Rig(), [])}, executor=executor, law="coulomb"
        )
    assert list(found) == ["b", "a"]
    assert isinstance(found["a"], InputError)
    assert isinstance(found["b"], Diagnosis)
    assert found["b"].model.values.tolist() == linear_diagnosis("mass").model.values.tolist()


@pytest.mark.parametrize("start", ["fork", pytest.param("spawn", marks=pytest.mark.extended)])
def test_diagnosis_in_another_process_is_that_of_a_single_call(start: str) -> None:
    """The processes may be forked from one whose threads have been used."""
    if start not in multiprocessing.get_all_start_methods():
        pytest.skip(f"this system does not {start} processes")
    expected = linear_diagnosis("mass")
    campaigns = {"a": (Rig(), linear_runs("mass"))}
    with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context(start)) as executor:
        found = diagnose_many(campaigns, executor=executor, law="coulomb")["a"]
    assert isinstance(found, Diagnosis)
    assert found.effects == expected.effects
    assert found.model.values.tolist() == expected.model.values.tolist()


class UnreadableCampaign(tuple[Any, ...]):
    """A pair of a rig and runs whose length cannot be read."""

    def __len__(self) -> int:
        raise RuntimeError("out of memory")


def test_failing_diagnosis_in_a_thread_does_not_affect_other_campaigns() -> None:
    campaigns: dict[str, Any] = {"a": UnreadableCampaign((Rig(), [])), "b": (Rig(), [])}
    with ThreadPoolExecutor(1) as executor:
        found = diagnose_many(campaigns, executor=executor, law="coulomb")
    assert isinstance(found["a"], JbfError)
    assert "RuntimeError: out of memory" in str(found["a"])
    assert isinstance(found["b"], InputError)


@pytest.mark.parametrize(
    ("campaigns", "options", "named"),
    [
        ({}, {"lwa": "coulomb"}, "lwa"),
        ({}, {"law": "coulom"}, "coulom"),
        ({}, {"clock": "x"}, "x"),
        ([], {}, "campaigns is a list"),
        ({}, {"progress": 3}, "progress"),
    ],
)
def test_argument_of_diagnose_many_is_rejected_by_name_if_invalid(
    campaigns: Any, options: dict[str, Any], named: str
) -> None:
    with pytest.raises(InputError, match=named):
        diagnose_many(campaigns, **options)


def test_campaign_that_is_not_a_pair_of_rig_and_runs_is_an_error() -> None:
    wrong: Any = {"a": (Rig(), [], [])}
    assert isinstance(diagnose_many(wrong, law="coulomb")["a"], InputError)
    assert diagnose_many({}, law="auto") == {}


def test_law_of_each_campaign_is_by_default_that_of_its_kind_of_rig() -> None:
    oil = Lubricant(0.1)
    rigs = {"slide": Rig(), "bearing": Rig.thesis(), "incomplete": Rig(lubricant=oil)}
    rigs["gear"] = Rig(lubricant=oil, drive=Drive("rotary", "torque"))
    assert {name: default_law_of_diagnosis(rig) for name, rig in rigs.items()} == {
        "slide": "auto",
        "bearing": "journal",
        "incomplete": "journal",
        "gear": "auto",
    }
    incomplete = diagnose_many({"a": (rigs["incomplete"], linear_runs("mass"))}, law=None)["a"]
    assert isinstance(incomplete, InputError)
    assert "[bearing]" in str(incomplete)


def test_pickled_diagnosis_has_the_same_predictions_and_summary() -> None:
    found = linear_diagnosis("mass")
    again = pickle.loads(pickle.dumps(found))
    run = linear_runs("mass")[0]
    assert again.summary() == found.summary()
    assert again.model.predict(run).tolist() == found.model.predict(run).tolist()


def test_diagnose_command_writes_json_and_models_of_many_folders(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    answers, models = tmp_path / "all.json", tmp_path / "models"
    words = ["diagnose", "--many", str(folder), "--jobs", "1", "--law", "coulomb"]
    assert main([*words, "--json", str(answers), "--out", str(models)]) == 0
    text = capsys.readouterr().out
    assert "adequate" in text
    assert "without_rig: " in text
    document = json.loads(answers.read_text())
    assert document["mass"]["machine"] == ["inertia"]
    assert "rig.toml" in document["without_rig"]["error"]
    assert [path.name for path in models.iterdir()] == ["mass.toml"]
    assert jbf.Model.load(models / "mass.toml").effects == ("inertia",)


@pytest.mark.parametrize(
    ("words", "problem"),
    [
        (["diagnose"], "RIG and RUN are missing"),
        (["diagnose", "--many", "nowhere"], "contains no campaign"),
        (["diagnose", "rig.toml", "--many", "."], "excludes"),
        (["diagnose", "--many", ".", "--jobs", "0"], "1 or more"),
    ],
)
def test_invalid_arguments_of_the_diagnose_command_end_with_code_two(
    words: list[str], problem: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(words) == 2
    assert problem in capsys.readouterr().err
