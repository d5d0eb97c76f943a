"""Recordings in the workbench: guessed map, preview with a map or a form, import."""

import shlex
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("starlette", reason="the workbench's server is an extra")

from jbf.cli import main
from jbf.workbench.files import Folder
from jbf.workbench.session import Session
from starlette.testclient import TestClient
from workbench_parts import client_of, slide_log

STROKE_M = 0.06


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Two logs of a slide, with decimal commas, milliseconds and millimetres."""
    t = np.arange(0.0, 20.0, 0.01)
    for number in (1, 2):
        w = 2.0 * np.pi / (3.0 + number)
        log = slide_log(t, STROKE_M * np.sin(w * t), 10.0 * np.sign(np.cos(w * t)))
        (tmp_path / f"log{number}.csv").write_text(log)
    return tmp_path


@pytest.fixture
def client(folder: Path) -> TestClient:
    return client_of(Session(Folder.of(folder)))


def guess_of(client: TestClient) -> Any:
    """The map and the form that are guessed from the first log."""
    return client.post("/api/look", json={"file": "log1.csv"}).json()


def request_of(client: TestClient, **more: object) -> dict[str, object]:
    """A request for both logs with the map guessed from the first one."""
    outcome = guess_of(client)
    assert outcome["questions"] == []
    files = ["log1.csv", "log2.csv"]
    return {"files": files, "map": outcome["map"], "into": outcome["into"], **more}


def test_import_preview_shows_si_units_and_writes_no_file(client: TestClient, folder: Path) -> None:
    result = client.post("/api/try", json=request_of(client)).json()
    assert [run["name"] for run in result["runs"]] == ["log1", "log2"]
    columns = {c["name"]: c for c in result["runs"][0]["columns"]}
    assert columns["position_m"]["most"] == pytest.approx(STROKE_M, rel=1e-3)
    assert columns["time_s"]["most"] == pytest.approx(19.99)
    assert sorted(path.name for path in folder.iterdir()) == ["log1.csv", "log2.csv"]


def test_import_opens_runs_and_refuses_an_existing_folder(client: TestClient, folder: Path) -> None:
    assert client.post("/api/import", json=request_of(client, into="slide")).status_code == 200
    state = client.get("/api/state").json()
    assert [run["name"] for run in state["runs"]] == ["log1", "log2"]
    assert state["message"]["words"] == "slide/rig.toml is open, with 2 runs"
    before = (folder / "slide" / "rig.toml").read_bytes()
    again = client.post("/api/import", json=request_of(client, into="slide"))
    assert again.status_code == 422
    assert "name another folder" in again.json()["error"]
    assert (folder / "slide" / "rig.toml").read_bytes() == before


@pytest.mark.parametrize("into", ["../slide", "/tmp/slide", "", ".."])
def test_import_to_an_outside_path_is_refused(client: TestClient, folder: Path, into: str) -> None:
    answer = client.post("/api/import", json=request_of(client, into=into))
    assert answer.status_code == 422
    assert "not a name in the folder" in answer.json()["error"]
    assert not (folder.parent / "slide").exists()


def preview_with_form(client: TestClient, text: str, rows: Any, rig: Any = {}) -> Any:  # noqa: B006
    """Return the response to a preview of an import after a form has changed its map."""
    form = {"rows": rows, "rig": rig}
    return client.post("/api/try", json={"files": ["log1.csv"], "map": text, "form": form})


def test_unit_and_sign_in_import_form_change_the_numbers_and_the_map(client: TestClient) -> None:
    outcome = guess_of(client)
    rows = [{**row, "unit": "mN" if row["key"] == "friction_n" else row["unit"],
             "turned": row["key"] == "friction_n"} for row in outcome["form"]["rows"]]  # fmt: skip
    result = preview_with_form(client, outcome["map"], rows).json()
    (run,) = result["runs"]
    force = next(c for c in run["columns"] if c["name"] == "friction_n")
    assert (force["least"], force["most"], force["unit"]) == (-0.01, 0.01, "N")
    assert 'friction_n = "-`Force [N]` [mN]"' in result["map"]
    # Lines that the form leaves unchanged keep their text.
    assert 'time_s = "`Time [ms]`"' in result["map"]
    assert "# by name and unit" in result["map"]


def test_friction_in_percent_requires_the_rated_force_of_the_drive(client: TestClient) -> None:
    outcome = guess_of(client)
    rows = [
        {**row, "key": "force_percent", "unit": "%"} if row["key"] == "friction_n" else row
        for row in outcome["form"]["rows"]
    ]
    result = preview_with_form(client, outcome["map"], rows).json()
    assert result["form"]["rig"]["drive"]["friction"] == "percent"
    assert "drive.rated_force_n: is open" in result["problem"]
    assert result["runs"] == []
    rows, rig = result["form"]["rows"], {"drive.rated_force_n": "250"}
    result = preview_with_form(client, result["map"], rows, rig).json()
    assert result["problem"] is None
    force = next(c for c in result["runs"][0]["columns"] if c["name"] == "friction_n")
    assert force["most"] == pytest.approx(25.0)


def test_import_form_with_two_columns_for_one_quantity_is_refused(client: TestClient) -> None:
    outcome = guess_of(client)
    rows = [{**row, "key": "time_s"} for row in outcome["form"]["rows"]]
    answer = preview_with_form(client, outcome["map"], rows)
    assert answer.status_code == 422
    assert "two columns are assigned to time" in answer.json()["error"]


@pytest.mark.parametrize("text", ["[columns", "", "[columns]\ntime_s = 3\n", "x = 1"])
def test_preview_with_a_broken_map_is_refused_in_one_line(client: TestClient, text: str) -> None:
    answer = client.post("/api/try", json={"files": ["log1.csv"], "map": text})
    assert answer.status_code == 422
    assert "/tmp" not in answer.json()["error"]
    assert "\n" not in answer.json()["error"]


def test_command_line_shown_for_an_import_reproduces_the_run(
    client: TestClient, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    client.post("/api/import", json=request_of(client, into="slide"))
    before = (folder / "slide" / "log1.csv").read_bytes()
    command = client.get("/api/state").json()["command"].splitlines()[0]
    assert command == "jbf import log1.csv log2.csv --map slide/map.toml --folder slide --force"
    monkeypatch.chdir(folder)
    assert main(shlex.split(command)[1:]) == 0
    assert (folder / "slide" / "log1.csv").read_bytes() == before
