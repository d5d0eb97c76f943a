"""Rigs: exact round trips, and each refusal's words."""

from __future__ import annotations

import random
from pathlib import Path

import pytest
from jbf.errors import InputError
from jbf.records.rig import Bearing, Load, Lubricant, Rig, read_rig

GOOD = """\
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


def refusal(path: Path) -> str:
    with pytest.raises(InputError) as caught:
        read_rig(path)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def test_reads_the_contract(tmp_path: Path) -> None:
    path = tmp_path / "rig.toml"
    path.write_text(GOOD)
    assert read_rig(path) == Rig.thesis() == Rig.thesis("4.4")
    assert Rig.thesis("4.3").load == Rig.thesis("4.5").load == Load(83.5)
    path.write_text(GOOD.replace("104.0", "104"))
    load = read_rig(path).load
    assert load is not None
    assert isinstance(load.normal_n, float)


def test_sections_may_be_absent(tmp_path: Path) -> None:
    path = tmp_path / "rig.toml"
    path.write_text("[load]\nnormal_n = 5.0\n")
    assert read_rig(path) == Rig(load=Load(5.0))
    path.write_text("")
    assert read_rig(path) == Rig()


@pytest.mark.parametrize(
    ("old", "new", "place", "words"),
    [
        ("radius_m", "raduis_m", "key bearing.raduis_m", 'is not known; did you mean "radius_m"?'),
        ("[lubricant]", "[lubricnt]", "key lubricnt", 'did you mean "lubricant"?'),
        ("[load]", "[zzz]", "key zzz", "is not known; known: bearing, lubricant, load, drive"),
        ("mass_kg = 2.27\n", "", "key bearing.mass_kg", "is missing; add it to [bearing]"),
        ("0.0127", '"0.0127"', "key bearing.radius_m", '"0.0127" is not a number; write a plain'),
        ("0.0127", "true", "key bearing.radius_m", "a bool is not a number"),
        ("0.0127", "[1.0]", "key bearing.radius_m", "a list is not a number"),
        ("0.0127", "0", "key bearing.radius_m", "0.0 is not above zero and finite; correct"),
        ("2.27", "-1.0", "key bearing.mass_kg", "-1.0 is not above zero and finite"),
        ("2.27", "1" + "0" * 400, "key bearing.mass_kg", "is too large"),
        ("0.002", "nan", "key lubricant.viscosity_pa_s", "nan is not above zero and finite"),
        ("104.0", "inf", "key load.normal_n", "inf is not above zero and finite"),
        ("5.08e-5", "0.0127", "key bearing.clearance_m", "is not below the radius of 0.0127 m"),
        ("= 4 ", "= 4.0 ", "key bearing.count", "4.0 is not a whole number of at least 1"),
        ("= 4 ", "= 0 ", "key bearing.count", "0 is not a whole number of at least 1"),
        ("= 4 ", "= true ", "key bearing.count", "True is not a whole number"),
        ("[load]\n", "load = 3\n", "key lubricant.load", "is not known"),
        ("radius_m = 0.0127", "radius_m 0.0127", "row 2", "is not TOML ("),
        ("radius_m = 0.0127", "radius_m = ", "row 2", "TOML is written key = value"),
        ("length_m", "radius_m", "", 'is not TOML (key "radius_m" already exists)'),
    ],
)
def test_bad_rig(tmp_path: Path, old: str, new: str, place: str, words: str) -> None:
    path = tmp_path / "rig.toml"
    path.write_text(GOOD.replace(old, new, 1))
    message = refusal(path)
    assert message.startswith(f"{path}, {place}: " if place else f"{path}: ")
    assert words in message


def test_section_that_is_no_table(tmp_path: Path) -> None:
    path = tmp_path / "rig.toml"
    path.write_text("load = 104.0\n")
    assert refusal(path) == f"{path}, key load: is not a table; write it as [load] with keys"


def test_unreadable(tmp_path: Path) -> None:
    assert refusal(tmp_path) == f"{tmp_path}: is a folder; name a file in it"
    path = tmp_path / "rig.toml"
    assert refusal(path) == f"{path}: the file does not exist; correct the path"
    path.write_bytes(b"\0\1")
    assert refusal(path) == f"{path}: is binary, not text; name a text file"


def test_python_meets_the_same_rules() -> None:
    with pytest.raises(InputError, match=r"^key normal_n: 0\.0 is not above zero"):
        Load(0)
    with pytest.raises(InputError, match=r"^key rig\.load\.normal_n: is missing"):
        Rig.from_mapping({"load": {}}, prefix="rig.")
    with pytest.raises(InputError, match=r"choose from 4\.2, 4\.3, 4\.4, 4\.5"):
        Rig.thesis("4.1")


def test_round_trip_is_exact(tmp_path: Path) -> None:
    rng = random.Random(3)
    path = tmp_path / "rig.toml"

    def some() -> float:
        return float(10.0 ** rng.uniform(-12.0, 12.0))

    for _ in range(50):
        clearance_m, radius_m = sorted((some(), some()))
        rig = Rig(
            rng.choice([None, Bearing(radius_m, some(), clearance_m, some(), rng.randint(1, 9))]),
            rng.choice([None, Lubricant(some())]),
            rng.choice([None, Load(some())]),
        )
        rig.write(path)
        assert read_rig(path) == rig
        assert Rig.from_mapping(rig.to_mapping()) == rig
    assert [p.name for p in tmp_path.iterdir()] == ["rig.toml"]
