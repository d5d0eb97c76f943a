"""Recordings in the workbench: guessed map, preview with a map or a form, import."""

import json
import shlex
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("starlette", reason="the workbench's server is an extra")

from jbf.cli import main
from jbf.workbench.files import Folder
from jbf.workbench.reading import Cancelled
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
    assert outcome["open"] == outcome["confirm"] == []
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
    assert [point["place"] for point in result["open"]] == ["drive.rated_force_n"]
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


@pytest.fixture
def odd(folder: Path) -> Path:
    """A file whose columns have no units, with two columns that could be the friction."""
    rows = [f"{10 * i};{i % 50};{(i % 7) / 10};{i % 5};x" for i in range(400)]
    (folder / "odd.csv").write_text("\n".join(["t;pos;torque;force;note", *rows, ""]))
    return folder


def test_open_points_offer_the_units_and_columns_that_are_valid(
    client: TestClient, odd: Path
) -> None:
    outcome = client.post("/api/look", json={"file": "odd.csv"}).json()
    by_key = {point["key"]: point for point in outcome["open"]}
    assert set(by_key) == {"time_s", "angle_rad", "torque_n_m"}
    units = [value for value, _ in by_key["time_s"]["choices"]]
    assert {"s", "ms", "ns"} < set(units)
    assert "N" not in units
    assert [value for value, _ in by_key["torque_n_m"]["choices"]] == ["torque", "force"]
    assert outcome["confirm"] == []


def test_import_is_ready_once_all_open_points_are_answered(client: TestClient, odd: Path) -> None:
    outcome = client.post("/api/look", json={"file": "odd.csv"}).json()
    answers = {"time_s": ("t", "ms"), "angle_rad": ("pos", "deg"), "torque_n_m": ("torque", "N m")}
    rows = [
        {"key": key, "column": column, "unit": unit, "turned": False}
        for key, (column, unit) in answers.items()
    ]
    form = {"rows": rows, "rig": {}}
    request = {"files": ["odd.csv"], "map": outcome["map"], "form": form}
    result = client.post("/api/try", json=request).json()
    assert result["open"] == []
    assert result["problem"] is None
    torque = next(c for c in result["runs"][0]["columns"] if c["from"] == "torque_n_m")
    assert (torque["most"], torque["unit"]) == (0.6, "N m")


def test_preview_has_curves_in_units_of_the_map_and_the_default_cut(folder: Path) -> None:
    t = np.arange(0.0, 12.0, 0.01)
    moving = (t % 4.0) < 3.0
    x = np.cumsum(np.where(moving, 0.03, 0.0)) * 0.01
    rng = np.random.default_rng(0)
    force = np.where(moving, 5.0, 0.0) + 0.1 * rng.standard_normal(len(t))
    (folder / "stops.csv").write_text(slide_log(t, x, force))
    client = client_of(Session(Folder.of(folder)))
    outcome = client.post("/api/look", json={"file": "stops.csv"}).json()
    request = {"files": ["stops.csv"], "map": outcome["map"]}
    result = client.post("/api/try", json=request).json()
    assert len(result["runs"]) == 3
    left_out = [piece for piece in result["pieces"] if not piece["keep"]]
    assert all(piece["to_s"] - piece["from_s"] < 1.0 for piece in left_out)
    (curves,) = result["curves"]
    assert max(curves["columns"]["friction_n"]["values"]) == pytest.approx(force.max(), rel=1e-3)
    times = curves["columns"]["position_m"]["time_s"]
    assert times == sorted(times)
    # The same runs as an import.
    imported = client.post("/api/import", json={**request, "into": "stops_runs"}).json()
    assert len(imported["files"]) == 3


def test_change_of_a_unit_does_not_read_the_file_again(folder: Path) -> None:
    session = Session(Folder.of(folder))
    client = client_of(session)
    request = request_of(client, files=["log1.csv"])
    first = client.post("/api/try", json=request).json()
    assert session.sources.reads == 1
    text = str(request["map"]).replace("`Force [N]`", "`Force [N]` [kN]")
    second = client.post("/api/try", json={**request, "map": text}).json()
    client.post("/api/import", json={**request, "map": text, "into": "kilo"})
    assert session.sources.reads == 1
    most = [
        next(c["most"] for c in r["runs"][0]["columns"] if c["name"] == "friction_n")
        for r in (first, second)
    ]
    assert most[1] == pytest.approx(1000.0 * most[0])
    # A file that has changed is read again.
    log = (folder / "log1.csv").read_text()
    (folder / "log1.csv").write_text(log + log.splitlines()[-1].replace("19990", "20000") + "\n")
    again = client.post("/api/try", json=request).json()
    assert session.sources.reads == 2
    assert again["runs"][0]["samples"] == first["runs"][0]["samples"] + 1


def test_preview_from_stored_columns_equals_that_from_the_file(client: TestClient) -> None:
    request = request_of(client)
    first, second = (client.post("/api/try", json=request).json() for _ in range(2))
    assert first == second


