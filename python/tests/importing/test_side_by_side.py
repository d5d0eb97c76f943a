"""Files that were recorded at the same time with separate clocks, imported as one recording."""

import gzip
import json
import shlex
import shutil
from datetime import datetime, timedelta
from pathlib import Path

import jbf
import numpy as np
import numpy.typing as npt
import pytest
from input_checks import Capture, refused
from jbf import InputError
from jbf.cli import main

Array = npt.NDArray[np.float64]
COULOMB_N, VISCOUS_N_S_M, MASS_KG = 6.0, 40.0, 1.5
DURATION_S = 120.0
FORCE_S, FORCE_PPM, TEMPERATURE_S = 3.217, 40.0, -11.9
AMPLITUDES_M = np.array([20.0, 12.0, 8.0, 5.0, 3.0]) * 1e-3
RATES = 2.0 * np.pi * np.array([0.071, 0.13, 0.29, 0.47, 0.83])
PHASES = np.array([0.3, 1.7, 4.0, 2.2, 5.1])
MAP = """\
[file]
beside = ["force.csv", "temp.csv"]
[columns]
time_s = "drive/t [s]"
position_m = "drive/pos [mm]"
friction_n = "F [N]"
temperature_c = "temperature [°C]"
[clocks]
friction_n = "force/t [s]"
temperature_c = "temp/t [s]"
[align]
force = "drive/pos ~ lvdt"
temp = "drive/pos ~ temp/pos"
[drive]
motion = "linear"
friction = "force"
"""
TWO = (
    MAP.replace(', "temp.csv"', "")
    .replace('temperature_c = "temperature [°C]"\n', "")
    .replace('temperature_c = "temp/t [s]"\n', "")
    .replace('temp = "drive/pos ~ temp/pos"\n', "")
)
ALIGN = 'force = "drive/pos ~ lvdt"'


def position(time_s: Array) -> Array:
    """Position of the slide, m: five sines without a common period."""
    phase: Array = np.outer(time_s, RATES) + PHASES
    return np.asarray(np.sin(phase) @ AMPLITUDES_M)


def force(time_s: Array) -> Array:
    phase = np.outer(time_s, RATES) + PHASES
    speed = np.cos(phase) @ (AMPLITUDES_M * RATES)
    acceleration = -np.sin(phase) @ (AMPLITUDES_M * RATES**2)
    return np.asarray(COULOMB_N * np.sign(speed) + VISCOUS_N_S_M * speed + MASS_KG * acceleration)


def write(path: str, **columns: Array) -> None:
    header = ",".join(columns)
    table = np.column_stack(list(columns.values()))
    np.savetxt(path, table, "%.7f", ",", header=header, comments="", encoding="utf-8")


def clock(true_s: Array, offset_s: float, drift_ppm: float = 0.0) -> Array:
    """Times of a clock that has an offset and a drift relative to the true time."""
    return np.asarray((true_s - offset_s) / (1.0 + 1e-6 * drift_ppm))


def write_force(gain: float = -2.0, drift_ppm: float = FORCE_PPM, **more: Array) -> None:
    rng = np.random.default_rng(2)
    true_s = np.arange(1.0013, DURATION_S - 3.0, 1 / 200)
    columns = {
        "t [s]": clock(true_s, FORCE_S, drift_ppm),
        "F [N]": force(true_s) + 0.1 * rng.normal(size=len(true_s)),
        "lvdt [mm]": 5.0 + gain * (1e3 * position(true_s) + 0.02 * rng.normal(size=len(true_s))),
    }
    write("force.csv", **columns | more)


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with drive.csv (500 Hz), force.csv (200 Hz), temp.csv (2 Hz), map.toml, two.toml."""
    folder = tmp_path_factory.mktemp("recorded")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        write_recording()
    return folder


@pytest.fixture(autouse=True)
def working_folder(recorded: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Work in a copy of the folder with the recording."""
    shutil.copytree(recorded, tmp_path, dirs_exist_ok=True)
    monkeypatch.chdir(tmp_path)


