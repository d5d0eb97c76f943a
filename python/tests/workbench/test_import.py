"""Recordings as a logger wrote them: looked at, tried with a map, imported."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("starlette", reason="the workbench's server is an extra")

from jbf.workbench.files import Folder
from jbf.workbench.session import Session
from starlette.testclient import TestClient
from workbench_parts import client_of

STROKE_M = 0.06


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Two logs of a slide, with decimal commas, milliseconds and millimetres."""
    t = np.arange(0.0, 20.0, 0.01)
    for number in (1, 2):
        w = 2.0 * np.pi / (3.0 + number)
        columns = (1000.0 * t, 1000.0 * STROKE_M * np.sin(w * t), 10.0 * np.sign(np.cos(w * t)))
        lines = ["Time [ms];Position [mm];Force [N]"]
        lines += [
            ";".join(f"{v:.4f}".replace(".", ",") for v in row)
            for row in zip(*columns, strict=False)
        ]
        (tmp_path / f"log{number}.csv").write_text("\n".join(lines) + "\n")
    return tmp_path


@pytest.fixture
def client(folder: Path) -> TestClient:
    return client_of(Session(Folder.of(folder)))


def asked(client: TestClient, **more: object) -> dict[str, object]:
    """Both logs with the map that looking at the first one guessed."""
    found = client.post("/api/look", json={"file": "log1.csv"}).json()
    assert found["questions"] == []
    files = ["log1.csv", "log2.csv"]
    return {"files": files, "map": found["map"], "into": found["into"], **more}


def test_what_is_tried_is_shown_in_si_and_written_nowhere(client: TestClient, folder: Path) -> None:
    told = client.post("/api/try", json=asked(client)).json()
    assert [run["name"] for run in told["runs"]] == ["log1", "log2"]
    columns = {c["name"]: c for c in told["runs"][0]["columns"]}
    assert columns["position_m"]["most"] == pytest.approx(STROKE_M, rel=1e-3)
    assert columns["time_s"]["most"] == pytest.approx(19.99)
    assert sorted(path.name for path in folder.iterdir()) == ["log1.csv", "log2.csv"]


def test_another_unit_changes_the_numbers(client: TestClient) -> None:
    wanted = asked(client)
    there = str(wanted["map"])
    assert "`Position [mm]`" in there
    wanted["map"] = there.replace('"`Position [mm]`"', '"`Position [mm]` * 2"')
    told = client.post("/api/try", json=wanted).json()
    columns = {c["name"]: c for c in told["runs"][0]["columns"]}
    assert columns["position_m"]["most"] == pytest.approx(2.0 * STROKE_M, rel=1e-3)


def test_what_is_imported_is_open_and_a_folder_of_that_name_stays(
    client: TestClient, folder: Path
) -> None:
    assert client.post("/api/import", json=asked(client, into="slide")).status_code == 200
    state = client.get("/api/state").json()
    assert [run["name"] for run in state["runs"]] == ["log1", "log2"]
    assert state["message"]["words"] == "slide/rig.toml is open, with 2 runs"
    before = (folder / "slide" / "rig.toml").read_bytes()
    again = client.post("/api/import", json=asked(client, into="slide"))
    assert again.status_code == 422
    assert "name another folder" in again.json()["error"]
    assert (folder / "slide" / "rig.toml").read_bytes() == before


@pytest.mark.parametrize("into", ["../slide", "/tmp/slide", "", ".."])
def test_nothing_is_imported_outside_the_folder(
    client: TestClient, folder: Path, into: str
) -> None:
    answer = client.post("/api/import", json=asked(client, into=into))
    assert answer.status_code == 422
    assert "not a name in the folder" in answer.json()["error"]
    assert not (folder.parent / "slide").exists()


def test_no_recording_is_no_import(client: TestClient) -> None:
    answer = client.post("/api/import", json=asked(client, files=[]))
    assert answer.status_code == 422
    assert "tick one" in answer.json()["error"]


def formed(client: TestClient, text: str, form: dict[str, object], **more: object) -> Any:
    """What comes of a form over a map."""
    return client.post(
        "/api/try", json={"files": ["log1.csv"], "map": text, "form": form, **more}
    ).json()


