"""Drives: constants, columns, conversion of motor quantities, and files of drives."""

import re
from math import pi
from pathlib import Path
from typing import Any

import jbf
import numpy as np
import pytest
from input_errors import input_error
from jbf import Rig
from jbf.records.drive import Drive
from jbf.records.drive_columns import RPM, DriveColumns
from jbf.records.motion.position import Position
from jbf.records.motion.units import wrong_unit

TORQUE = Drive("rotary", "torque", gear_ratio=20.0)
CURRENT = Drive("rotary", "current", torque_constant_n_m_a=0.5, gear_ratio=8.0)
PERCENT = Drive("rotary", "percent", rated_torque_n_m=20.0, gear_ratio=2.0)
SLIDE = Drive("linear", "force")
SCREW = Drive("linear", "torque", pitch_m=0.02, gear_ratio=3.0)
LINEAR_MOTOR = Drive("linear", "current", force_constant_n_a=60.0)
RATED = Drive("linear", "percent", rated_force_n=250.0)
SERVO = Drive("linear", "percent", rated_torque_n_m=1.5, pitch_m=0.01, gear_ratio=2.0)
MOTION_OF_A_SLIDE = ("velocity_m_s", "friction_n")
BOTH = {"force_constant_n_a": 1.0, "torque_constant_n_m_a": 1.0}
TIME_S = 0.01 * np.arange(200)
ANGLE = 1.5 * np.sin(TIME_S)
SPEED = 1.5 * np.cos(TIME_S)
TORQUE_N_M = 3.0 * np.sign(SPEED) + 0.7 * SPEED
PAGE = Path(__file__).resolve().parents[3] / "docs" / "drives.md"


@pytest.mark.parametrize(
    ("drive", "column", "motor_rad", "unit"),
    [
        (CURRENT, "current_a", 8.0, 0.5 * 8.0),
        (PERCENT, "torque_percent", 2.0, 20.0 / 100.0 * 2.0),
        (LINEAR_MOTOR, "current_a", None, 60.0),
        (RATED, "force_percent", None, 250.0 / 100.0),
        (SERVO, "torque_percent", 2 * 2 * pi / 0.01, 1.5 / 100.0 * 2 * 2 * pi / 0.01),
    ],
)
def test_force_per_ampere_or_percent_of_a_drive_includes_gear_and_screw(
    drive: Drive, column: str, motor_rad: float | None, unit: float
) -> None:
    # An ideal transmission preserves the power of the motor at the joint or slide.
    assert drive.motor_rad == (None if motor_rad is None else pytest.approx(motor_rad))
    assert drive.unit_n == pytest.approx(unit)
    columns = DriveColumns.of(drive)
    assert columns.friction == pytest.approx({column: unit})
    columns.refuse_foreign_columns(Path("a.csv"), 1, [*columns.known, "own"])


def test_units_and_sensor_name_of_a_drive_are_determined_by_motion_and_source() -> None:
    assert [drive.quantities.force for drive in (TORQUE, CURRENT, SLIDE)] == ["N m", "N m", "N"]
    assert "torque sensor" in TORQUE.quantities.sensor
    assert "current sensor" in LINEAR_MOTOR.quantities.sensor


@pytest.mark.parametrize(
    ("motion", "friction", "constants", "key"),
    [
        ("spinning", "torque", {}, "motion"),
        (3, "torque", {}, "motion"),
        ("rotary", "force", {}, "friction"),
        ("rotary", "current", {}, "torque_constant_n_m_a"),
        ("rotary", "torque", {"torque_constant_n_m_a": 1.0}, "torque_constant_n_m_a"),
        ("linear", "current", BOTH, "force_constant_n_a or torque_constant_n_m_a"),
        ("linear", "percent", {}, "rated_force_n or rated_torque_n_m"),
        ("rotary", "torque", {"gear_ratio": 0.0}, "gear_ratio"),
        ("rotary", "torque", {"gear_ratio": "1:50"}, "gear_ratio"),
        ("rotary", "torque", {"mass_kg": 1.0}, "mass_kg"),
        ("rotary", "torque", {"pitch_m": 1.0}, "pitch_m"),
        ("linear", "force", {"inertia_kg_m2": 1.0}, "inertia_kg_m2"),
        ("linear", "torque", {}, "pitch_m"),
        ("linear", "force", {"gear_ratio": 2.0}, "pitch_m"),
        ("linear", "current", {"torque_constant_n_m_a": 1.0}, "pitch_m"),
        ("linear", "percent", {"rated_torque_n_m": 1.0}, "pitch_m"),
    ],
)
def test_inconsistent_drive_definition_is_reported_with_the_invalid_key(
    motion: Any, friction: str, constants: Any, key: str
) -> None:
    section = {"motion": motion, "friction": friction} | constants
    assert input_error(Drive, **section).key == key
    assert input_error(Drive.from_mapping, section, "rig.drive").key == f"rig.drive.{key}"


