"""A drive's constants and columns: what one unit is, which column is read, and each refusal."""

from __future__ import annotations

from math import pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from jbf import InputError, Rig, Run
from jbf.records.drive import Drive
from jbf.records.drive_columns import RPM, DriveColumns, _whole
from jbf.records.quantities import LINEAR, OF_BEARING, ROTARY
from jbf.records.recorded_load import recorded_load
from jbf.records.rig import Bearing, Load, Lubricant, read_rig

TORQUE = Drive("rotary", "torque", gear_ratio=20.0)
CURRENT = Drive("rotary", "current", torque_constant_n_m_a=0.5, gear_ratio=8.0)
PERCENT = Drive("rotary", "percent", rated_torque_n_m=20.0, gear_ratio=2.0)
SLIDE = Drive("linear", "force")
SCREW = Drive("linear", "torque", pitch_m=0.02, gear_ratio=3.0)
LINEAR_MOTOR = Drive("linear", "current", force_constant_n_a=60.0)
RATED = Drive("linear", "percent", rated_force_n=250.0)
SERVO = Drive("linear", "percent", rated_torque_n_m=1.5, pitch_m=0.01, gear_ratio=2.0)


def refusal(make: Any, *given: Any, **named: Any) -> str:
    """The one line of an error."""
    with pytest.raises(InputError) as caught:
        make(*given, **named)
    return str(caught.value)


@pytest.mark.parametrize(
    ("drive", "motor_rad", "unit_n"),
    [
        (CURRENT, 8.0, 4.0),
        (PERCENT, 2.0, 0.4),
        (LINEAR_MOTOR, None, 60.0),
        (RATED, None, 2.5),
        (SERVO, 2.0 * 2.0 * pi / 0.01, 0.015 * 2.0 * 2.0 * pi / 0.01),
    ],
)
def test_one_ampere_or_one_percent_is_so_much_where_the_drive_moves(
    drive: Drive, motor_rad: float | None, unit_n: float
) -> None:
    """Through gear and screw: power in is power out."""
    assert drive.motor_rad == (None if motor_rad is None else pytest.approx(motor_rad))
    assert drive.unit_n == pytest.approx(unit_n)
    assert SLIDE.motor_rad is None
    assert SCREW.motor_rad == pytest.approx(3.0 * 2.0 * pi / 0.02)


def test_what_a_drives_answers_are_in() -> None:
    """Its units, and what reads its friction."""
    assert CURRENT.quantities == ROTARY.read_by("the current sensor")
    assert SLIDE.quantities.force == "N"
    assert SLIDE.quantities.sensor == "the force sensor"
    assert TORQUE.quantities.sensor == "the torque sensor"
    assert LINEAR_MOTOR.quantities.motion == "linear"
    assert ROTARY.to_dict() == {"force": "N m", "velocity": "rad/s", "length": "rad"}
    assert [ROTARY.unit(si) for si in ("N s/m", "kg", "m", "s")] == [
        "N m s/rad", "kg m^2", "rad", "s"
    ]  # fmt: skip
    assert LINEAR.unit("N m/rad") == "N/m"
    assert OF_BEARING.unit("N m/rad") == "N m/rad"


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (("spinning", "torque"), 'key motion: "spinning" is no motion; '),
        ((3, "torque"), "key motion: a int is no motion"),
        (("rotary", "force"), 'key friction: "force" is no friction of a rotary drive; known: '
         "torque, current, percent"),
        (("rotary", "torque", 1.0), "key torque_constant_n_m_a: is not used where a rotary drive "
         'has friction = "torque"; drop it, or correct friction'),
        (("rotary", "current"), "key torque_constant_n_m_a: is missing; "
         'friction = "current" needs it'),
        (("linear", "current", 1.0, 2.0), "key force_constant_n_a or torque_constant_n_m_a: both "
         "stand there; keep one of them"),
        (("linear", "percent"), "key rated_force_n or rated_torque_n_m: is missing"),
    ],
)  # fmt: skip
def test_a_drive_that_is_none(given: tuple[Any, ...], said: str) -> None:
    """Its words, and the constants that go with them."""
    assert refusal(Drive, *given).startswith(said)


