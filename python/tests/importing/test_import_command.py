"""`jbf import`: inferred map, imported folder, and refused files, maps and commands."""

import json
import pickle
import shlex
from pathlib import Path

import jbf
import numpy as np
import pytest
from input_checks import Capture, refused
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
RESTS = MAP + '[cut]\nby = "rests"\n'
IMPORT = "import log.csv --map map.toml --folder runs"
OPEN = "time,speed_rpm,torque_pct\n" + "".join(f"{k},2,3\n" for k in range(40))
"""A recording whose map has open entries."""


@pytest.fixture(autouse=True)
def working_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Work in a folder with a recording of three motions, `log.csv`, and its `map.toml`."""
    monkeypatch.chdir(tmp_path)
    csv(Path("log.csv"), recording(3, 8.0, 4.0).columns)
    Path("map.toml").write_text(MAP)


def printed(capsys: Capture, command: str, code: int = 0) -> str:
    """Return the standard output of a command, or its standard error if it fails."""
    assert main(shlex.split(command)) == code
    out = capsys.readouterr()
    return out.out if code == 0 else out.err


def refusal(capsys: Capture, command: str, fragment: str) -> str:
    """Check that a command fails with one line and changes no file; return the line."""
    return refused(shlex.split(command), fragment, capsys)


def test_import_without_a_map_writes_a_map_that_can_be_imported(capsys: Capture) -> None:
    Path("map.toml").unlink()
    text = printed(capsys, "import log.csv")
    assert "No questions are open" in text
    assert "jbf import log.csv --map map.toml --folder FOLDER" in text
    assert "1 run of" in printed(capsys, f"{IMPORT} --no-cut")
    written = {path.name for path in Path("runs").iterdir()}
    assert written == {"cut.toml", "import.json", "log.csv", "map.toml", "rig.toml"}


def test_assumed_drive_is_reported_with_the_section_for_a_bearing(capsys: Capture) -> None:
    Path("map.toml").unlink()
    assert "[bearing]" in printed(capsys, "import log.csv")
    assert "[bearing]" in Path("map.toml").read_text()
    assert "[bearing]" in printed(capsys, "import log.csv --folder runs")
    notes = json.loads(Path("runs/import.json").read_text())["files"][0]["notes"]
    assert any("[bearing]" in note for note in notes)
    # A map states the machine.
    assert "[bearing]" not in printed(capsys, f"{IMPORT} --force")


def test_recording_is_cut_at_its_rests_by_default_and_the_option_to_disable_is_named(
    capsys: Capture,
) -> None:
    text = printed(capsys, IMPORT)
    assert "3 runs of" in text
    assert "--no-cut keeps it whole" in text
    assert len(jbf.import_files("log.csv", "map.toml", whole=True).runs) == 1


def test_stick_slip_motion_is_not_cut_by_default(capsys: Capture) -> None:
    time_s = np.arange(0.0, 20.0, 0.01)
    slips = np.floor(time_s / 0.8) + np.clip((time_s % 0.8) / 0.2, 0.0, 1.0)
    force = np.where(time_s % 0.8 < 0.2, 5.0, 6.0)
    csv(Path("log.csv"), {"time_s": time_s, "position_m": 1e-3 * slips, "friction_n": force})
    Path("map.toml").write_text(MAP.replace('velocity_m_s = "velocity_m_s"\n', ""))
    assert "1 run of" in printed(capsys, IMPORT)


def test_open_entries_are_marked_in_the_written_map_and_refused(capsys: Capture) -> None:
    Path("log.csv").write_text(OPEN)
    Path("map.toml").unlink()
    assert "Questions" in printed(capsys, "import log.csv")
    text = Path("map.toml").read_text()
    assert 'time_s = "`time` [?]"' in text
    assert 'rated_torque_n_m = "?"' in text
    # Each open entry, and without the map each question, is one line.
    lines = printed(capsys, IMPORT, 2).splitlines()
    places = ("columns.time_s", "drive.rated_torque_n_m")
    assert all(f"key {place}: is open" in line for place, line in zip(places, lines, strict=True))
    lines = printed(capsys, "import log.csv --folder runs", 2).splitlines()
    assert len(lines) == 2
    assert all(line.startswith("jbf: log.csv, ") for line in lines)
    assert not Path("runs").exists()


def test_import_of_several_files_with_open_questions_names_the_command_that_writes_a_map(
    capsys: Capture,
) -> None:
    for name in ("log.csv", "second.csv"):
        Path(name).write_text(OPEN)
    Path("map.toml").unlink()
    *_, last = printed(capsys, "import log.csv second.csv --folder runs", 2).splitlines()
    assert last.endswith("jbf import log.csv second.csv")
    inspected = printed(capsys, "import log.csv second.csv")
    assert 'rated_torque_n_m = "?"' in Path("map.toml").read_text()
    assert "jbf import log.csv second.csv --map map.toml --folder FOLDER" in inspected


@pytest.mark.parametrize(
    ("header", "geared"),
    [
        ("time_s,speed_rpm,torque_pct", True),
        ("time_s,speed_rpm,current_a", True),
        ("time_s,position_mm,motor_torque_Nm", True),
        ("time_s,speed_rpm,torque_Nm", False),
        ("time_s,position_mm,force_N", False),
    ],
)
def test_written_map_offers_a_gear_ratio_if_the_force_is_that_of_a_motor(
    header: str, geared: bool, capsys: Capture
) -> None:
    Path("log.csv").write_text(OPEN.replace(OPEN.split("\n")[0], header))
    Path("map.toml").unlink()
    printed(capsys, "import log.csv")
    assert ("# gear_ratio = 1.0" in Path("map.toml").read_text()) == geared


def test_missing_columns_of_a_bearing_are_derived_from_those_of_the_shaft_in_the_remedy(
    capsys: Capture,
) -> None:
    csv(Path("log.csv"), {"t": [0.0], "M": [1.0], "n": [60.0]})
    bearing = "radius_m = 0.025\nlength_m = 0.03\nclearance_m = 5e-5\nmass_kg = 5\ncount = 2\n"
    head = '[columns]\ntime_s = "t [s]"\n'
    columns = 'torque_n_m = "M [N m]"\nspeed_rpm = "n - 1 [rpm]"\n'
    Path("map.toml").write_text(f"{head}{columns}[bearing]\n{bearing}")
    line = refusal(capsys, IMPORT, "columns.friction_n")
    for derived in (
        'friction_n = "M [N m] / 25 [mm] / 2"',
        'velocity_m_s = "(n - 1 [rpm]) * 25 [mm]"',
    ):
        assert derived in line


def test_edited_map_is_kept_by_a_second_import_and_another_file_gets_a_separate_map(
    capsys: Capture,
) -> None:
    # A map that was not written by a look must not be replaced.
    assert "log.map.toml was written" in printed(capsys, "import log.csv")
    assert Path("map.toml").read_text() == MAP
    edited = Path("log.map.toml").read_text().replace("linear", "rotary")
    Path("log.map.toml").write_text(edited)
    assert "log.map.toml exists and was kept" in printed(capsys, "import log.csv")
    assert Path("log.map.toml").read_text() == edited
    printed(capsys, "import log.csv --force")
    assert Path("log.map.toml").read_text() != edited
    Path("other.csv").write_text(Path("log.csv").read_text())
    Path("map.toml").unlink()
    assert "map.toml was written" in printed(capsys, "import other.csv")
    assert "log.map.toml exists" in printed(capsys, "import log.csv")


def test_force_option_replaces_an_import_but_no_folder_with_other_files(capsys: Capture) -> None:
    printed(capsys, IMPORT)
    refusal(capsys, IMPORT, "contains an import already")
    printed(capsys, f"{IMPORT} --force")
    Path("mine").mkdir()
    Path("mine/notes.txt").write_text("something else")
    refusal(capsys, IMPORT.replace("runs", "mine") + " --force", "is not empty")


def test_import_without_an_output_folder_writes_nothing(capsys: Capture) -> None:
    before = {path: path.read_bytes() for path in Path().iterdir()}
    assert "Nothing was written" in printed(capsys, "import log.csv --map map.toml")
    assert {path: path.read_bytes() for path in Path().iterdir()} == before


def test_import_with_the_plot_option_writes_a_png_and_reports_the_runs(capsys: Capture) -> None:
    Path("map.toml").write_text(RESTS)
    text = printed(capsys, f"{IMPORT} --plot cut.png")
    assert "3 runs" in text
    assert "Left out:" in text
    assert Path("cut.png").read_bytes().startswith(b"\x89PNG")


def test_fit_and_compare_have_equal_results_for_a_map_and_its_import(capsys: Capture) -> None:
    Path("map.toml").write_text(RESTS)
    printed(capsys, IMPORT)
    options = "--law coulomb --effects inertia --out"
    Path("raw.csv").write_text("Zeit,Weg\n0.0,0.0\n0.1,0.0\n")
    by_folder = printed(capsys, f"fit runs {options} a.toml")
    assert printed(capsys, f"fit map.toml log.csv {options} b.toml") == by_folder
    assert Path("a.toml").read_bytes() == Path("b.toml").read_bytes()
    assert "jbf import raw.csv --map" in refusal(capsys, "predict a.toml raw.csv", "column")
    compared = printed(capsys, "compare a.toml runs")
    assert printed(capsys, "compare a.toml log.csv --map map.toml") == compared
    model = jbf.Model.load("a.toml")
    assert model.parameters["inertia.m_e"].value == pytest.approx(12.0, abs=0.2)


def set_cell(text: str, row: int, column: int, new: str) -> str:
    lines = text.splitlines()
    cells = lines[row - 1].split(",")
    cells[column] = new
    lines[row - 1] = ",".join(cells)
    return "\n".join(lines) + "\n"


def every(step: int, text: str, cell: str | None) -> str:
    """Damage every `step`-th row: replace one cell, or remove all cells except the first."""
    lines = text.splitlines()
    for k in range(step + 1, len(lines), step):
        cells = lines[k].split(",")
        lines[k] = cells[0] if cell is None else ",".join([*cells[:3], cell, *cells[4:]])
    return "\n".join(lines) + "\n"


@pytest.mark.parametrize("cell", ["ab0.3", "1,2", None])
def test_damaged_rows_are_dropped_and_reported_up_to_one_in_a_thousand(
    cell: str | None, capsys: Capture
) -> None:
    path = Path("log.csv")
    path.write_text(every(1050, path.read_text(), cell))
    text = printed(capsys, f"{IMPORT} --no-cut")
    assert "1 row left out: the row is damaged" in text
    assert "the first in row 1052" in " ".join(text.split())
    path.write_text(every(300, path.read_text(), cell))
    refusal(capsys, f"{IMPORT} --force", "rows are damaged")


BAD_FILES = {
    "words": (lambda t: every(200, t, "abc"), 'row 202, column friction_n: "abc"'),
    "rows too long": (lambda t: every(200, t, "1,2"), "row 202: has 6 cells"),
    "rows too short": (lambda t: every(200, t, None), "row 202: has 1 cell"),
    "time decreases": (lambda t: set_cell(t, 500, 0, "5.0"), "row 500: sample 499: time decreases"),
    "no numbers": (lambda t: "a,b\nc,d\n", "contains no numeric rows"),
    "a few samples": (lambda t: "\n".join(t.splitlines()[:6]), "no run remains"),
}  # fmt: skip


@pytest.mark.parametrize("case", BAD_FILES)
def test_invalid_recording_is_refused_and_writes_nothing(case: str, capsys: Capture) -> None:
    change, fragment = BAD_FILES[case]
    path = Path("log.csv")
    path.write_text(change(path.read_text()))
    assert refusal(capsys, IMPORT, fragment).startswith("jbf: log.csv")
    assert not any(p.is_dir() for p in Path().iterdir())


def test_quantity_with_a_unit_is_converted_to_the_unit_of_its_key(capsys: Capture) -> None:
    servo = (
        '[columns]\ntime_s = "time_s"\nposition_m = "position_m"\n'
        'torque_percent = "friction_n [%]"\n'
        '[drive]\nmotion = "linear"\nfriction = "percent"\n'
    )
    Path("map.toml").write_text(servo + 'rated_torque_n_m = "127 N cm"\npitch_m = "10 mm"\n')
    rig = jbf.import_files("log.csv", "map.toml").rig
    assert rig.drive is not None
    assert rig.drive.rated_torque_n_m == pytest.approx(1.27, rel=1e-12)
    assert rig.drive.pitch_m == pytest.approx(0.01, rel=1e-12)
    Path("map.toml").write_text(servo + 'rated_torque_n_m = "127 N"\npitch_m = 0.01\n')
    refusal(capsys, IMPORT, "key drive.rated_torque_n_m: '127 N' is not a quantity in N m")


def test_rows_that_violate_the_condition_of_the_map_are_dropped(capsys: Capture) -> None:
    table = dict(recording(1, 8.0, 4.0).columns)
    powered = (table["time_s"] > 5.0) & (table["time_s"] < 9.0)
    csv(Path("log.csv"), {**table, "powered": powered.astype(float)})
    Path("map.toml").write_text(MAP + '[cut]\nby = []\nkeep = "powered == 1"\n')
    assert "not powered == 1" in printed(capsys, IMPORT)
    (run,) = jbf.import_files("log.csv", "map.toml").runs
    np.testing.assert_array_equal(run.time_s, table["time_s"][powered])


def test_nonpositive_load_is_refused_only_in_rows_that_the_import_keeps(capsys: Capture) -> None:
    table = dict(recording(1, 8.0, 4.0).columns)
    off = table["time_s"] < 3.0
    csv(Path("log.csv"), {**table, "load_n": np.where(off, -0.1, 40.0)})
    loaded = MAP.replace("[drive]", 'load_n = "load_n"\n[drive]')
    Path("map.toml").write_text(loaded + "[cut]\nby = []\n")
    line = refusal(capsys, IMPORT, "a load of -0.1 N at 0 s is not above zero")
    assert "keep = 'load_n > 4 [N]'" in line
    Path("map.toml").write_text(loaded + '[cut]\nby = []\nkeep = "load_n > 4 [N]"\n')
    assert "1 run of" in printed(capsys, IMPORT)


BAD_MAPS = {
    MAP + '[cut]\nkeep = "powered"\n': "key cut.keep: 'powered' is not a condition",
    MAP + '[cut]\nkeep = "nothing == 1"\n': "key cut.keep",
    "": "key columns: is missing; add [columns] with lines such as",
    MAP + '[file]\nencoding = "utf-99"\n': "utf-99",
    MAP + "[file]\nheader = 9999999999999\n": "log.csv",
    MAP + "[file]\nrate_hz = 0\n": "key file.rate_hz: 0 is not valid",
    MAP.replace('"friction_n"', '"' + "(" * 3000 + '1"'): "friction_n",
    MAP.replace('"friction_n"', '"friction_n / 0"'): "friction_n",
    MAP.replace('"friction_n"', '"exec(friction_n)"'): "friction_n",
    "[columns]\nfricton_n = 'friction_n'\n": "columns.fricton_n: is not known",
    "[colums]\na = 1\n": 'did you mean "columns"',
    "[columns]\ntime_s = 3\n": "key columns.time_s: 3 is not text",
    MAP + "[cut]\nby = 'rest'\n": 'did you mean "rests"',
    MAP + "[cut]\nby = 'run'\n": "key cut.column: is missing",
    MAP + "[cut]\nrest_s = -1\n": "key cut.rest_s",
    MAP + "[cut]\nby = 'run'\ncolumn = 'nr'\n": 'no column "nr"',
    MAP + "[file]\ndelimiter = 'ab'\n": "key file.delimiter",
    MAP + "[file]\ndelimter = ';'\n": 'did you mean "delimiter"',
    MAP + "[clocks]\nload_n = 'time_s'\n": "key clocks.load_n",
    MAP.replace('"friction_n"', '"frction_n"'): 'no column "frction_n"',
    MAP.replace('"friction_n"', '"friction_n [mm]"'): "but N is required",
    MAP.replace('"friction_n"', '"friction_n +"'): "ends where",
    MAP.replace("friction_n", "torque_n_m"): "columns.friction_n: is missing",
    MAP.replace('"linear"', '"rotary"'): "drive.friction",
    MAP.partition("[drive]")[0]: "does not describe the machine",
    MAP.replace("[drive]", "[drve]"): 'did you mean "drive"',
    MAP.replace('"time_s"', '"time_s [kg]"'): "but s is required",
    MAP.replace('time_s = "time_s"\n', ""): "columns.time_s: is missing",
    "[columns\n": "is not TOML",
}


@pytest.mark.parametrize("text", BAD_MAPS, ids=range(len(BAD_MAPS)))
def test_invalid_map_is_refused_and_writes_nothing(text: str, capsys: Capture) -> None:
    Path("map.toml").write_text(text)
    refusal(capsys, IMPORT, BAD_MAPS[text])


BAD_COMMANDS = {
    "import nothing.csv --folder runs": "the file does not exist",
    "import . --map map.toml --folder runs": "is a folder",
    "import log.csv log.csv --map map.toml --folder runs": "the same name",
    "import log.csv --map map.toml --folder log.csv": "is a file, not a folder",
    "import log.csv --map map.toml --folder a/b": "its parent folder does not exist",
    "import log.csv --map none.toml --folder runs": "does not exist",
    "import log.csv --map map.toml --folder runs --cut none.toml": "does not exist",
    "import log.csv --cut cut.toml": "requires --map or --folder",
    "import log.csv --map map.toml --plot log.csv": "is also an input",
    "diagnose map.toml": "RUN are missing",
    "fit map.toml --out m.toml": "RUN is missing",
}


@pytest.mark.parametrize("command", BAD_COMMANDS)
def test_invalid_command_is_refused_and_writes_nothing(command: str, capsys: Capture) -> None:
    refusal(capsys, command, BAD_COMMANDS[command])


def test_error_about_open_map_entries_is_unchanged_by_pickling() -> None:
    Path("log.csv").write_text(OPEN)
    with pytest.raises(jbf.InputError) as caught:
        jbf.import_files("log.csv")
    assert "(and 1 more)" in str(caught.value)
    assert str(pickle.loads(pickle.dumps(caught.value))) == str(caught.value)


def test_read_recording_returns_the_same_runs_as_import_files() -> None:
    rig, runs = jbf.read_recording("log.csv", "map.toml")
    assert rig.drive is not None
    assert len(runs) == 3
    result = jbf.import_files(["log.csv"], jbf.read_map("map.toml"), "runs")
    np.testing.assert_array_equal(result.runs[0].friction, runs[0].friction)
    assert result.to_dict() == json.loads(Path("runs/import.json").read_text())