def test_drive_is_read_from_a_toml_section_and_invalid_keys_are_reported() -> None:
    section: Any = {"motion": "linear", "friction": "force", "mass_kg": 3}
    assert Drive.from_mapping(section, "drive") == Drive("linear", "force", mass_kg=3.0)
    for wrong, key in ((3, "drive"), ({"motion": "linear"}, "drive.friction")):
        assert input_error(Drive.from_mapping, wrong, "drive").key == key
    assert input_error(Drive.from_mapping, {"motin": "linear"}, "drive").key == "drive.motin"


def test_conversion_factors_of_motor_columns_are_computed_from_gear_and_screw() -> None:
    joint, slide = DriveColumns.of(TORQUE), DriveColumns.of(SCREW)
    screw = 1.0 / (3.0 * 2.0 * pi / 0.02)
    assert joint.friction == {"torque_n_m": 1.0, "motor_torque_n_m": 20.0}
    assert joint.place == pytest.approx({"angle_rad": 1.0, "motor_angle_rad": 0.05})
    rpm = 2.0 * pi / 60.0
    speeds = {"velocity_rad_s": 1.0, "speed_rpm": rpm}
    speeds |= {"motor_velocity_rad_s": 0.05, "motor_speed_rpm": 0.05 * rpm}
    assert list(joint.speed) == list(speeds)
    assert joint.speed == pytest.approx(speeds)
    assert slide.friction == pytest.approx({"motor_torque_n_m": 1.0 / screw})
    assert slide.place == pytest.approx({"position_m": 1.0, "motor_angle_rad": screw})
    assert list(slide.speed.values()) == pytest.approx([1.0, screw, rpm * screw])


def test_drive_requires_time_and_one_of_its_motion_and_friction_columns() -> None:
    columns = DriveColumns.of(TORQUE)
    assert columns.required([], True) == ["time_s", "velocity_rad_s", "torque_n_m"]
    header = ["motor_torque_n_m", "motor_angle_rad"]
    assert columns.required(header, True) == ["time_s", "motor_angle_rad", "motor_torque_n_m"]
    assert columns.required(["angle_rad", "speed_rpm"], False) == ["time_s", "speed_rpm"]


@pytest.mark.parametrize("name", ["friction_n", "force_n"])
def test_force_of_a_slide_is_read_under_either_name(tmp_path: Path, name: str) -> None:
    rows = [f"{0.01 * k:.2f},{0.001 * k:.3f},{5.0 + k}" for k in range(20)]
    (tmp_path / "run.csv").write_text("\n".join([f"time_s,position_m,{name}", *rows]))
    run = jbf.read_run(tmp_path / "run.csv", Rig(drive=Drive("linear", "force")))
    assert run.friction is not None
    np.testing.assert_array_equal(run.friction, 5.0 + np.arange(20.0))


