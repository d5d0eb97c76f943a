"""`jbf import`: the guessed map, the imported folder, and refused files, maps and commands."""

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


def printed(capsys: pytest.CaptureFixture[str], command: str, code: int = 0) -> str:
    """Return the standard output of a command, or its standard error if it fails."""
    assert main(shlex.split(command)) == code
    out = capsys.readouterr()
    return out.out if code == 0 else out.err


def files(folder: Path) -> dict[Path, bytes]:
    return {p: p.read_bytes() for p in folder.rglob("*") if p.is_file()}


def test_import_without_a_map_writes_a_map_that_can_be_imported(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "map.toml").unlink()
    text = printed(capsys, "import log.csv")
    assert "Nothing is open" in text
    assert "jbf import log.csv --map map.toml --out FOLDER" in text
    assert "3 runs" not in printed(capsys, "import log.csv --map map.toml --out runs")
    assert sorted(p.name for p in (folder / "runs").iterdir()) == [
        "cut.toml", "import.json", "log.csv", "map.toml", "rig.toml",
    ]  # fmt: skip


def test_open_questions_are_written_to_the_map_and_reported(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "log.csv").write_text("time,speed_rpm,torque_pct\n" + "1,2,3\n2,3,4\n" * 20)
    (folder / "map.toml").unlink()
    assert "Not sure" in printed(capsys, "import log.csv")
    text = (folder / "map.toml").read_text()
    assert 'time_s = "`time` [?]"' in text
    assert 'rated_torque_n_m = "?"' in text
    assert "key columns.time_s: is open" in printed(
        capsys, "import log.csv --map map.toml --out runs", 2
    )
    # Without the map, each question is one line.
    lines = printed(capsys, "import log.csv --out runs", 2).splitlines()
    assert len(lines) == 2
    assert all(line.startswith("jbf: log.csv, ") for line in lines)
    assert not (folder / "runs").exists()


