"""Rigs with a drive, and the columns of their files: what is read, and each refusal's words."""

from __future__ import annotations

from collections.abc import Mapping
from math import pi
from pathlib import Path

import jbf
import numpy as np
import pytest
from jbf.cli import main
from jbf.errors import InputError
from jbf.records.drive import Drive
from jbf.records.rig import Rig, read_rig

TIME_S = 0.01 * np.arange(200)
ANGLE = 1.5 * np.sin(TIME_S)
SPEED = 1.5 * np.cos(TIME_S)
TORQUE = 3.0 * np.sign(SPEED) + 0.7 * SPEED
CURRENT = 'motion = "rotary"\nfriction = "current"\ntorque_constant_n_m_a = 0.5\n'


def section(text: str, folder: Path) -> Path:
    path = folder / "rig.toml"
    path.write_text(f"[drive]\n{text}")
    return path


def record(folder: Path, columns: Mapping[str, object]) -> Path:
    path = folder / "a.csv"
    table = np.column_stack([np.asarray(values) for values in columns.values()])
    np.savetxt(path, table, fmt="%.17g", delimiter=",", header=",".join(columns), comments="")
    return path


def one_line(error: pytest.ExceptionInfo[InputError]) -> str:
    assert "\n" not in str(error.value)
    return str(error.value)


def test_a_drive_comes_back_from_its_file(tmp_path: Path) -> None:
    rig = Rig(drive=Drive("linear", "percent", rated_torque_n_m=1.3, pitch_m=0.01, mass_kg=95.0))
    rig.write(tmp_path / "rig.toml")
    assert read_rig(tmp_path / "rig.toml") == rig
    model = jbf.Model(rig, law="coulomb")
    model.save(tmp_path / "model.toml")
    assert jbf.Model.load(tmp_path / "model.toml").rig == rig


BAD_SECTIONS = {
    'friction = "current"': ("drive.motion", "is missing; add it to [drive]"),
    'motion = "spinning"\nfriction = "torque"': ("drive.motion", '"spinning" is no motion'),
    'motion = "rotary"\nfriction = "force"': ("drive.friction", "of a rotary drive; known: torque"),
    'motion = "rotary"\nfriction = "current"': ("torque_constant_n_m_a", "is missing"),
    CURRENT + "pitch_m = 0.1": ("drive.pitch_m", "means nothing of a rotary drive"),
    CURRENT + "mass_kg = 3.0": ("drive.mass_kg", "means nothing of a rotary drive"),
    CURRENT + "gear_ratio = -3": ("drive.gear_ratio", "-3.0 is not above zero"),
    CURRENT + 'gear_ratio = "3"': ("drive.gear_ratio", '"3" is not a number'),
    CURRENT + "rated_torque_n_m = 3": ("drive.rated_torque_n_m", "is not used where a rotary"),
    CURRENT + "gear_rato = 3": ("drive.gear_rato", 'did you mean "gear_ratio"?'),
    'motion = "linear"\nfriction = "torque"': ("drive.pitch_m", "is missing, and turns a motor"),
    'motion = "linear"\nfriction = "percent"': ("rated_force_n or rated_torque_n_m", "is missing"),
    'motion = "linear"\nfriction = "current"\nforce_constant_n_a = 1\ntorque_constant_n_m_a = 1': (
        "drive.force_constant_n_a or torque_constant_n_m_a",
        "both stand there",
    ),
}


@pytest.mark.parametrize("text", BAD_SECTIONS)
def test_a_bad_section_is_one_line(
    text: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = section(text, tmp_path)
    run = record(tmp_path, {"time_s": TIME_S, "angle_rad": ANGLE, "current_a": TORQUE})
    place, words = BAD_SECTIONS[text]
    arguments = ["fit", str(path), str(run), "--law", "coulomb", "--out", str(tmp_path / "m.toml")]
    assert main(arguments) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert said.startswith(f"jbf: {path}, key ")
    assert place in said
    assert words in said


def test_a_bearing_and_a_drive_are_two_rigs() -> None:
    with pytest.raises(InputError, match=r"stands beside a \[bearing\]") as caught:
        Rig(bearing=Rig.thesis().bearing, drive=Drive("rotary", "torque"))
    one_line(caught)


def test_a_law_of_bearings_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"is a drive, and the law journal .* --law coulomb"):
        jbf.Model(Rig(drive=Drive("rotary", "torque")))