@pytest.mark.parametrize(
    ("drive", "name", "hint"),
    [
        (TORQUE, "friction_n", "torque_n_m"),
        (CURRENT, "friction_n", "current_a"),
        (TORQUE, "velocity_m_s", "velocity_rad_s"),
        (TORQUE, "position_m", "angle_rad"),
        (SLIDE, "angle_rad", "motor_angle_rad"),
        (SLIDE, "velocity_rad_s", "motor_velocity_rad_s"),
        (SLIDE, "speed_rpm", "motor_speed_rpm"),
        (SLIDE, "motor_angle_rad", "pitch_m"),
        (SLIDE, "motor_velocity_rad_s", "pitch_m"),
        (SLIDE, "motor_speed_rpm", "pitch_m"),
        (SCREW, "torque_n_m", "motor_torque_n_m"),
    ],
)
def test_unsuitable_drive_column_is_rejected_with_hint(drive: Drive, name: str, hint: str) -> None:
    columns = DriveColumns.of(drive)
    error = input_error(columns.refuse_foreign_columns, Path("a.csv"), 3, ["time_s", name])
    assert (error.file, error.row, error.column) == ("a.csv", 3, name)
    assert hint in str(error.remedy)


def test_motor_columns_are_converted_to_the_output_side_and_reported() -> None:
    angle, torque = np.linspace(0.0, 3.0, 20), np.arange(20.0)
    columns = {"time_s": torque, "motor_angle_rad": angle, "motor_torque_n_m": torque}
    columns |= {"speed_rpm": np.full(20, 60.0), "own": torque}
    converted, findings = DriveColumns.of(TORQUE).converted("a", columns)
    assert set(converted) == {"time_s", "own", "friction_n", "velocity_m_s", "angle_rad"}
    np.testing.assert_allclose(converted["friction_n"], 20.0 * torque)
    np.testing.assert_allclose(converted["velocity_m_s"], 2.0 * pi)
    np.testing.assert_allclose(converted["angle_rad"], angle / 20.0)
    assert [(f.kind, f.channel, f.size, f.unit) for f in findings] == [
        ("converted", "friction_n", pytest.approx(20.0), "N m"),
        ("converted", "velocity_m_s", pytest.approx(RPM), "rad/s"),
        ("converted", "angle_rad", pytest.approx(0.05), "rad"),
    ]


def test_motor_column_without_a_gear_ratio_is_reported_with_the_ratio_of_one() -> None:
    columns = {"time_s": TIME_S, "motor_angle_rad": ANGLE, "torque_n_m": TORQUE_N_M}
    converted, (finding,) = DriveColumns.of(Drive("rotary", "torque")).converted("a", columns)
    np.testing.assert_array_equal(converted["angle_rad"], ANGLE)
    assert (finding.kind, finding.channel, finding.size) == ("converted", "angle_rad", 1.0)
    assert "gear_ratio = 1" in finding.words


def test_angle_faster_than_the_speed_by_the_gear_ratio_is_reported_with_a_hint() -> None:
    position = Position(20.0 * ANGLE, "angle_rad", "rad", 1.0)
    mismatch = wrong_unit("a", TIME_S, position, SPEED, Rig(drive=TORQUE).quantities)
    assert mismatch is not None
    assert mismatch.factor == pytest.approx(20.0, rel=1e-3)
    assert "gear_ratio" in mismatch.finding.words


@pytest.mark.parametrize(
    ("name", "column", "drive"),
    [
        ("angle_deg", "angle_rad", TORQUE),
        ("motor_angle_rev", "angle_rad", TORQUE),
        ("position_mm", "position_m", SLIDE),
        ("temperature_K", "temperature_c", SLIDE),
        ("weight_angle_deg", "weight_angle_rad", TORQUE),
    ],
)
def test_unread_column_of_a_missing_quantity_is_reported(
    name: str, column: str, drive: Drive, tmp_path: Path
) -> None:
    """The column is kept; one of another quantity with the same unit is not reported."""
    speed, force = ("velocity_rad_s", "torque_n_m") if drive is TORQUE else MOTION_OF_A_SLIDE
    columns = {"time_s": TIME_S, speed: SPEED, force: TORQUE_N_M, name: ANGLE, "bolt_mm": ANGLE}
    run = jbf.read_run(record(tmp_path, columns), Rig(drive=drive))
    (finding,) = run.reading
    assert (finding.kind, finding.channel) == ("other_unit", column)
    assert name in finding.words
    np.testing.assert_array_equal(run.extra[name], ANGLE)


