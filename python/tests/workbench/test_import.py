"""Recordings as a logger wrote them: looked at, tried with a map, imported."""

from __future__ import annotations

from pathlib import Path

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