def test_existing_map_is_replaced_only_with_the_force_option(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert "is there already" in printed(capsys, "import log.csv", 2)
    assert (folder / "map.toml").read_text() == MAP
    printed(capsys, "import log.csv --force")
    assert (folder / "map.toml").read_text() != MAP


def test_import_folder_is_replaced_only_with_force_and_never_if_it_holds_other_files(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    command = "import log.csv --map map.toml --out runs"
    printed(capsys, command)
    before = files(folder)
    assert "holds an import already" in printed(capsys, command, 2)
    assert files(folder) == before
    printed(capsys, f"{command} --force")
    (folder / "mine").mkdir()
    (folder / "mine" / "notes.txt").write_text("something else")
    assert "holds other files" in printed(capsys, command.replace("runs", "mine") + " --force", 2)


def test_import_without_an_output_folder_writes_nothing(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = files(folder)
    assert "Nothing was written" in printed(capsys, "import log.csv --map map.toml")
    assert files(folder) == before


def test_import_with_the_plot_option_writes_a_png_and_reports_the_runs(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "map.toml").write_text(MAP + '[cut]\nby = "rests"\n')
    text = printed(capsys, "import log.csv --map map.toml --out runs --plot cut.png")
    assert "3 runs" in text
    assert "Left out:" in text
    assert (folder / "cut.png").read_bytes().startswith(b"\x89PNG")


def test_fit_and_compare_give_equal_results_from_an_imported_folder_and_from_a_map(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "map.toml").write_text(MAP + '[cut]\nby = "rests"\n')
    printed(capsys, "import log.csv --map map.toml --out runs")
    by_folder = printed(capsys, "fit runs --law coulomb --effects inertia_leak --out a.toml")
    by_map = printed(
        capsys, "fit map.toml log.csv --law coulomb --effects inertia_leak --out b.toml"
    )
    assert by_folder == by_map
    assert (folder / "a.toml").read_bytes() == (folder / "b.toml").read_bytes()
    compared = printed(capsys, "compare a.toml runs")
    assert printed(capsys, "compare a.toml log.csv --map map.toml") == compared
    model = jbf.Model.load(folder / "a.toml")
    assert model.parameters["inertia_leak.m_e_kg"].value == pytest.approx(12.0, abs=0.2)


def set_cell(text: str, row: int, column: int, new: str) -> str:
    lines = text.splitlines()
    cells = lines[row - 1].split(",")
    cells[column] = new
    lines[row - 1] = ",".join(cells)
    return "\n".join(lines) + "\n"


BAD_FILES = {
    "a word for a number": (
        lambda t: set_cell(t, 30, 3, "abc"), 'row 30, column friction_n: "abc"',
    ),
    "a row too long": (lambda t: set_cell(t, 9, 2, "1,2"), "row 9: has 6 cells"),
    "a row too short": (lambda t: t.replace(t.splitlines()[8], "1"), "row 9: has 1 cell"),
    "time runs back": (lambda t: set_cell(t, 500, 0, "5.0"), "row 500: sample 499: time runs back"),
    "no numbers": (lambda t: "a,b\nc,d\n", "holds no rows of numbers"),
    "a few samples": (lambda t: "\n".join(t.splitlines()[:6]), "nothing is left to be a run"),
}  # fmt: skip


@pytest.mark.parametrize("case", BAD_FILES)
def test_invalid_recording_is_refused_in_one_line_and_writes_nothing(
    case: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    change, fragment = BAD_FILES[case]
    path = folder / "log.csv"
    path.write_text(change(path.read_text()))
    before = files(folder)
    line = printed(capsys, "import log.csv --map map.toml --out runs", 2)
    assert line.count("\n") == 1
    assert line.startswith("jbf: log.csv")
    assert fragment in line
    assert files(folder) == before
    assert [p.name for p in folder.iterdir() if p.is_dir()] == []


BAD_MAPS = {
    "": "key columns: is missing; add [columns] with lines such as",
    MAP + '[file]\nencoding = "utf-99"\n': "utf-99",
    MAP + "[file]\nheader = 9999999999999\n": "log.csv",
    MAP + "[file]\nrate_hz = 0\n": "key file.rate_hz: 0 does not fit",
    MAP.replace('"friction_n"', '"' + "(" * 3000 + '1"'): "friction_n",
    MAP.replace('"friction_n"', '"friction_n / 0"'): "friction_n",
    MAP.replace('"friction_n"', '"exec(friction_n)"'): "friction_n",
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


@pytest.mark.parametrize("text", BAD_MAPS, ids=range(len(BAD_MAPS)))
def test_invalid_map_is_refused_in_one_line_and_writes_nothing(
    text: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "map.toml").write_text(text)
    before = files(folder)
    line = printed(capsys, "import log.csv --map map.toml --out runs", 2)
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
def test_invalid_import_command_is_refused_in_one_line_and_writes_nothing(
    command: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = files(folder)
    line = printed(capsys, command, 2)
    assert line.count("\n") == 1
    assert BAD_COMMANDS[command] in line
    assert files(folder) == before


def test_error_about_open_questions_can_be_pickled(folder: Path) -> None:
    (folder / "log.csv").write_text("time,speed_rpm,torque_pct\n" + "1,2,3\n2,3,4\n" * 20)
    with pytest.raises(jbf.InputError) as refused:
        jbf.import_files("log.csv")
    assert "(and 1 more)" in str(refused.value)
    assert str(pickle.loads(pickle.dumps(refused.value))) == str(refused.value)


def test_read_recording_returns_the_same_runs_as_import_files(folder: Path) -> None:
    rig, runs = jbf.read_recording("log.csv", "map.toml")
    assert rig.drive is not None
    assert len(runs) == 1
    result = jbf.import_files(["log.csv"], jbf.read_map("map.toml"), "runs")
    np.testing.assert_array_equal(result.runs[0].friction_n, runs[0].friction_n)
    assert result.to_dict() == json.loads((folder / "runs" / "import.json").read_text())


def test_look_maps_the_column_names_of_jbf_without_questions(folder: Path) -> None:
    guess = jbf.look("log.csv")
    assert guess.sure
    assert dict(guess.map().columns)["friction_n"] == "`friction_n`"