def write_recording() -> None:
    rng = np.random.default_rng(1)
    true_s = np.arange(0.0, DURATION_S, 1 / 500)
    pos = 1e3 * position(true_s)
    write("drive.csv", **{"t [s]": true_s, "pos [mm]": pos, "I [mV]": pos * 0.0 + 1.0})
    write_force()
    true_s = np.arange(0.1, DURATION_S - 1.0, 0.5)
    noise = 0.05 * rng.normal(size=len(true_s))
    columns = {
        "t [s]": clock(true_s, TEMPERATURE_S),
        "temperature [°C]": 20.0 + 0.01 * true_s,
        "pos [mm]": 1e3 * position(true_s) + noise,
    }
    write("temp.csv", **columns)
    Path("map.toml").write_text(MAP, encoding="utf-8")
    Path("two.toml").write_text(TWO, encoding="utf-8")


def alignments(result: jbf.Import) -> dict[str, dict[str, float]]:
    """The alignment of each further file in the ledger."""
    (page,) = result.ledger["files"]
    return {further["file"]: further["alignment"] for further in page["beside"]}


def check_force(alignment: dict[str, float], drift_ppm: float = FORCE_PPM) -> None:
    """Check the offset of force.csv at mid-record to 0.2 samples and its drift to 5 ppm."""
    wanted = FORCE_S + 1e-6 * drift_ppm * alignment["pivot_s"]
    assert alignment["offset_s"] == pytest.approx(wanted, abs=0.2 / 200)
    assert alignment["drift_ppm"] == pytest.approx(drift_ppm, abs=5.0)


def refusal(fragment: str) -> str:
    with pytest.raises(InputError) as caught:
        jbf.import_files("drive.csv", "two.toml")
    assert fragment in str(caught.value)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def set_align(line: str) -> None:
    Path("two.toml").write_text(TWO.replace(ALIGN, line), encoding="utf-8")


def test_offsets_and_drift_of_three_files_are_recovered_within_a_fifth_of_a_sample() -> None:
    result = jbf.import_files("drive.csv", "map.toml", "campaign")
    found = alignments(result)
    check_force(found["force.csv"])
    assert found["temp.csv"]["offset_s"] == pytest.approx(TEMPERATURE_S, abs=0.2 * 0.5)
    assert found["temp.csv"]["drift_ppm"] == 0.0
    assert json.loads(Path("campaign/import.json").read_text()) == result.ledger
    text = " ".join(result.summary().split())
    assert "from 3 files recorded together" in text
    assert "force.csv: its clock is 3.219" in text
    assert "s behind drive.csv's at mid-record and " in text
    assert " ppm slow (by drive/pos ~ lvdt: correlation 1.000" in text
    assert "temp.csv: its clock is 11.9" in text
    (run,) = result.runs
    read = run.read["friction_n"]
    wanted = force(run.time_s[read])
    # The force away from reversals is that at the corrected instant.
    assert np.median(np.abs(run.friction[read] - wanted)) < 0.15
    np.testing.assert_allclose(run.temperature_c, 20.0 + 0.01 * run.time_s, atol=0.01)


def test_fit_of_aligned_files_recovers_the_simulated_parameters(capsys: Capture) -> None:
    command = "fit map.toml drive.csv --law coulomb --effects inertia --out model.toml"
    assert main(shlex.split(command)) == 0
    capsys.readouterr()
    parameters = jbf.Model.load("model.toml").parameters
    assert parameters["F_c"].value == pytest.approx(COULOMB_N, rel=0.02)
    assert parameters["F_v"].value == pytest.approx(VISCOUS_N_S_M, rel=0.03)
    assert parameters["inertia.m_e"].value == pytest.approx(MASS_KG, rel=0.03)