def test_sizes_of_a_drive_are_those_of_its_kind() -> None:
    """Above zero; a turn's way wherever a motor turns a slide."""
    assert refusal(Drive, "rotary", "torque", gear_ratio=0.0).startswith(
        "key gear_ratio: 0.0 is not above zero"
    )
    assert Drive("rotary", "torque", gear_ratio=3).gear_ratio == 3.0
    for name in ("mass_kg", "pitch_m"):
        assert refusal(Drive, "rotary", "torque", **{name: 1.0}) == (
            f"key {name}: means nothing of a rotary drive; drop it"
        )
    assert refusal(Drive, "linear", "force", inertia_kg_m2=1.0) == (
        "key inertia_kg_m2: means nothing of a linear drive; drop it"
    )
    needs = ("key pitch_m: is missing, and turns a motor's torque into a force; "
             "write how far the drive moves in one turn of its screw, m")  # fmt: skip
    assert refusal(Drive, "linear", "torque") == needs
    assert refusal(Drive, "linear", "force", gear_ratio=2.0) == needs
    assert refusal(Drive, "linear", "current", torque_constant_n_m_a=1.0) == needs
    assert refusal(Drive, "linear", "percent", rated_torque_n_m=1.0) == needs
    assert Drive("linear", "force", pitch_m=0.1, gear_ratio=2.0).motor_rad is not None


def test_a_drive_from_its_section() -> None:
    """Each refusal names the key behind the section's name."""
    made = Drive.from_mapping({"motion": "linear", "friction": "force", "mass_kg": 3}, "drive")
    assert made == Drive("linear", "force", mass_kg=3.0)
    assert refusal(Drive.from_mapping, {"motion": "linear"}, "rig.drive") == (
        "key rig.drive.friction: is missing; add it to [rig.drive]"
    )
    assert refusal(Drive.from_mapping, {"motin": "linear"}, "drive").startswith(
        "key drive.motin: is not known; did you mean"
    )
    assert refusal(Drive.from_mapping, {"motion": "rotary", "friction": "current"}, "d").startswith(
        "key d.torque_constant_n_m_a: is missing"
    )
    assert refusal(Drive.from_mapping, 3, "drive") == (
        "key drive: is not a table; write it as [drive] with keys"
    )


@pytest.mark.parametrize(
    ("drive", "friction", "speed", "place"),
    [
        (TORQUE, {"torque_n_m": 1.0, "motor_torque_n_m": 20.0},
         {"velocity_rad_s": 1.0, "speed_rpm": RPM, "motor_velocity_rad_s": 0.05,
          "motor_speed_rpm": RPM / 20.0}, {"angle_rad": 1.0, "motor_angle_rad": 0.05}),
        (CURRENT, {"current_a": 4.0}, None, None),
        (PERCENT, {"torque_percent": 0.4}, None, None),
        (SLIDE, {"friction_n": 1.0}, {"velocity_m_s": 1.0}, {"position_m": 1.0}),
        (SCREW, {"motor_torque_n_m": 300.0 * pi},
         {"velocity_m_s": 1.0, "motor_velocity_rad_s": 1.0 / (300.0 * pi),
          "motor_speed_rpm": RPM / (300.0 * pi)},
         {"position_m": 1.0, "motor_angle_rad": 1.0 / (300.0 * pi)}),
        (RATED, {"force_percent": 2.5}, {"velocity_m_s": 1.0}, {"position_m": 1.0}),
        (SERVO, {"torque_percent": 6.0 * pi}, None, None),
    ],
)  # fmt: skip
def test_columns_of_a_drive_and_what_one_unit_of_each_is(
    drive: Drive, friction: dict[str, float], speed: Any, place: Any
) -> None:
    """In the order in which they are looked for."""
    columns = DriveColumns.of(drive)
    for found, wanted in (
        (columns.friction, friction), (columns.speed, speed), (columns.place, place)
    ):  # fmt: skip
        if wanted is not None:
            assert list(found) == list(wanted)
            assert found == pytest.approx(wanted)
    assert columns.known == (
        "time_s", "load_n", "temperature_c",
        *columns.friction, *columns.speed, *columns.place,
    )  # fmt: skip
    assert pytest.approx(2.0 * pi / 60.0) == RPM