def test_new_reading_cancels_the_one_before_it(folder: Path) -> None:
    session = Session(Folder.of(folder))
    with session.readings.begin("first") as first:
        first.tick(1, 2)
        with session.readings.begin("second") as second, pytest.raises(Cancelled):
            first.tick(2, 2)
        second.tick(1, 1)
    with session.readings.begin("third") as third:
        assert session.cancel()
        with pytest.raises(Cancelled):
            third.tick(1, 2)
    assert not session.cancel()


@pytest.mark.parametrize("name", ["bearing", "axis", "joint"])
def test_sample_opens_with_its_runs_and_is_copied_once(folder: Path, name: str) -> None:
    session = Session(Folder.of(folder))
    client = client_of(session)
    for _ in range(2):
        assert client.post("/api/sample", json={"name": name}).status_code == 200
    assert len(client.get("/api/state").json()["runs"]) in (4, 5)
    assert len([path for path in folder.iterdir() if path.is_dir()]) == 1
    assert client.post("/api/sample", json={"name": "other"}).status_code == 422
    session.close()


def test_recording_in_json_is_uploaded_and_listed_but_not_the_ledger(client: TestClient) -> None:
    rows = [{"time_s": 0.01 * k, "position_m": 0.001 * k, "friction_n": 1.0} for k in range(400)]
    answer = client.post("/api/upload?name=log.json", content=json.dumps(rows).encode())
    assert answer.status_code == 200
    assert client.post("/api/look", json={"file": "log.json"}).json()["open"] == []
    assert client.post("/api/import", json=request_of(client)).status_code == 200
    assert client.get("/api/files").json()["other"] == ["log.json"]


GEOMETRY = {
    "bearing.radius_m": "20 mm", "bearing.length_m": "30 mm", "bearing.clearance_m": "0.05 mm",
    "bearing.mass_kg": "2", "bearing.count": "2", "lubricant.viscosity_pa_s": "5 mPa s",
    "load.normal_n": "200 N",
}  # fmt: skip


@pytest.mark.parametrize(
    ("header", "friction"),
    [("Time [s],Torque [N m],Speed [rpm]", 1.25), ("Time [s],Force [N],Angle [rad]", 0.05)],
)
def test_recording_of_a_journal_bearing_is_imported_by_its_geometry(
    tmp_path: Path, header: str, friction: float
) -> None:
    """A torque of 0.05 N m on two journals of 20 mm radius, or a force of 0.05 N."""
    t = np.arange(0.0, 8.0, 0.01)
    motion = 30.0 + 20.0 * np.sin(t)
    rows = np.column_stack([t, np.full(len(t), 0.05), motion])
    np.savetxt(tmp_path / "shaft.csv", rows, "%.6f", ",", header=header, comments="")
    session = Session(Folder.of(tmp_path))
    client = client_of(session)
    found = client.post("/api/look", json={"file": "shaft.csv"}).json()
    text = found["map"]

    def answer(**rig: str) -> Any:
        form = {"rows": [r for r in found["form"]["rows"] if "column" in r], "rig": rig}
        request = {"files": ["shaft.csv"], "map": text, "form": form}
        return client.post("/api/try", json=request).json()

    outcome = answer(machine="bearing")
    (point,) = outcome["open"]
    assert {field["place"] for field in point["fields"]} == set(GEOMETRY)
    found, text = outcome, outcome["map"]
    outcome = answer(**GEOMETRY)
    assert (outcome["open"], outcome["problem"]) == ([], None)
    columns = {c["name"]: c for c in outcome["runs"][0]["columns"]}
    assert columns["friction_n"]["median"] == pytest.approx(friction)
    request = {"files": ["shaft.csv"], "map": outcome["map"], "into": "runs"}
    assert client.post("/api/import", json=request).status_code == 200
    bearing = session.on_bench().rig.bearing
    assert bearing is not None
    assert (bearing.radius_m, bearing.count) == (pytest.approx(0.02), 2)
    assert session.law == "journal"
    # The map is also valid on the command line.
    (tmp_path / "map.toml").write_text(outcome["map"])
    log, place = str(tmp_path / "shaft.csv"), str(tmp_path / "again")
    assert main(["import", log, "--map", str(tmp_path / "map.toml"), "--folder", place]) == 0
    # The other kind of machine can be selected again.
    found, text = outcome, outcome["map"]
    assert set(answer(machine="drive")["form"]["rig"]) == {"drive"}
    session.close()


def test_open_geometry_of_a_bearing_is_not_asked_twice(client: TestClient) -> None:
    request = {**request_of(client), "form": {"rows": [], "rig": {"machine": "bearing"}}}
    outcome = client.post("/api/try", json=request).json()
    places = [field["place"] for point in outcome["open"] for field in point.get("fields", ())]
    assert sorted(places) == sorted(GEOMETRY)
