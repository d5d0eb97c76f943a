"""Rigs: sections, exact TOML round trips, and the position that each error names."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from input_errors import input_error
from jbf.records.drive import Drive
from jbf.records.quantities import BEARING, LINEAR
from jbf.records.rig import Bearing, Load, Lubricant, Rig, read_rig

THESIS = """\
[bearing]
radius_m = 0.0127
length_m = 0.01905
clearance_m = 5.08e-5
mass_kg = 2.27
count = 4          # bearings on the shaft
[lubricant]
viscosity_pa_s = 0.002
[load]
normal_n = 104.0
"""


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "rig.toml"


def test_thesis_rig_has_the_dimensions_and_loads_of_its_tables(path: Path) -> None:
    path.write_text(THESIS.replace("104.0", "104"))
    rig: Any = read_rig(path)
    assert rig == Rig.thesis()
    assert isinstance(rig.load.normal_n, float)
    loads = [Rig.thesis(table).load for table in ("4.2", "4.3", "4.4", "4.5")]
    assert loads == [Load(104.0), Load(83.5), Load(104.0), Load(83.5)]
    assert "4.2" in str(input_error(Rig.thesis, "4.1").remedy)


def test_units_and_radius_of_a_rig_are_those_of_its_bearing_or_drive() -> None:
    joint, slide = Rig(drive=Drive("rotary", "torque")), Rig(drive=Drive("linear", "force"))
    assert (Rig().quantities, Rig.thesis().quantities) == (LINEAR, BEARING)
    assert (joint.quantities.motion, slide.quantities.motion) == ("rotary", "linear")
    assert (Rig.thesis().radius_m, joint.radius_m) == (0.0127, 1.0)
    assert slide.radius_m is Rig().radius_m is None


@pytest.mark.parametrize(
    ("old", "new", "key", "fact"),
    [
        ("radius_m", "raduis_m", "bearing.raduis_m", "not known"),
        ("mass_kg = 2.27\n", "", "bearing.mass_kg", "missing"),
        ("0.0127", '"thin"', "bearing.radius_m", "not a number"),
        ("0.0127", "0", "bearing.radius_m", "above zero"),
        ("2.27", "1" + "0" * 400, "bearing.mass_kg", "too large"),
        ("0.002", "nan", "lubricant.viscosity_pa_s", "finite"),
        ("0.002", "0.002\ntemperature_c = 1000.1", "lubricant.temperature_c", "-100 to 1000"),
        ("5.08e-5", "0.0127", "bearing.clearance_m", "radius"),
        ("= 4 ", "= 4.0 ", "bearing.count", "integer"),
        ("= 4 ", "= 1001 ", "bearing.count", "1001"),
        ("[load]\n", "load = 3\n", "lubricant.load", "not known"),
    ],
)
def test_invalid_value_in_a_rig_file_is_reported_with_its_key(
    path: Path, old: str, new: str, key: str, fact: str
) -> None:
    path.write_text(THESIS.replace(old, new, 1))
    error = input_error(read_rig, path)
    assert (error.file, error.key) == (str(path), key)
    assert fact in error.problem


def test_unreadable_or_malformed_rig_file_is_reported_with_its_cause(path: Path) -> None:
    assert input_error(read_rig, path.parent).file == str(path.parent)
    assert input_error(read_rig, path).file == str(path)
    path.write_bytes(b"\0\1")
    assert "binary" in input_error(read_rig, path).problem
    path.write_text("load = 104.0\n")
    assert input_error(read_rig, path).key == "load"
    path.write_text(THESIS.replace("radius_m = 0.0127", "radius_m 0.0127"))
    assert input_error(read_rig, path).row == 2


def test_empty_rig_file_is_read_as_a_rig_without_sections(path: Path) -> None:
    path.write_text("")
    assert read_rig(path) == Rig()


def test_invalid_value_of_a_rig_built_in_python_is_reported_with_its_key() -> None:
    bearing: Any = vars(Rig.thesis().bearing) | {"radius_m": 0.01}
    for accepted in ({"count": 1}, {"count": 1000}, {"clearance_m": 0.00999}):
        Bearing(**bearing | accepted)
    for key, value in (("count", 0), ("clearance_m", 0.01), ("length_m", -1.0), ("radius_m", "a")):
        assert input_error(Bearing, **bearing | {key: value}).key == key
    assert [Lubricant(0.1, t).temperature_c for t in (None, -100, 1000)] == [None, -100.0, 1000.0]
    for celsius in (-100.1, 1000.1, float("nan"), "warm"):
        assert input_error(Lubricant, 0.1, celsius).key == "temperature_c"
    assert input_error(Load, 0).key == "normal_n"
    assert input_error(Rig, load={"normal_n": 1.0}).key == "load"
    assert input_error(Rig.from_mapping, {"load": {}}, prefix="rig.").key == "rig.load.normal_n"
    both = {"bearing": Rig.thesis().bearing, "drive": Drive("rotary", "torque")}
    assert input_error(Rig, **both).key == "drive"


@pytest.mark.filterwarnings("ignore:.* is outside the usual")
def test_rig_is_unchanged_by_a_toml_round_trip(path: Path) -> None:
    random = np.random.default_rng(3)
    for _ in range(20):
        small, large, *sizes = np.sort(10.0 ** random.uniform(-12.0, 12.0, 6)).tolist()
        rig = Rig(Bearing(large, sizes[0], small, sizes[1], 3), Lubricant(sizes[2]), Load(sizes[3]))
        rig.write(path)
        assert read_rig(path) == Rig.from_mapping(rig.to_mapping()) == rig
    slide = Rig(lubricant=Lubricant(0.1), drive=Drive("linear", "force", mass_kg=95.0))
    slide.write(path)
    assert read_rig(path) == slide
    assert list(path.parent.iterdir()) == [path]