def test_the_form_shows_each_column_with_its_first_values(client: TestClient) -> None:
    found = client.post("/api/look", json={"file": "log1.csv"}).json()
    assert [(c["name"], c["unit"]) for c in found["columns"]] == [
        ("Time [ms]", "ms"), ("Position [mm]", "mm"), ("Force [N]", "N"),
    ]  # fmt: skip
    assert found["columns"][0]["first"] == ["0", "10", "20"]
    assert [row["key"] for row in found["form"]["rows"]] == ["time_s", "position_m", "friction_n"]
    units = {q["key"]: q["units"] for q in found["quantities"]}
    assert {"N", "mN", "kN"} <= set(units["friction_n"])
    assert "mm" not in units["friction_n"]


def test_a_unit_of_the_form_changes_the_numbers_and_the_map(client: TestClient) -> None:
    found = client.post("/api/look", json={"file": "log1.csv"}).json()
    rows = [{**row, "unit": "mN" if row["key"] == "friction_n" else row["unit"],
             "turned": row["key"] == "friction_n"} for row in found["form"]["rows"]]  # fmt: skip
    told = formed(client, found["map"], {"rows": rows, "rig": {}})
    (run,) = told["runs"]
    force = next(c for c in run["columns"] if c["name"] == "friction_n")
    assert (force["least"], force["most"], force["unit"]) == (-0.01, 0.01, "N")
    assert 'friction_n = "-`Force [N]` [mN]"' in told["map"]
    # What the form did not touch keeps its words.
    assert 'time_s = "`Time [ms]`"' in told["map"]
    assert "# its name and its unit" in told["map"]


def test_another_meaning_asks_for_another_machine_and_says_what_is_open(
    client: TestClient,
) -> None:
    found = client.post("/api/look", json={"file": "log1.csv"}).json()
    rows = [
        {**row, "key": "force_percent", "unit": "%"} if row["key"] == "friction_n" else row
        for row in found["form"]["rows"]
    ]
    told = formed(client, found["map"], {"rows": rows, "rig": {}})
    assert told["form"]["rig"]["drive"]["friction"] == "percent"
    assert "drive.rated_force_n: is open" in told["problem"]
    assert told["runs"] == []
    rig = {"drive.rated_force_n": "250"}
    told = formed(client, told["map"], {"rows": told["form"]["rows"], "rig": rig})
    assert told["problem"] is None
    force = next(c for c in told["runs"][0]["columns"] if c["name"] == "friction_n")
    assert force["most"] == pytest.approx(25.0)


def test_two_columns_for_one_thing_are_refused_in_words(client: TestClient) -> None:
    found = client.post("/api/look", json={"file": "log1.csv"}).json()
    rows = [{**row, "key": "time_s"} for row in found["form"]["rows"]]
    answer = client.post(
        "/api/try",
        json={"files": ["log1.csv"], "map": found["map"], "form": {"rows": rows, "rig": {}}},
    )
    assert answer.status_code == 422
    assert "two columns are the time" in answer.json()["error"]


@pytest.mark.parametrize("text", ["[columns", "", "[columns]\ntime_s = 3\n", "x = 1"])
def test_a_broken_map_is_one_line(client: TestClient, text: str) -> None:
    answer = client.post("/api/try", json={"files": ["log1.csv"], "map": text})
    assert answer.status_code == 422
    assert "/tmp" not in answer.json()["error"]
    assert "\n" not in answer.json()["error"]


def test_the_commands_of_an_import_make_the_same_folder_again(
    client: TestClient, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from jbf.cli import main

    client.post("/api/import", json=asked(client, into="slide"))
    before = (folder / "slide" / "log1.csv").read_bytes()
    command = client.get("/api/state").json()["command"].splitlines()[0]
    assert command == "jbf import log1.csv log2.csv --map slide/map.toml --out slide --force"
    monkeypatch.chdir(folder)
    assert main(shlex.split(command)[1:]) == 0
    assert (folder / "slide" / "log1.csv").read_bytes() == before