@pytest.mark.parametrize(("name", "unit"), [("speed_deg_s", "deg/s"), ("angle_deg", "deg")])
def test_missing_motion_is_reported_with_a_column_in_another_unit(
    name: str, unit: str, tmp_path: Path
) -> None:
    columns = {"time_s": TIME_S, name: SPEED, "torque_n_m": TORQUE_N_M}
    error = input_error(jbf.read_run, record(tmp_path, columns), Rig(drive=TORQUE))
    assert error.column == "velocity_rad_s"
    assert f"{name} is in {unit}" in str(error.remedy)


def test_second_friction_column_is_reported_and_kept_unconverted() -> None:
    one, other = np.arange(20.0), -np.arange(20.0)
    columns = {"time_s": one, "motor_torque_n_m": other, "torque_n_m": one, "angle_rad": one}
    converted, (finding,) = DriveColumns.of(TORQUE).converted("a", columns)
    assert converted["friction_n"] is one
    assert converted["motor_torque_n_m"] is other
    assert (finding.kind, finding.channel) == ("second_column", "friction_n")
    names = DriveColumns.of(TORQUE).called(columns)
    assert names == {"torque_n_m": "friction_n", "angle_rad": "angle_rad"}


def test_wrapped_motor_angle_is_unwrapped_before_division_by_the_gear_ratio() -> None:
    """An angle beyond one turn is not wrapped; an output angle remains unchanged."""
    unwrapped = 0.5 * np.arange(30.0)
    wrapped = np.mod(unwrapped, 2.0 * pi)
    columns = {"time_s": unwrapped, "torque_n_m": unwrapped}
    for name, given, expected in (
        ("motor_angle_rad", wrapped, unwrapped / 20.0),
        ("motor_angle_rad", 4.0 * np.arange(30.0), 0.2 * np.arange(30.0)),
        ("angle_rad", wrapped, wrapped),
    ):
        converted, _ = DriveColumns.of(TORQUE).converted("a", columns | {name: given})
        np.testing.assert_allclose(converted["angle_rad"], expected, atol=1e-12)


def record(folder: Path, columns: dict[str, Any]) -> Path:
    """A CSV file with these columns."""
    path = folder / "a.csv"
    rows = np.column_stack(list(columns.values()))
    np.savetxt(path, rows, fmt="%.17g", delimiter=",", header=",".join(columns), comments="")
    return path


@pytest.mark.parametrize(
    ("drive", "column", "factor"),
    [
        (TORQUE, "torque_n_m", 1.0),
        (TORQUE, "motor_torque_n_m", 20.0),
        (CURRENT, "current_a", 4.0),
        (PERCENT, "torque_percent", 0.4),
    ],
)
def test_friction_column_of_a_joint_is_converted_to_torque_at_the_joint(
    drive: Drive, column: str, factor: float, tmp_path: Path
) -> None:
    rig = Rig(drive=drive)
    columns = {"time_s": TIME_S, "angle_rad": ANGLE, column: TORQUE_N_M / factor}
    run: Any = jbf.read_run(record(tmp_path, columns), rig)
    np.testing.assert_allclose(run.friction, TORQUE_N_M, rtol=1e-12)
    assert run.quantities == rig.quantities
    sizes = [finding.size for finding in run.reading]
    assert sizes == ([] if factor == 1.0 else [pytest.approx(factor)])


def test_motor_columns_of_a_slide_are_converted_without_loss_of_power(tmp_path: Path) -> None:
    motor_rad_s = 40.0 * SPEED
    columns = {"time_s": TIME_S, "motor_angle_rad": 40.0 * ANGLE, "motor_torque_n_m": TORQUE_N_M}
    columns["motor_speed_rpm"] = motor_rad_s * 60.0 / (2.0 * pi)
    run: Any = jbf.read_run(record(tmp_path, columns), Rig(drive=SCREW))
    power = run.friction * run.velocity
    np.testing.assert_allclose(power, TORQUE_N_M * motor_rad_s, rtol=1e-9)
    np.testing.assert_allclose(run.position_m, 40.0 * ANGLE / (2.0 * pi) / 3.0 * 0.02)


