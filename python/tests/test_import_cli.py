"""`jbf import` on the command line: the guess, the map, the folder; bad input is one line each."""

from __future__ import annotations

import json
import pickle
import shlex
from pathlib import Path

import jbf
import numpy as np
import pytest
from jbf.cli import main
from long_recording import recording
from recording_files import csv

MAP = """\
[columns]
time_s = "time_s"
position_m = "position_m"
velocity_m_s = "velocity_m_s"
friction_n = "friction_n"
[drive]
motion = "linear"
friction = "force"
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    csv(tmp_path / "log.csv", recording(3, 8.0, 4.0).columns)
    (tmp_path / "map.toml").write_text(MAP)
    return tmp_path


def said(capsys: pytest.CaptureFixture[str], command: str, code: int = 0) -> str:
    assert main(shlex.split(command)) == code
    out = capsys.readouterr()
    return out.out if code == 0 else out.err


def files(folder: Path) -> dict[Path, bytes]:
    return {p: p.read_bytes() for p in folder.rglob("*") if p.is_file()}


def test_a_look_writes_a_map_that_imports(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "map.toml").unlink()
    words = said(capsys, "import log.csv")
    assert "Nothing is open" in words
    assert "jbf import log.csv --map map.toml --out FOLDER" in words
    assert "3 runs" not in said(capsys, "import log.csv --map map.toml --out runs")
    assert sorted(p.name for p in (folder / "runs").iterdir()) == [
        "cut.toml", "import.json", "log.csv", "map.toml", "rig.toml",
    ]  # fmt: skip


def test_a_map_with_open_questions_says_each(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "log.csv").write_text("time,speed_rpm,torque_pct\n" + "1,2,3\n2,3,4\n" * 20)
    (folder / "map.toml").unlink()
    assert "Not sure" in said(capsys, "import log.csv")
    text = (folder / "map.toml").read_text()
    assert 'time_s = "`time` [?]"' in text
    assert 'rated_torque_n_m = "?"' in text
    assert "key columns.time_s: is open" in said(
        capsys, "import log.csv --map map.toml --out runs", 2
    )
    # Without the map, every question in a line of its own.
    lines = said(capsys, "import log.csv --out runs", 2).splitlines()
    assert len(lines) == 2
    assert all(line.startswith("jbf: log.csv, ") for line in lines)
    assert not (folder / "runs").exists()


def test_an_earlier_map_is_not_written_over(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert "is there already" in said(capsys, "import log.csv", 2)
    assert (folder / "map.toml").read_text() == MAP
    said(capsys, "import log.csv --force")
    assert (folder / "map.toml").read_text() != MAP


def test_an_earlier_import_is_not_written_over(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    command = "import log.csv --map map.toml --out runs"
    said(capsys, command)
    before = files(folder)
    assert "holds an import already" in said(capsys, command, 2)
    assert files(folder) == before
    said(capsys, f"{command} --force")
    (folder / "mine").mkdir()
    (folder / "mine" / "thesis.txt").write_text("years of work")
    assert "holds other files" in said(capsys, command.replace("runs", "mine") + " --force", 2)


def test_without_a_folder_nothing_is_written(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = files(folder)
    assert "Nothing was written" in said(capsys, "import log.csv --map map.toml")
    assert files(folder) == before


def test_the_cut_is_drawn(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "map.toml").write_text(MAP + '[cut]\nby = "rests"\n')
    words = said(capsys, "import log.csv --map map.toml --out runs --plot cut.png")
    assert "3 runs" in words
    assert "Left out:" in words
    assert (folder / "cut.png").read_bytes().startswith(b"\x89PNG")


def test_compare_fit_and_diagnose_take_either(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "map.toml").write_text(MAP + '[cut]\nby = "rests"\n')
    said(capsys, "import log.csv --map map.toml --out runs")
    by_folder = said(capsys, "fit runs --law coulomb --effects inertia_leak --out a.toml")
    by_map = said(capsys, "fit map.toml log.csv --law coulomb --effects inertia_leak --out b.toml")
    assert by_folder == by_map
    assert (folder / "a.toml").read_bytes() == (folder / "b.toml").read_bytes()
    compared = said(capsys, "compare a.toml runs --report a.html")
    assert said(capsys, "compare a.toml log.csv --map map.toml") == compared
    # The report shows the ledger.
    page = (folder / "a.html").read_text()
    ledger = json.loads((folder / "runs" / "import.json").read_text())
    assert ledger["files"][0]["sha256"][:12] in page
    assert "columns, made of (unit as read" in page
    model = jbf.Model.load(folder / "a.toml")
    assert model.parameters["inertia_leak.m_e_kg"].value == pytest.approx(12.0, abs=0.2)


def cell(text: str, row: int, column: int, new: str) -> str:
    lines = text.splitlines()
    cells = lines[row - 1].split(",")
    cells[column] = new
    lines[row - 1] = ",".join(cells)
    return "\n".join(lines) + "\n"


BAD_FILES = {
    "a word for a number": (lambda t: cell(t, 30, 3, "abc"), 'row 30, column friction_n: "abc"'),
    "a comma for a point": (lambda t: cell(t, 30, 3, '"1,5"'), "row 30, column friction_n"),
    "a row too long": (lambda t: cell(t, 9, 2, "1,2"), "row 9: has 6 cells"),
    "a row too short": (lambda t: t.replace(t.splitlines()[8], "1"), "row 9: has 1 cell"),
    "time runs back": (lambda t: cell(t, 500, 0, "5.0"), "row 500: sample 499: time runs back"),
    "nothing": (lambda t: "", "is empty"),
    "no numbers": (lambda t: "a,b\nc,d\n", "holds no rows of numbers"),
    "binary": (lambda t: "\0\1\2", "is binary"),
    "a header alone": (lambda t: t.splitlines()[0] + "\n", "holds no rows of numbers"),
    "a few samples": (lambda t: "\n".join(t.splitlines()[:6]), "nothing is left to be a run"),
}  # fmt: skip


@pytest.mark.parametrize("case", BAD_FILES)
def test_a_bad_file_is_one_line_and_writes_nothing(
    case: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    change, wanted = BAD_FILES[case]
    path = folder / "log.csv"
    path.write_text(change(path.read_text()))
    before = files(folder)
    line = said(capsys, "import log.csv --map map.toml --out runs", 2)
    assert line.count("\n") == 1
    assert line.startswith("jbf: log.csv")
    assert wanted in line
    assert files(folder) == before
    assert [p.name for p in folder.iterdir() if p.is_dir()] == []


BAD_MAPS = {
    "[columns]\nfricton_n = 'friction_n'\n": "columns.fricton_n: is not known",
    "[colums]\na = 1\n": 'did you mean "columns"',
    "[columns]\ntime_s = 3\n": "key columns.time_s: 3 is no text",
    MAP + "[cut]\nby = 'rest'\n": 'did you mean "rests"',
    MAP + "[cut]\nby = 'run'\n": "key cut.column: is missing",
    MAP + "[cut]\nrest_s = -1\n": "key cut.rest_s",
    MAP + "[cut]\nby = 'run'\ncolumn = 'nr'\n": 'no column "nr"',
    MAP + "[file]\ndelimiter = 'ab'\n": "key file.delimiter",
    MAP + "[file]\ndelimter = ';'\n": 'did you mean "delimiter"',
    MAP + "[clocks]\nload_n = 'time_s'\n": "key clocks.load_n",
    MAP.replace('"friction_n"', '"frction_n"'): 'no column "frction_n"',
    MAP.replace('"friction_n"', '"friction_n [mm]"'): "which is no N",
    MAP.replace('"friction_n"', '"friction_n +"'): "ends where",
    MAP.replace("friction_n", "torque_n_m"): "columns.friction_n: is missing",
    MAP.replace('"linear"', '"rotary"'): "drive.friction",
    MAP.partition("[drive]")[0]: "nothing says what it was recorded on",
    MAP.replace("[drive]", "[drve]"): 'did you mean "drive"',
    MAP.replace('"time_s"', '"time_s [kg]"'): "which is no s",
    "\n".join(
        line for line in MAP.splitlines() if "time_s" not in line
    ): "columns.time_s: is missing",
    "[columns\n": "is not TOML",
}


@pytest.mark.parametrize("text", BAD_MAPS)
def test_a_bad_map_is_one_line_and_writes_nothing(
    text: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "map.toml").write_text(text)
    before = files(folder)
    line = said(capsys, "import log.csv --map map.toml --out runs", 2)
    assert line.count("\n") == 1
    assert BAD_MAPS[text] in line
    assert files(folder) == before


BAD_COMMANDS = {
    "import nothing.csv --out runs": "the file does not exist",
    "import . --map map.toml --out runs": "is a folder",
    "import log.csv log.csv --map map.toml --out runs": "the same name",
    "import log.csv --map map.toml --out log.csv": "is a file, not a folder",
    "import log.csv --map map.toml --out a/b": "its parent folder does not exist",
    "import log.csv --map none.toml --out runs": "does not exist",
    "import log.csv --map map.toml --out runs --cut none.toml": "does not exist",
    "import log.csv --cut cut.toml": "goes with --map or --out",
    "import log.csv --map map.toml --plot log.csv": "is also an input",
    "diagnose map.toml": "RUN are missing",
    "fit map.toml --out m.toml": "RUN is missing",
}


@pytest.mark.parametrize("command", BAD_COMMANDS)
def test_a_bad_command_is_one_line(
    command: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = files(folder)
    line = said(capsys, command, 2)
    assert line.count("\n") == 1
    assert BAD_COMMANDS[command] in line
    assert files(folder) == before


def test_open_questions_travel_between_processes(folder: Path) -> None:
    (folder / "log.csv").write_text("time,speed_rpm,torque_pct\n" + "1,2,3\n2,3,4\n" * 20)
    with pytest.raises(jbf.InputError) as refused:
        jbf.import_files("log.csv")
    assert "(and 1 more)" in str(refused.value)
    assert str(pickle.loads(pickle.dumps(refused.value))) == str(refused.value)


def test_from_python_it_is_one_call(folder: Path) -> None:
    rig, runs = jbf.read_recording("log.csv", "map.toml")
    assert rig.drive is not None
    assert len(runs) == 1
    found = jbf.import_files(["log.csv"], jbf.read_map("map.toml"), "runs")
    np.testing.assert_array_equal(found.runs[0].friction_n, runs[0].friction_n)
    assert found.to_dict() == json.loads((folder / "runs" / "import.json").read_text())
    guess = jbf.look("log.csv")
    assert guess.sure
    assert dict(guess.map().columns)["friction_n"] == "`friction_n`"