def test_a_time_a_motion_and_a_friction_must_be_there() -> None:
    """Of each the one in the header, or else the first."""
    columns = DriveColumns.of(TORQUE)
    assert columns.required([], True) == ["time_s", "velocity_rad_s", "torque_n_m"]
    assert columns.required(["motor_torque_n_m", "motor_angle_rad"], True) == [
        "time_s", "motor_angle_rad", "motor_torque_n_m"
    ]  # fmt: skip
    assert columns.required(["angle_rad", "speed_rpm"], False) == ["time_s", "speed_rpm"]


@pytest.mark.parametrize(
    ("drive", "name", "mend"),
    [
        (TORQUE, "friction_n", "keep torque_n_m and drop it, or correct [drive]"),
        (CURRENT, "friction_n", "keep current_a and drop it, or correct [drive]"),
        (TORQUE, "velocity_m_s", "give velocity_rad_s, or correct [drive]"),
        (TORQUE, "position_m", "give angle_rad, or correct [drive]"),
        (SLIDE, "angle_rad", "is it the motor's? then rename it to motor_angle_rad, else drop it"),
        (SLIDE, "velocity_rad_s",
         "is it the motor's? then rename it to motor_velocity_rad_s, else drop it"),
        (SLIDE, "speed_rpm", "is it the motor's? then rename it to motor_speed_rpm, else drop it"),
        (SLIDE, "motor_angle_rad",
         "give [drive] its pitch_m (way for one turn), or rename the column"),
        (SLIDE, "motor_velocity_rad_s",
         "give [drive] its pitch_m (way for one turn), or rename the column"),
        (SLIDE, "motor_speed_rpm",
         "give [drive] its pitch_m (way for one turn), or rename the column"),
        (SCREW, "torque_n_m", "rename it to motor_torque_n_m if it is the motor's"),
    ],
)  # fmt: skip
def test_a_column_of_another_machine_is_refused(drive: Drive, name: str, mend: str) -> None:
    """With what the rig says, and what to do."""
    section = f'does not go with the rig: the rig\'s [drive] has motion = "{drive.motion}"'
    if name in ("friction_n", "velocity_m_s", "position_m"):
        section += f', friction = "{drive.friction}"'
    found = refusal(DriveColumns.of(drive).refuse_strangers, Path("a.csv"), 3, ["time_s", name])
    assert found == f"a.csv, row 3, column {name}: {section}; {mend}"


def test_a_column_of_ones_own_is_none_of_another_machine() -> None:
    """Nor are those that the drive has."""
    for drive in (TORQUE, CURRENT, SLIDE, SCREW, RATED):
        columns = DriveColumns.of(drive)
        columns.refuse_strangers(Path("a.csv"), 1, [*columns.known, "own"])
    DriveColumns.of(RATED).refuse_strangers(Path("a.csv"), 1, ["torque_n_m"])