def test_run_and_model_of_a_joint_are_unchanged_by_a_file_round_trip(tmp_path: Path) -> None:
    rig = Rig(drive=TORQUE)
    columns = {"time_s": TIME_S, "angle_rad": ANGLE, "torque_n_m": TORQUE_N_M}
    run = jbf.read_run(record(tmp_path, columns | {"velocity_rad_s": SPEED}), rig)
    run.write_csv(tmp_path / "b.csv")
    again = jbf.read_run(tmp_path / "b.csv", rig)
    assert again.to_csv() == run.to_csv()
    jbf.Model(rig, law="coulomb").save(tmp_path / "model.toml")
    assert jbf.Model.load(tmp_path / "model.toml").rig == rig


def test_motor_column_with_half_of_its_cells_empty_has_a_separate_clock(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    rows = [f"{t},{ANGLE[i]},{ANGLE[i] if i % 2 else ''}" for i, t in enumerate(TIME_S)]
    path.write_text("\n".join(["time_s,angle_rad,current_a", *rows]))
    run = jbf.read_run(path, Rig(drive=CURRENT))
    assert set(run.read) == {"friction_n"}
    assert run.read["friction_n"].tolist() == [i % 2 == 1 for i in range(200)]


@pytest.mark.parametrize(
    ("drive", "header", "column", "hint"),
    [
        (TORQUE, "angle_rad,current_a", "torque_n_m", "the header has"),
        (TORQUE, "angle_rad,torque_nm", "torque_n_m", "torque_nm"),
        (CURRENT, "current_a,temperature_c", "velocity_rad_s", "the header has"),
        (SCREW, "position_m,torque_n_m", "torque_n_m", "motor_torque_n_m"),
        (None, "position_m,current_a", "friction_n", "[drive]"),
    ],
)
def test_missing_or_unsuitable_column_of_a_drive_is_reported_with_a_hint(
    drive: Drive | None, header: str, column: str, hint: str, tmp_path: Path
) -> None:
    path = record(tmp_path, dict.fromkeys(f"time_s,{header}".split(","), TIME_S))
    error = input_error(jbf.read_run, path, Rig(drive=drive))
    assert (error.file, error.row, error.column) == (str(path), 1, column)
    assert hint in str(error.remedy)


def test_run_or_law_for_another_kind_of_rig_is_rejected(tmp_path: Path) -> None:
    joint = Rig(drive=TORQUE)
    path = record(tmp_path, {"time_s": TIME_S, "angle_rad": ANGLE, "torque_n_m": TORQUE_N_M})
    run = jbf.read_run(path, joint)
    for other in (Rig(), Rig(drive=SLIDE)):
        assert input_error(jbf.fit, other, [run], law="coulomb").file == str(path)
    assert "coulomb" in str(input_error(jbf.Model, joint).remedy)


def test_documentation_names_every_key_and_column_of_a_drive() -> None:
    text = PAGE.read_text(encoding="utf-8")
    names = set(Drive.__dataclass_fields__)
    for drive in (TORQUE, CURRENT, PERCENT, Drive("linear", "force", pitch_m=0.01), RATED):
        names |= set(DriveColumns.of(drive).known)
    assert {name for name in names if f"`{name}`" not in text} == set()


def documented_effects() -> set[str]:
    """Effects in the table of the documentation of drives."""
    section = PAGE.read_text(encoding="utf-8").partition("## What the effects are here")[2]
    rows = re.findall(r"^\| (`.*?) \|", section, flags=re.MULTILINE)
    return {name for row in rows for name in re.findall(r"`(\w+)`", row)}


def test_documentation_of_drives_names_only_effects_that_a_drive_can_have() -> None:
    named, known = documented_effects(), jbf.effects()
    assert named
    assert [name for name in named if "coulomb" in known[name].refused] == []


def test_documentation_of_drives_names_every_effect_that_a_bearing_cannot_have() -> None:
    bearing_refuses = {name for name, page in jbf.effects().items() if "journal" in page.refused}
    assert bearing_refuses <= documented_effects()