READ = {
    "torque": ("", "torque_n_m", TORQUE, 1.0),
    "motor torque": ("gear_ratio = 20", "motor_torque_n_m", TORQUE / 20, 20.0),
    "current": ("torque_constant_n_m_a = 0.5\ngear_ratio = 8", "current_a", TORQUE / 4, 4.0),
    "percent": ("rated_torque_n_m = 20\ngear_ratio = 2", "torque_percent", 2.5 * TORQUE, 0.4),
}


@pytest.mark.parametrize("what", READ)
def test_torques_of_a_joint(what: str, tmp_path: Path) -> None:
    keys, column, values, size = READ[what]
    friction = what.split()[-1]
    path = section(f'motion = "rotary"\nfriction = "{friction}"\n{keys}', tmp_path)
    rig = read_rig(path)
    file = record(tmp_path, {"time_s": TIME_S, "angle_rad": ANGLE, column: values})
    run = jbf.read_run(file, rig)
    assert run.friction_n is not None
    np.testing.assert_allclose(run.friction_n, TORQUE, rtol=1e-12)
    told = [(f.kind, f.unit, f.size) for f in run.reading]
    assert told == ([] if size == 1.0 else [("converted", "N m", pytest.approx(size))])
    assert all(column in f.words for f in run.reading)


def test_a_slide_on_a_screw(tmp_path: Path) -> None:
    """Power in is power out: torque times speed of the motor is force times speed of the slide."""
    keys = 'motion = "linear"\nfriction = "torque"\npitch_m = 0.02\ngear_ratio = 3'
    rig = read_rig(section(keys, tmp_path))
    motor_rad_s = 40.0 * SPEED
    columns = {
        "time_s": TIME_S,
        "motor_angle_rad": 40.0 * ANGLE,
        "motor_speed_rpm": motor_rad_s * 60.0 / (2.0 * pi),
        "motor_torque_n_m": TORQUE,
    }
    run = jbf.read_run(record(tmp_path, columns), rig)
    assert run.friction_n is not None
    assert run.position_m is not None
    np.testing.assert_allclose(run.friction_n * run.velocity_m_s, TORQUE * motor_rad_s, rtol=1e-9)
    turns = 40.0 * ANGLE / (2.0 * pi)
    np.testing.assert_allclose(run.position_m, turns / 3.0 * 0.02, rtol=1e-9)
    assert len(run.reading) == 3


def test_an_angle_that_starts_again_is_made_whole_before_the_gear(tmp_path: Path) -> None:
    rig = read_rig(section('motion = "rotary"\nfriction = "torque"\ngear_ratio = 10', tmp_path))
    motor = 10.0 * ANGLE
    wrapped = np.mod(motor, 2.0 * pi)
    file = record(tmp_path, {"time_s": TIME_S, "motor_angle_rad": wrapped, "torque_n_m": TORQUE})
    angle = jbf.read_run(file, rig).angle_rad
    assert angle is not None
    np.testing.assert_allclose(np.diff(angle), np.diff(ANGLE), atol=1e-12)


def test_of_two_columns_one_is_read_and_the_other_named(tmp_path: Path) -> None:
    rig = read_rig(section('motion = "rotary"\nfriction = "torque"\ngear_ratio = 10', tmp_path))
    columns = {
        "time_s": TIME_S,
        "angle_rad": ANGLE,
        "torque_n_m": TORQUE,
        "motor_torque_n_m": TORQUE,
    }
    run = jbf.read_run(record(tmp_path, columns), rig)
    np.testing.assert_array_equal(run.friction_n, TORQUE)
    assert [f.words for f in run.reading] == ["motor_torque_n_m is there, too; torque_n_m was read"]
    assert "motor_torque_n_m" in run.extra