@pytest.mark.parametrize("gain", [-1e-3, 250.0])
def test_alignment_does_not_depend_on_sign_and_scale_of_the_common_signal(gain: float) -> None:
    write_force(gain)
    check_force(alignments(jbf.import_files("drive.csv", "two.toml"))["force.csv"])


def test_no_drift_is_reported_if_the_clocks_have_the_same_rate() -> None:
    write_force(drift_ppm=0.0)
    check_force(alignments(jbf.import_files("drive.csv", "two.toml"))["force.csv"], 0.0)


def test_trigger_pulses_align_to_a_third_of_a_sample() -> None:
    edges = np.array([7.31, 19.94, 25.02, 48.77, 61.18, 90.4])

    def trigger(true_s: Array) -> Array:
        after = true_s[:, None] - edges
        return np.asarray(((after > 0.0) & (after < 0.35)).any(axis=1) * 5.0)

    true_s = np.arange(0.0, DURATION_S, 1 / 500)
    drive = {"t [s]": true_s, "pos [mm]": 1e3 * position(true_s), "trigger": trigger(true_s)}
    write("drive.csv", **drive)
    write_force(drift_ppm=0.0, trigger=trigger(np.arange(1.0013, DURATION_S - 3.0, 1 / 200)))
    set_align('force = "drive/trigger ~ force/trigger"')
    found = alignments(jbf.import_files("drive.csv", "two.toml"))["force.csv"]
    assert found["offset_s"] == pytest.approx(FORCE_S, abs=1 / 600)
    guess = jbf.look("drive.csv", beside=["force.csv"])
    assert guess.align == {"force": "`drive/trigger` ~ `force/trigger`"}
    assert guess.sure


def test_periodic_common_signal_is_refused_with_both_offsets() -> None:
    true_s = np.arange(0.0, DURATION_S, 1 / 500)
    write("drive.csv", **{"t [s]": true_s, "pos [mm]": 20.0 * np.sin(np.pi * true_s)})
    true_s = np.arange(1.0, DURATION_S - 3.0, 1 / 200)
    lvdt = 20.0 * np.sin(np.pi * true_s)
    columns = {"t [s]": true_s - FORCE_S, "F [N]": np.sign(np.cos(np.pi * true_s))}
    write("force.csv", **columns, **{"lvdt [mm]": lvdt})
    line = refusal("repeats: offsets of")
    assert line.startswith("force.csv, key align.force")
    assert "or the offset in seconds" in line


@pytest.mark.parametrize("kind", ["noise", "random walk", "constant", "ramp"])
def test_signals_that_do_not_determine_the_offset_are_refused(kind: str) -> None:
    count = len(np.arange(1.0013, DURATION_S - 3.0, 1 / 200))
    noise = np.random.default_rng(4).normal(size=count)
    other = {
        "noise": noise,
        "random walk": np.cumsum(noise),
        "constant": np.full(count, 2.5),
        "ramp": np.arange(count) * 0.01,
    }[kind]
    write_force(**{"lvdt [mm]": other})
    assert refusal("align.force").startswith("force.csv")


def test_stated_offset_is_added_to_the_times_of_the_file() -> None:
    write_force(drift_ppm=0.0)
    set_align("force = 3.217")
    result = jbf.import_files("drive.csv", "two.toml")
    assert alignments(result)["force.csv"] == {
        "by": "stated",
        "offset_s": 3.217,
        "text": "its clock is 3.2170 s behind drive.csv's, as stated in the map; corrected",
    }
    (run,) = result.runs
    assert run.time_s[run.read["friction_n"]][0] == pytest.approx(1.0013, abs=1e-6)


