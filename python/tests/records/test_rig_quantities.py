"""Quantities with a unit in rig files: converted to the unit of their key, or refused."""

import re
from dataclasses import fields
from pathlib import Path

import jbf
import pytest
from input_errors import input_error
from jbf.records.drive import Drive
from jbf.records.rig import Bearing, Load, Lubricant, Rig, read_rig
from jbf.units.unit import unit_of_name

BEARING = """\
[bearing]
radius_m = "12.7 mm"
length_m = "0.75 in"
clearance_m = "50.8 µm"
mass_kg = "2270 g"
count = 4
[lubricant]
viscosity_pa_s = "2 mPa s"
temperature_c = "104 °F"
[load]
normal_n = "0.104 kN"
"""
SCREW = """\
[drive]
motion = "linear"
friction = "percent"
rated_torque_n_m = "1.27 N m"
pitch_m = "10 mm"
gear_ratio = 2
mass_kg = 30
"""
JOINT = """\
[drive]
motion = "rotary"
friction = "current"
torque_constant_n_m_a = "80 mNm/A"
inertia_kg_m2 = "3.2 kg cm^2"
"""
LINEAR_MOTOR = """\
[drive]
motion = "linear"
friction = "current"
force_constant_n_a = "0.06 kN/A"
"""


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "rig.toml"


def rig_of(path: Path, text: str) -> Rig:
    path.write_text(text, encoding="utf-8")
    return read_rig(path)


def test_quantities_of_a_bearing_are_converted_to_the_units_of_their_keys(path: Path) -> None:
    rig = rig_of(path, BEARING)
    wanted = Rig(
        Bearing(0.0127, 0.01905, 5.08e-5, 2.27, 4), Lubricant(0.002, 40.0), Load(104.0)
    ).to_mapping()
    assert {name: pytest.approx(part, rel=1e-14) for name, part in wanted.items()} == (
        rig.to_mapping()
    )


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        (SCREW, {"rated_torque_n_m": 1.27, "pitch_m": 0.01, "gear_ratio": 2.0, "mass_kg": 30.0}),
        (JOINT, {"torque_constant_n_m_a": 0.08, "inertia_kg_m2": 3.2e-4}),
        (LINEAR_MOTOR, {"force_constant_n_a": 60.0}),
    ],
)
def test_quantities_of_a_drive_are_converted_to_the_units_of_their_keys(
    text: str, wanted: dict[str, float], path: Path
) -> None:
    drive = rig_of(path, text).drive
    assert {key: getattr(drive, key) for key in wanted} == pytest.approx(wanted, rel=1e-14)


@pytest.mark.parametrize(
    ("text", "key", "value", "meant"),
    [
        (SCREW, "pitch_m", "10", '"10 mm"'),
        (SCREW, "pitch_m", '"10 m"', '"10 mm"'),
        (BEARING, "radius_m", "12.7", '"12.7 mm"'),
        (BEARING, "clearance_m", "0.006", '"0.006 mm"'),
        (BEARING, "viscosity_pa_s", "32", '"32 mPa s"'),
    ],
)
def test_size_in_a_wrong_unit_is_warned_of_with_the_likely_unit(
    text: str, key: str, value: str, meant: str, path: Path
) -> None:
    line = next(line for line in text.splitlines() if line.startswith(f"{key} "))
    with pytest.warns(UserWarning, match=re.escape(meant)) as caught:
        rig_of(path, text.replace(line, f"{key} = {value}"))
    assert len(caught) == 1
    assert f".{key}: " in str(caught[0].message)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("size", [{"pitch_m": 0.0005}, {"pitch_m": 0.6}, {"pitch_m": None}])
def test_size_of_a_usual_machine_is_accepted_without_a_warning(
    size: dict[str, float | None],
) -> None:
    assert Rig(drive=Drive("linear", "force", **size)).drive is not None
    assert Rig.thesis().bearing is not None