def test_columns_are_converted_and_told() -> None:
    """Once, by the size of one unit; what is in the right unit is the same array."""
    angle, torque = np.linspace(0.0, 3.0, 20), np.arange(20.0)
    columns = {"time_s": np.arange(20.0), "motor_angle_rad": angle, "motor_torque_n_m": torque,
               "speed_rpm": np.full(20, 60.0), "own": torque}  # fmt: skip
    kept, found = DriveColumns.of(TORQUE).converted("a", columns)
    assert set(kept) == {"time_s", "own", "friction_n", "velocity_m_s", "angle_rad"}
    np.testing.assert_allclose(kept["friction_n"], 20.0 * torque)
    np.testing.assert_allclose(kept["velocity_m_s"], 2.0 * pi)
    np.testing.assert_allclose(kept["angle_rad"], angle / 20.0)
    assert [f.words for f in found] == [
        "motor_torque_n_m was read as N m: 1 N m is 20 N m where the drive moves",
        "speed_rpm was read as rad/s: 1 turn a minute is 0.10472 rad/s where the drive moves",
        "motor_angle_rad was read as rad: 1 rad is 0.05 rad where the drive moves",
    ]
    assert [(f.kind, f.channel, f.run, f.unit) for f in found] == [
        ("converted", "friction_n", "a", "N m"),
        ("converted", "velocity_m_s", "a", "rad/s"),
        ("converted", "angle_rad", "a", "rad"),
    ]
    assert [f.size for f in found] == pytest.approx([20.0, RPM, 0.05])
    assert {f.done for f in found} == {"once, on reading"}
    assert DriveColumns.of(TORQUE).called(columns) == {
        "motor_torque_n_m": "friction_n",
        "speed_rpm": "velocity_m_s",
        "motor_angle_rad": "angle_rad",
    }
    plain = {"time_s": torque, "torque_n_m": torque, "angle_rad": angle}
    kept, found = DriveColumns.of(TORQUE).converted("a", plain)
    assert found == ()
    assert kept["friction_n"] is torque
    assert kept["angle_rad"] is angle


def test_of_several_columns_the_first_is_read_and_the_others_are_kept() -> None:
    """And named."""
    one, other = np.arange(20.0), -np.arange(20.0)
    columns = {"time_s": one, "motor_torque_n_m": other, "torque_n_m": one, "angle_rad": one}
    kept, (found,) = DriveColumns.of(TORQUE).converted("a", columns)
    assert kept["friction_n"] is one
    assert kept["motor_torque_n_m"] is other
    assert found.words == "motor_torque_n_m is there, too; torque_n_m was read"
    assert (found.kind, found.channel, found.run) == ("second_column", "friction_n", "a")
    assert (found.size, found.unit, found.done) == (0.0, "1", "kept, not used")
    assert DriveColumns.of(TORQUE).called(columns) == {
        "torque_n_m": "friction_n", "angle_rad": "angle_rad"
    }  # fmt: skip


@pytest.mark.parametrize(
    ("unit", "drive", "column"),
    [("1 A", CURRENT, "current_a"), ("1 %", PERCENT, "torque_percent"),
     ("1 %", RATED, "force_percent"), ("1 N m", SCREW, "motor_torque_n_m")],
)  # fmt: skip
def test_one_unit_of_a_column_by_its_name(unit: str, drive: Drive, column: str) -> None:
    """As the finding of its conversion has it."""
    columns = {"time_s": np.arange(3.0), column: np.ones(3)}
    _, (found,) = DriveColumns.of(drive).converted("a", columns)
    assert f": {unit} is {found.size:.5g} {found.unit} where" in found.words


def test_an_angle_that_starts_again_is_made_whole() -> None:
    """One of many turns stays; only one that goes through a gear is asked."""
    whole = 0.5 * np.arange(30.0)
    np.testing.assert_allclose(_whole(np.mod(whole, 2.0 * pi)), whole)
    jumps = np.array([0.0, 4.0, 8.0])
    assert _whole(jumps) is jumps
    np.testing.assert_allclose(_whole(np.array([0.0, 2.0 * pi])), [0.0, 0.0], atol=1e-12)
    wrapped = np.mod(whole, 2.0 * pi)
    columns = {"time_s": whole, "torque_n_m": whole}
    kept, _ = DriveColumns.of(TORQUE).converted("a", columns | {"motor_angle_rad": wrapped})
    np.testing.assert_allclose(kept["angle_rad"], whole / 20.0)
    kept, _ = DriveColumns.of(TORQUE).converted("a", columns | {"angle_rad": wrapped})
    assert kept["angle_rad"] is wrapped
    fast = np.mod(3.5 * np.arange(30.0), 2.0 * pi)
    kept, _ = DriveColumns.of(TORQUE).converted("a", columns | {"speed_rpm": fast})
    np.testing.assert_allclose(kept["velocity_m_s"], RPM * fast)