def write_dated(path: str, true_s: Array, name: str, values: Array, error_s: float = 0.0) -> None:
    begin = datetime(2026, 11, 22, 10, 0, 0) + timedelta(seconds=error_s)
    rows = [
        f"{(begin + timedelta(seconds=s)).isoformat(timespec='microseconds')},{value:.6f}"
        for s, value in zip(true_s.tolist(), values.tolist(), strict=True)
    ]
    Path(path).write_text("\n".join([f"time,{name}", *rows]) + "\n", encoding="utf-8")


def test_dates_align_files_without_an_entry() -> None:
    true_s = np.arange(0.0, 60.0, 1 / 100)
    write_dated("drive.csv", true_s, "pos [mm]", 1e3 * position(true_s))
    later_s = np.arange(2.5, 50.0, 1 / 50)
    write_dated("force.csv", later_s, "F [N]", force(later_s))
    assert jbf.look("drive.csv", beside=["force.csv"]).sure
    result = jbf.import_files("drive.csv", beside=["force.csv"])
    assert alignments(result)["force.csv"]["offset_s"] == pytest.approx(2.5)
    assert "aligned to drive.csv by their dates" in result.summary()
    (run,) = result.runs
    read = run.read.get("friction_n", np.ones(len(run), dtype=bool))
    np.testing.assert_allclose(run.friction[read], force(run.time_s[read]), atol=1e-5)


def test_dates_of_another_time_zone_are_refused_until_an_entry_corrects_them() -> None:
    true_s = np.arange(0.0, 60.0, 1 / 100)
    write_dated("drive.csv", true_s, "pos [mm]", 1e3 * position(true_s))
    write_dated("force.csv", true_s, "F [N]", force(true_s), error_s=3600.5)
    dated = TWO.replace("drive/t [s]", "drive/time").replace("force/t [s]", "force/time")
    Path("two.toml").write_text(dated.replace(ALIGN, ""), encoding="utf-8")
    refusal("do not overlap")
    Path("two.toml").write_text(dated.replace(ALIGN, "force = -3600.5"), encoding="utf-8")
    (run,) = jbf.import_files("drive.csv", "two.toml").runs
    np.testing.assert_allclose(run.friction, force(run.time_s), atol=1e-5)


def test_times_since_1970_align_files_without_an_entry() -> None:
    true_s = np.arange(0.0, 60.0, 1 / 100)
    ms = 1_763_800_000_000.0
    write("drive.csv", **{"time_ms": ms + 1e3 * true_s, "pos [mm]": 1e3 * position(true_s)})
    later_s = np.arange(2.5, 50.0, 1 / 50)
    write("force.csv", **{"time_ms": ms + 1e3 * later_s, "F [N]": force(later_s)})
    (run,) = jbf.import_files("drive.csv", beside=["force.csv"]).runs
    read = run.read.get("friction_n", np.ones(len(run), dtype=bool))
    np.testing.assert_allclose(run.friction[read], force(run.time_s[read]), atol=1e-5)


def test_look_reports_a_missing_common_signal_and_proposes_the_only_common_column(
    capsys: Capture,
) -> None:
    Path("map.toml").unlink()
    assert main(shlex.split("import drive.csv --beside force.csv --beside temp.csv")) == 0
    text = " ".join(capsys.readouterr().out.split())
    assert "align.force: these files have separate clocks" in text
    assert "temp: 11.9" in text
    written = jbf.read_map("map.toml")
    assert [path.name for path in written.beside] == ["force.csv", "temp.csv"]
    assert written.align == {"force": "?", "temp": "`drive/pos [mm]` ~ `temp/pos [mm]`"}
    answered = Path("map.toml").read_text(encoding="utf-8").replace('force = "?"', ALIGN)
    Path("map.toml").write_text(answered, encoding="utf-8")
    assert main(shlex.split("import drive.csv --map map.toml --folder campaign")) == 0
    assert "3 files" in capsys.readouterr().out