@pytest.mark.parametrize(("text", "number"), [("0.01", 0.01), (" 1e-2 ", 0.01), (".5", 0.5)])
def test_number_in_quotes_is_read_in_the_unit_of_its_key(
    text: str, number: float, path: Path
) -> None:
    drive = rig_of(path, SCREW.replace("10 mm", text)).drive
    assert drive is not None
    assert drive.pitch_m == number


def test_unit_of_every_number_of_a_rig_is_known_from_its_key() -> None:
    """New keys with a unit need no additional entry."""
    numbers = {f.name for kind in (Bearing, Lubricant, Load, Drive) for f in fields(kind)}
    numbers -= {"motion", "friction", "gear_ratio", "count"}
    units = {key: named[1].text for key in numbers if (named := unit_of_name(key)) is not None}
    assert units == {
        "radius_m": "m", "length_m": "m", "clearance_m": "m", "pitch_m": "m", "mass_kg": "kg",
        "viscosity_pa_s": "Pa s", "temperature_c": "°C", "normal_n": "N", "rated_force_n": "N",
        "rated_torque_n_m": "N m", "torque_constant_n_m_a": "N m/A", "force_constant_n_a": "N/A",
        "inertia_kg_m2": "kg m^2",
    }  # fmt: skip
    assert set(units) == numbers


@pytest.mark.parametrize(
    ("text", "old", "new", "key", "unit"),
    [
        (SCREW, "1.27 N m", "1.27 N", "drive.rated_torque_n_m", "N m"),
        (SCREW, "1.27 N m", "1.27 foo", "drive.rated_torque_n_m", "N m"),
        # The radians of a screw lead are significant: this lead is 10 mm, not 1.6 mm.
        (SCREW, "10 mm", "10 mm/rev", "drive.pitch_m", "m"),
        (SCREW, "10 mm", "10 kg", "drive.pitch_m", "m"),
        (JOINT, "80 mNm/A", "80 mNm", "drive.torque_constant_n_m_a", "N m/A"),
        (JOINT, "3.2 kg cm^2", "3.2 kg cm", "drive.inertia_kg_m2", "kg m^2"),
        (BEARING, "2 mPa s", "2 mPa", "lubricant.viscosity_pa_s", "Pa s"),
        (BEARING, "104 °F", "104 N", "lubricant.temperature_c", "°C"),
        (BEARING, "50.8 µm", "1,5 µm", "bearing.clearance_m", "m"),
    ],
)
def test_quantity_in_a_wrong_unit_is_refused_with_file_key_and_remedy(
    text: str, old: str, new: str, key: str, unit: str, path: Path
) -> None:
    error = input_error(rig_of, path, text.replace(old, new))
    assert (error.file, error.key) == (str(path), key)
    assert new in error.problem
    assert unit in str(error.remedy)


@pytest.mark.parametrize("value", ["mm", "ten mm", "", "nan", "1e999 mm"])
def test_text_without_a_number_is_refused_in_a_rig_file(value: str, path: Path) -> None:
    error = input_error(rig_of, path, SCREW.replace("10 mm", value))
    assert (error.file, error.key) == (str(path), "drive.pitch_m")


def test_quantity_out_of_range_is_refused_after_its_conversion(path: Path) -> None:
    error = input_error(rig_of, path, SCREW.replace("10 mm", "-10 mm"))
    assert error.key == "drive.pitch_m"
    assert "-0.01" in error.problem


def test_quantities_with_units_define_equal_rigs_in_a_rig_and_a_model_file(path: Path) -> None:
    rig = rig_of(path, JOINT)
    model = jbf.Model(rig, law="coulomb")
    model.save(path)
    text = path.read_text(encoding="utf-8")
    assert "torque_constant_n_m_a = 0.08" in text
    path.write_text(text.replace("torque_constant_n_m_a = 0.08", JOINT.splitlines()[3]))
    assert jbf.Model.load(path).rig == rig