BEARING = {"radius_m": 0.01, "length_m": 0.02, "clearance_m": 1e-5, "mass_kg": 2.0, "count": 4}


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"clearance_m": 0.01}, "key clearance_m: 0.01 m is not below the radius of 0.01 m"),
        ({"count": 0}, "key count: 0 is not a whole number of at least 1; write how many bearings"),
        ({"count": 1001}, "key count: 1001 bearings are more than a shaft has; write 1000 or less"),
        ({"count": True}, "key count: True is not a whole number of at least 1"),
        ({"mass_kg": 0.0}, "key mass_kg: 0.0 is not above zero"),
        ({"length_m": -1.0}, "key length_m: -1.0 is not above zero"),
        ({"radius_m": "a"}, 'key radius_m: "a" is not a number'),
    ],
)
def test_a_bearing_that_is_none(change: dict[str, Any], said: str) -> None:
    """And the ends of what is one."""
    assert refusal(Bearing, **{**BEARING, **change}).startswith(said)
    for good in ({"count": 1}, {"count": 1000}, {"clearance_m": 0.00999}):
        assert Bearing(**{**BEARING, **good}).radius_m == 0.01  # type: ignore[arg-type]


def test_a_lubricants_temperature_is_one() -> None:
    """From 100 below zero to 1000 degrees; none is none."""
    assert Lubricant(0.1).temperature_c is None
    for celsius in (-100, 0, 1000):
        found = Lubricant(0.1, celsius).temperature_c
        assert (found, type(found)) == (celsius, float)
    for wrong in (-100.1, 1000.1, float("nan")):
        assert refusal(Lubricant, 0.1, wrong) == (
            f"key temperature_c: {wrong} is not from -100 to 1000; give it in degrees Celsius"
        )
    assert refusal(Lubricant, 0.1, "warm").startswith('key temperature_c: "warm" is not a number')


def test_a_rig_has_sections_of_its_own_kinds(tmp_path: Path) -> None:
    """A radius is the journal's, or one of a rotary drive; what is None is not written."""
    said = "of dict; give jbf.Load(...), or read a file: jbf.read_rig(PATH)"
    assert refusal(Rig, load={"normal_n": 1.0}) == f"key load: the load is no jbf.Load but {said}"
    assert [Rig(drive=d).radius_m for d in (TORQUE, SLIDE)] == [1.0, None]
    assert Rig.thesis().radius_m == 0.0127
    assert Rig().radius_m is None
    assert (Rig().quantities, Rig.thesis().quantities) == (LINEAR, OF_BEARING)
    rig = Rig(lubricant=Lubricant(0.1), load=Load(5.0), drive=SLIDE)
    assert rig.to_mapping() == {
        "lubricant": {"viscosity_pa_s": 0.1},
        "load": {"normal_n": 5.0},
        "drive": {"motion": "linear", "friction": "force", "gear_ratio": 1.0},
    }
    rig.write(tmp_path / "rig.toml")
    assert read_rig(tmp_path / "rig.toml") == rig
    loads = [Rig.thesis(table).load for table in ("4.2", "4.3", "4.4", "4.5")]
    assert loads == [Load(104.0), Load(83.5), Load(104.0), Load(83.5)]
    assert refusal(Rig.thesis, "5.1") == (
        '"5.1" is no parameter table of the thesis; choose from 4.2, 4.3, 4.4, 4.5'
    )


def test_a_pressure_stands_for_a_load_where_there_is_no_bearing() -> None:
    """In bar; a load that was recorded comes first."""
    time = np.arange(12.0)
    bare = Run.from_arrays(time, np.ones(12))
    pressed = Run.from_arrays(time, np.ones(12), extra={"pressure_pa": np.full(12, 3e5)})
    loaded = Run.from_arrays(time, np.ones(12), load_n=np.full(12, 7.0),
                             extra={"pressure_pa": np.full(12, 3e5)})  # fmt: skip
    assert recorded_load(Rig(), bare) is None
    np.testing.assert_allclose(recorded_load(Rig(), pressed), 3.0)  # type: ignore[arg-type]
    assert recorded_load(Rig.thesis(), pressed) is None
    assert recorded_load(Rig(), loaded) is loaded.load_n