def test_missing_unit_of_time_becomes_a_question_for_each_file() -> None:
    true_s = np.arange(0.0, 30.0, 1 / 100)
    write("drive.csv", **{"time": true_s, "pos [mm]": position(true_s), "trigger": true_s % 7})
    write("force.csv", **{"time": 1e3 * true_s, "F [N]": force(true_s), "trigger": true_s % 7})
    guess = jbf.look("drive.csv", beside=["force.csv"])
    assert [question.place for question in guess.questions] == ["time", "force/time"]
    assert guess.align == {"force": "`drive/trigger` ~ `force/trigger`"}
    assert "trigger" not in " ".join(entry.expression for entry in guess.entries)


def test_files_are_named_relative_to_the_folder_of_the_map() -> None:
    Path("maps").mkdir()
    text = TWO.replace('"force.csv"', '"../force.csv"')
    Path("maps/two.toml").write_text(text, encoding="utf-8")
    check_force(alignments(jbf.import_files("drive.csv", "maps/two.toml"))["force.csv"])


def test_file_without_an_alignment_is_refused_with_the_entry_to_add() -> None:
    set_align("")
    assert refusal('write force = "A ~ B"').startswith(
        "force.csv: its clock is separate from that of drive.csv"
    )


@pytest.mark.parametrize(
    ("line", "fragment"),
    [
        ('frce = "drive/pos ~ lvdt"', "key align.frce: is not one of the further files"),
        ('force = "lvdt"', "is not a pair of signals"),
        ('force = "drive/pos ~ drive/pos"', "needs a signal of drive.csv and one of force.csv"),
        ('force = "drive/pos ~ lvdr"', 'no column "lvdr"'),
        ('force = "?"', "is open"),
        ("force = true", "is not a signal or an offset"),
        ("force = nan", "is not a signal or an offset"),
        ("force = 5000", "do not overlap"),
    ],
)
def test_invalid_alignment_is_refused_in_one_line(line: str, fragment: str) -> None:
    set_align(line)
    refusal(fragment)


def test_time_that_starts_again_in_a_further_file_is_refused() -> None:
    count = len(np.arange(1.0013, DURATION_S - 3.0, 1 / 200))
    write_force(**{"t [s]": np.arange(count) % (count // 2) / 200.0})
    assert refusal("its time restarts").startswith("force.csv")


def test_damaged_rows_of_a_further_file_are_reported_with_its_name() -> None:
    lines = Path("force.csv").read_text(encoding="utf-8").splitlines()
    lines[500] = lines[500].split(",")[0] + ",x,y"
    Path("force.csv").write_text("\n".join(lines), encoding="utf-8")
    text = " ".join(jbf.import_files("drive.csv", "two.toml").summary().split())
    assert "force.csv: 1 row left out: the row is damaged" in text
    assert "the first in row 501" in text


BAD_COMMANDS = {
    "import drive.csv --map two.toml --beside none.csv": "none.csv",
    "import drive.csv temp.csv --beside force.csv": "requires a single FILE",
    "import drive.csv temp.csv --map two.toml --folder campaign": "name one main file",
    "import drive.csv --beside drive.csv": "has the name drive",
    "import drive.csv --map two.toml --beside cut.csv.gz --folder campaign": "cut.csv.gz",
}


@pytest.mark.parametrize("command", BAD_COMMANDS)
def test_invalid_files_of_one_recording_are_refused(command: str, capsys: Capture) -> None:
    whole = gzip.compress(Path("force.csv").read_bytes())
    Path("cut.csv.gz").write_bytes(whole[: len(whole) // 2])
    refused(shlex.split(command), BAD_COMMANDS[command], capsys)


def test_open_alignment_of_an_import_without_a_map_is_a_question(capsys: Capture) -> None:
    assert main(shlex.split("import drive.csv --beside force.csv --folder campaign")) == 2
    error = capsys.readouterr().err
    assert "align.force" in error
    assert "To write a map with these questions: jbf import drive.csv --beside force.csv" in error
    assert not Path("campaign").exists()
