"""Rig files: invalid content is refused with file and key; unusual notation gives the same rig."""

import re
from pathlib import Path

import pytest
from input_checks import MODEL, RIG, Capture, accepted, compared, raises_one_line, refused, write
from jbf import read_rig

DRIVE = '[drive]\nmotion = "linear"\nfriction = "force"\n'
CURRENT = '[drive]\nmotion = "rotary"\nfriction = "current"\ntorque_constant_n_m_a = 0.1\n'


def rig(old: str, new: str, text: str = RIG) -> str:
    assert old in text
    return text.replace(old, new)


def size(key: str, value: str) -> str:
    """The rig with another value of a key."""
    line = next(li for li in RIG.splitlines() if li.startswith(f"{key} "))
    return rig(line, f"{key} = {value}")


REFUSED: dict[str, tuple[str | bytes, str]] = {
    # Not TOML
    "open table": (RIG + "[", "row 13: is not TOML"),
    "utf-16": (RIG.encode("utf-16"), "is UTF-16 text; save it as UTF-8"),
    # Keys
    "section misspelt": (rig("[lubricant]", "[lubricnat]"), "key lubricnat: is not known; did you"),
    "a unit in mm": (rig("radius_m = 0.0127", "radius_mm = 12.7"), 'did you mean "radius_m"?'),
    "no bearing": (RIG[RIG.index("[lub") :], "the rig has no [bearing]"),
    "only a radius": (
        "[bearing]\nradius_m = 0.01\n",
        "key bearing: lacks length_m, clearance_m, mass_kg and count; add them to [bearing]",
    ),
    "no mass": (rig("mass_kg = 2.2", "#"), "key bearing.mass_kg: is missing; add it to [bearing]"),
    # Types
    "text": (size("viscosity_pa_s", '"thin"'), 'key lubricant.viscosity_pa_s: "thin" is not a num'),
    "true": (size("radius_m", "true"), "key bearing.radius_m: a bool is not a number"),
    # Sizes
    "nan": (size("radius_m", "nan"), "key bearing.radius_m: nan is not above zero and finite"),
    "count 2^32": (size("count", "4294967296"), "4294967296 bearings exceed the limit"),
    "wide clearance": (size("clearance_m", "0.02"), "0.02 m is not below the radius of 0.0"),
    "cold": (rig("= 0.002", "= 0.002\ntemperature_c = -300"), "-300.0 is outside -100 to 1000"),
    **{
        f"{key} of {value}": (size(key, value), f"{key}: {float(value)} is not plausible")
        for key in ("radius_m", "length_m", "mass_kg", "viscosity_pa_s", "normal_n")
        for value in ("1e300", "5e-324")
    },
    # Drives
    "bearing and drive": (RIG + DRIVE, "key drive: cannot be combined with [bearing]"),
    "constant missing": (CURRENT.replace("torque_c", "#"), "torque_constant_n_m_a"),
    "rotary mass": (CURRENT + "mass_kg = 1.0\n", "mass_kg: does not apply to a rotary drive"),
}

ACCEPTED = {
    "crlf": RIG.replace("\n", "\r\n"),
    "byte-order mark first": "\ufeff" + RIG,
    "underscores": rig("104.0", "1_0_4.0"),
    "inline": "bearing = {radius_m = 0.0127, length_m = 0.0254, clearance_m = 2.5e-5, "
    "mass_kg = 2.27, count = 4}\nlubricant.viscosity_pa_s = 0.002\nload.normal_n = 104.0\n",
    "quoted keys": rig("count", '"count"'),
}


@pytest.mark.parametrize(("content", "fragment"), REFUSED.values(), ids=REFUSED)
def test_invalid_rig_is_refused_with_file_and_cause(
    content: str | bytes, fragment: str, capfd: Capture
) -> None:
    write(content)
    law = "coulomb" if b"[drive]" in Path("bad.toml").read_bytes() else "journal"
    words = ["fit", "bad.toml", "a.csv", "--out", "new.toml", "--law", law]
    assert refused(words, fragment, capfd).startswith("jbf: bad.toml")


@pytest.mark.parametrize("name", ACCEPTED)
def test_rig_is_unchanged_by_an_unusual_notation_of_its_file(name: str) -> None:
    write(ACCEPTED[name])
    assert read_rig("bad.toml") == read_rig("rig.toml")


EXTENDED = pytest.mark.extended


@pytest.mark.parametrize(
    "value", ["1e-12", *(pytest.param(v, marks=EXTENDED) for v in ("1e-6", "1.0", "1e6")), "1e12"]
)
@pytest.mark.parametrize("key", ["radius_m", "length_m", "clearance_m", "mass_kg", "viscosity_pa_s",
                                 "normal_n"])  # fmt: skip
def test_rms_is_finite_for_a_rig_with_an_extreme_size(key: str, value: str, capfd: Capture) -> None:
    """Sizes from 1e-12 to 1e12 are accepted, and cause no overflow in the model."""
    if (key, value) in (("clearance_m", "1e12"), ("radius_m", "1e-12")):
        pytest.skip("this clearance exceeds the radius")
    text = size(key, value)
    if key == "clearance_m" and float(value) > 0.0127:
        text = text.replace("radius_m = 0.0127", "radius_m = 1e12")
    elif key == "radius_m" and float(value) < 2.5e-5:
        text = text.replace("clearance_m = 2.5e-5", "clearance_m = 1e-12")
    law = "f_m = 0.26\nU_tr_m_s = 0.055\nK0 = 6.5e5\ngamma = 33.0\n"
    head = 'format = 1\nlaw = "journal"\nclock = "journal"\n[parameters]\n'
    write(head + law + re.sub(r"^\[", "[rig.", text, flags=re.MULTILINE))
    result = compared("a.csv", capfd, "bad.toml")
    assert result["rms"] is not None
    assert 0.0 <= float(result["rms"]) < 1e40


def test_rig_file_in_place_of_a_model_file_and_the_reverse_are_refused(capfd: Capture) -> None:
    refused(["compare", "rig.toml", "a.csv"], "rig.toml: is a rig, not a model file", capfd)
    refused(["fit", "model.toml", "a.csv", "--out", "n.toml"], "is a model file, not a rig", capfd)
    write(MODEL)
    accepted(["compare", "bad.toml", "a.csv"], capfd)
    raises_one_line(lambda: read_rig("bad.toml"), "key format: is not known")


def test_output_to_the_map_that_is_the_input_is_refused(capfd: Capture) -> None:
    refused(["fit", "map.toml", "a.csv", "--out", "map.toml"], "is also an input", capfd)
