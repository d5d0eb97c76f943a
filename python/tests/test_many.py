"""Many campaigns at once: in this process, in others, from the shell."""

from __future__ import annotations

import json
import multiprocessing
import pickle
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path

import jbf
import pytest
from campaigns import campaign
from jbf.cli import main
from rigsim.motions import sine

SHORT = (sine("two_way_0.5", 26.0, 0.127, 0.5), sine("two_way_2", 13.0, 0.127, 2.0))


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Two campaigns and a folder that has lost its rig."""
    for name, effects in (("good", ()), ("drag", ("coulomb_drag",)), ("lost", ())):
        rig, runs, _ = campaign(71, effects, motions=SHORT)
        (tmp_path / name).mkdir()
        if name != "lost":
            rig.write(tmp_path / name / "rig.toml")
        for run in runs:
            run.write_csv(tmp_path / name / f"{run.name}.csv")
    return tmp_path


def test_one_bad_campaign_stops_no_other(folder: Path) -> None:
    said: list[tuple[str, int, int]] = []
    found = jbf.diagnose_many(
        {"good": folder / "good", "lost": folder / "lost"},
        progress=lambda *words: said.append(words),
    )
    assert list(found) == ["good", "lost"]
    assert isinstance(found["good"], jbf.Diagnosis)
    assert found["good"].verdict == "adequate"
    assert isinstance(found["lost"], jbf.InputError)
    assert "rig.toml" in str(found["lost"])
    assert [(done, total) for _, done, total in said] == [(1, 2), (2, 2)]


@pytest.mark.parametrize("start", ["fork", "spawn"])
def test_other_processes_say_the_same(start: str) -> None:
    """Also those that are forked off a process whose threads have worked already."""
    if start not in multiprocessing.get_all_start_methods():
        pytest.skip(f"this system does not {start} processes")
    rig, runs, _ = campaign(71, ("coulomb_drag",), motions=SHORT)
    here = jbf.diagnose(rig, runs)
    context = multiprocessing.get_context(start)
    with ProcessPoolExecutor(1, mp_context=context) as executor:
        there = jbf.diagnose_many({"a": (rig, runs)}, executor=executor)["a"]
    assert isinstance(there, jbf.Diagnosis)
    assert there.effects == here.effects
    assert there.model.values.tolist() == here.model.values.tolist()
    assert there.summary() == here.summary()


def test_threads_will_do() -> None:
    rig, runs, _ = campaign(71, motions=SHORT)
    with ThreadPoolExecutor(2) as executor:
        found = jbf.diagnose_many({"a": (rig, runs), "b": (rig, [])}, executor=executor)
    assert isinstance(found["a"], jbf.Diagnosis)
    assert isinstance(found["b"], jbf.InputError)


def test_a_dask_client_will_do() -> None:
    distributed = pytest.importorskip("distributed", reason="dask.distributed is not installed")
    rig, runs, _ = campaign(71, motions=SHORT)
    with (
        distributed.LocalCluster(
            n_workers=1, threads_per_worker=1, processes=False, dashboard_address=None
        ) as cluster,
        distributed.Client(cluster) as client,
        client.get_executor() as executor,
    ):
        found = jbf.diagnose_many({"a": (rig, runs)}, executor=executor)["a"]
    assert isinstance(found, jbf.Diagnosis)
    assert found.verdict == "adequate"


def test_a_wrong_law_is_refused_at_once() -> None:
    with pytest.raises(jbf.InputError, match="no law"):
        jbf.diagnose_many({}, law="nonsense")


def test_a_diagnosis_survives_a_pickle() -> None:
    rig, runs, _ = campaign(71, motions=SHORT)
    found = jbf.diagnose(rig, runs)
    again = pickle.loads(pickle.dumps(found))
    assert again.summary() == found.summary()
    assert again.model.predict(runs[0]).tolist() == found.model.predict(runs[0]).tolist()


def test_from_the_shell(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out, models = folder / "all.json", folder / "models"
    words = ["diagnose", "--many", str(folder), "--jobs", "2"]
    assert main([*words, "--json", str(out), "--out", str(models)]) == 0
    said = capsys.readouterr().out
    assert "coulomb_drag" in said
    assert "lost: " in said
    pages = json.loads(out.read_text())
    assert pages["drag"]["effects"] == ["coulomb_drag"]
    assert "rig.toml" in pages["lost"]["error"]
    assert sorted(path.name for path in models.iterdir()) == ["drag.toml", "good.toml"]
    assert jbf.Model.load(models / "drag.toml").effects == ("coulomb_drag",)


@pytest.mark.parametrize(
    ("words", "problem"),
    [
        (["diagnose"], "RIG and RUN are missing"),
        (["diagnose", "--many", "nowhere"], "holds no campaign"),
        (["diagnose", "rig.toml", "--many", "."], "takes neither"),
        (["diagnose", "--many", ".", "--jobs", "0"], "1 or more"),
    ],
)
def test_bad_words(words: list[str], problem: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(words) == 2
    assert problem in capsys.readouterr().err