ROTARY_TORQUE = 'motion = "rotary"\nfriction = "torque"\n'
LINEAR_FORCE = 'motion = "linear"\nfriction = "force"\n'
LINEAR_TORQUE = 'motion = "linear"\nfriction = "torque"\npitch_m = 0.01\n'
BAD_COLUMNS = [
    (ROTARY_TORQUE, "angle_rad,torque_n_m,friction_n", "column friction_n: does not go with"),
    (ROTARY_TORQUE, "angle_rad,torque_n_m,velocity_m_s", "give velocity_rad_s, or correct [drive]"),
    (ROTARY_TORQUE, "angle_rad,current_a", "column torque_n_m: is missing; add it; the header has"),
    (ROTARY_TORQUE, "angle_rad,torque_nm", 'did you mean "torque_nm"? rename it to torque_n_m'),
    (CURRENT, "angle_rad,torque_n_m", "column current_a: is missing"),
    (CURRENT, "current_a,temperature_c", "column velocity_rad_s: is missing"),
    (LINEAR_FORCE, "angle_rad,friction_n", "rename it to motor_angle_rad, else drop it"),
    (LINEAR_FORCE, "motor_speed_rpm,friction_n", "give [drive] its pitch_m"),
    (LINEAR_TORQUE, "position_m,torque_n_m", "column torque_n_m: does not go with"),
    (LINEAR_TORQUE, "position_m,torque_n_m", "rename it to motor_torque_n_m if it is the motor's"),
]


@pytest.mark.parametrize(("keys", "header", "words"), BAD_COLUMNS)
def test_a_bad_column_is_one_line(
    keys: str, header: str, words: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = section(keys, tmp_path)
    columns = dict.fromkeys(header.split(","), TORQUE)
    run = record(tmp_path, {"time_s": TIME_S} | columns)
    arguments = ["diagnose", str(path), str(run), "--law", "coulomb"]
    assert main(arguments) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert said.startswith(f"jbf: {run}, row 1, column ")
    assert words in said


def test_a_bad_cell_of_a_drive_is_named(tmp_path: Path) -> None:
    rig = read_rig(section(CURRENT, tmp_path))
    file = record(tmp_path, {"time_s": TIME_S, "angle_rad": ANGLE, "current_a": TORQUE})
    lines = file.read_text().splitlines()
    lines[7] = lines[7].rpartition(",")[0] + ",oops"
    file.write_text("\n".join(lines))
    with pytest.raises(InputError, match='row 8, column current_a: "oops" is not a number') as e:
        jbf.read_run(file, rig)
    one_line(e)


def test_a_run_belongs_to_its_kind_of_rig(tmp_path: Path) -> None:
    rotary = Rig(drive=Drive("rotary", "torque"))
    file = record(tmp_path, {"time_s": TIME_S, "angle_rad": ANGLE, "torque_n_m": TORQUE})
    run = jbf.read_run(file, rotary)
    for other in (Rig(), Rig(drive=Drive("linear", "force"))):
        with pytest.raises(InputError, match="was read for a rotary drive, and this rig is none"):
            jbf.fit(other, [run], law="coulomb")
    plain = tmp_path / "b.csv"
    jbf.Run.from_arrays(TIME_S, SPEED, TORQUE, angle_rad=ANGLE).write_csv(plain)
    with pytest.raises(InputError, match="was read without the rig") as caught:
        jbf.compare(jbf.Model(rotary, law="coulomb"), [jbf.read_run(plain)])
    one_line(caught)


@pytest.mark.parametrize("wrong", ["rig.toml", Path("rig.toml"), 3])
def test_what_is_no_rig_is_one_line(wrong: object, tmp_path: Path) -> None:
    file = record(tmp_path, {"time_s": TIME_S, "angle_rad": ANGLE, "torque_n_m": TORQUE})
    for read in (jbf.read_run, jbf.read_runs):
        with pytest.raises(InputError, match="the rig is ") as caught:
            read(file, wrong)
        one_line(caught)


def test_a_drive_column_without_a_rig_says_what_is_needed(tmp_path: Path) -> None:
    file = record(tmp_path, {"time_s": TIME_S, "position_m": ANGLE, "current_a": TORQUE})
    with pytest.raises(InputError, match=r"a rig with \[drive\] tells what current_a is") as caught:
        jbf.read_run(file)
    one_line(caught)


def test_a_written_run_reads_back(tmp_path: Path) -> None:
    rig = Rig(drive=Drive("rotary", "torque"))
    columns = {"time_s": TIME_S, "angle_rad": ANGLE, "velocity_rad_s": SPEED, "torque_n_m": TORQUE}
    run = jbf.read_run(record(tmp_path, columns), rig)
    run.write_csv(tmp_path / "b.csv")
    assert set((tmp_path / "b.csv").read_text().split("\n")[0].split(",")) == set(columns)
    again = jbf.read_run(tmp_path / "b.csv", rig)
    for name, values in run.columns().items():
        np.testing.assert_array_equal(again.columns()[name], values)
