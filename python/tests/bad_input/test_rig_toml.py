"""What may stand in rig.toml: one line names file and key, or the rig comes out."""

from __future__ import annotations

from pathlib import Path

import pytest
from bad_input.checking import MODEL, RIG, Capture, accepted, compared, one_line, refused
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


BEYOND = "is beyond what any machine has; give it in SI units"
REFUSED: dict[str, tuple[str | bytes, str]] = {
    # Not TOML
    "empty": ("", "the rig has no [bearing]"),
    "a comment": ("# rig\n", "the rig has no [bearing]"),
    "open table": (RIG + "[", "row 13: is not TOML"),
    "open string": (RIG + 'a = "', "row 13: is not TOML"),
    "no value": (RIG + "a =\n", "row 13: is not TOML"),
    "no quotes": (RIG + "name = rig one\n", "row 13: is not TOML"),
    "a colon": (rig("count = 4", "count: 4"), "row 6: is not TOML"),
    "decimal comma": (rig("2.27", "2,27"), "row 5: is not TOML"),
    "key twice": (rig("count = 4", "count = 4\ncount = 3"), 'is not TOML (key "count" already'),
    "table twice": (RIG + "[load]\nnormal_n = 1.0\n", 'is not TOML (key "load" already'),
    "dots and table": (RIG + "load.normal_n = 3.0\n", "key load.load: is not known"),
    "leading zero": (rig("count = 4", "count = 04"), "row 6: is not TOML"),
    "json": ('{"bearing": {"radius_m": 1}}', "row 1: is not TOML"),
    "csv": ("time_s,velocity_m_s\n0,1\n", "row 1: is not TOML"),
    "deep": ("a = " + "[" * 3000, "is not TOML"),
    "deep and closed": ("a = " + "[" * 3000 + "]" * 3000, "is not TOML"),
    "utf-16": (RIG.encode("utf-16"), "is UTF-16 text; save it as UTF-8"),
    "latin-1": (("# µ\n" + RIG).encode("latin-1"), "row 1: is not UTF-8 text"),
    "a NUL": (RIG + "\0", "is binary, not text"),
    "binary": (bytes(range(256)), "is binary, not text"),
    # Keys
    "section misspelt": (rig("[lubricant]", "[lubricnat]"), "key lubricnat: is not known; did you"),
    "section unknown": (RIG + "[colour]\n", "key colour: is not known; known: bearing, lubricant"),
    "key misspelt": (rig("radius_m", "raduis_m"), 'bearing.raduis_m: is not known; did you mean "'),
    "key unknown": (rig("count = 4", "count = 4\nxyz = 1"), "key bearing.xyz: is not known"),
    "a unit in mm": (rig("radius_m = 0.0127", "radius_mm = 12.7"), 'did you mean "radius_m"?'),
    "key outside": ("radius_m = 1.0\n" + RIG, "key radius_m: is not known"),
    "no bearing": (RIG[RIG.index("[lub") :], "the rig has no [bearing]"),
    "no lubricant": (RIG[: RIG.index("[lub")] + RIG[RIG.index("[load") :], "no [lubricant]"),
    "no load": (RIG[: RIG.index("[load")], "the rig has no [load]"),
    "no mass": (
        rig("mass_kg = 2.27\n", ""),
        "key bearing.mass_kg: is missing; add it to [bearing]",
    ),
    "empty section": (rig("normal_n = 104.0", ""), "key load.normal_n: is missing"),
    "section a number": ("bearing = 3\n" + RIG[RIG.index("[lub") :], "key bearing: is not a table"),
    "section a list": (rig("[load]", "[[load]]"), "key load: is not a table; write it as [load]"),
    # Kinds
    "text": (size("viscosity_pa_s", '"thin"'), 'key lubricant.viscosity_pa_s: "thin" is not a num'),
    "text of a number": (size("mass_kg", '"2.27"'), 'key bearing.mass_kg: "2.27" is not a number'),
    "true": (size("radius_m", "true"), "key bearing.radius_m: a bool is not a number"),
    "a list": (size("normal_n", "[104.0]"), "key load.normal_n: a list is not a number"),
    "a date": (size("normal_n", "2024-05-03"), "key load.normal_n: a date is not a number"),
    "a table": (size("normal_n", "{value = 1.0}"), "key load.normal_n: a dict is not a number"),
    "count a half": (
        size("count", "3.5"),
        "bearing.count: 3.5 is not a whole number of at least 1",
    ),
    "count a float": (size("count", "4.0"), "key bearing.count: 4.0 is not a whole number"),
    "count a text": (size("count", '"four"'), "key bearing.count: 'four' is not a whole number"),
    # Sizes
    "zero": (size("mass_kg", "0.0"), "key bearing.mass_kg: 0.0 is not above zero"),
    "minus zero": (size("mass_kg", "-0.0"), "key bearing.mass_kg: -0.0 is not above zero"),
    "negative": (size("length_m", "-0.02"), "key bearing.length_m: -0.02 is not above zero"),
    "nan": (size("radius_m", "nan"), "key bearing.radius_m: nan is not above zero and finite"),
    "inf": (size("normal_n", "inf"), "key load.normal_n: inf is not above zero and finite"),
    "a long integer": (size("mass_kg", "9" * 400), "key bearing.mass_kg: is too large"),
    "count zero": (size("count", "0"), "key bearing.count: 0 is not a whole number of at least 1"),
    "count negative": (size("count", "-4"), "key bearing.count: -4 is not a whole number"),
    "count 2^32": (size("count", "4294967296"), "4294967296 bearings are more than a shaft has"),
    "count 2^64": (size("count", "18446744073709551616"), "are more than a shaft has; write 1000"),
    "clearance above radius": (
        size("clearance_m", "0.02"),
        "0.02 m is not below the radius of 0.0",
    ),
    "clearance in um": (size("clearance_m", "25.0"), "clearance_m: 25.0 m is not below the radius"),
    "cold": (rig("= 0.002", "= 0.002\ntemperature_c = -300"), "-300.0 is not from -100 to 1000"),
    "kelvin": (rig("= 0.002", "= 0.002\ntemperature_c = 1e4"), "give it in degrees Celsius"),
    **{
        f"{key} of {value}": (size(key, value), f"{key}: {float(value)} {BEYOND}")
        for key in ("radius_m", "length_m", "mass_kg", "viscosity_pa_s", "normal_n")
        for value in ("1e300", "5e-324")
    },
    "clearance of 1e-300": (size("clearance_m", "1e-300"), BEYOND),
    # Drives
    "both": (RIG + DRIVE, "key drive: stands beside a [bearing]"),
    "motion unknown": (
        rig("linear", "liner", DRIVE),
        '"liner" is no motion; did you mean "linear"',
    ),
    "motion a number": (rig('"linear"', "3", DRIVE), "key drive.motion: a int is no motion"),
    "friction unknown": (
        rig("force", "forc", DRIVE),
        'key drive.friction: "forc" is no friction of',
    ),
    "no motion": (
        '[drive]\nfriction = "force"\n',
        "key drive.motion: is missing; add it to [drive]",
    ),
    "constant missing": (CURRENT.replace("torque_c", "#"), "torque_constant_n_m_a"),
    "constant zero": (rig("= 0.1", "= 0", CURRENT), "torque_constant_n_m_a: 0.0 is not above zero"),
    "constant huge": (rig("= 0.1", "= 1e300", CURRENT), BEYOND),
    "constant tiny": (rig("= 0.1", "= 5e-324", CURRENT), BEYOND),
    "constant unused": (
        DRIVE + "torque_constant_n_m_a = 1.0\n",
        "is not used where a linear drive",
    ),
    "of another motion": (CURRENT + "mass_kg = 1.0\n", "mass_kg: means nothing of a rotary drive"),
    "a key unknown": (
        DRIVE + "gear_ration = 2\n",
        'drive.gear_ration: is not known; did you mean "gear_ratio"',
    ),
}

MEANT = {
    "as it is": RIG,
    "crlf": RIG.replace("\n", "\r\n"),
    "a mark first": "\ufeff" + RIG,
    "exponents": rig("0.0127", "1.27e-2"),
    "underscores": rig("104.0", "1_0_4.0"),
    "an integer": rig("104.0", "104"),
    "inline": "bearing = {radius_m = 0.0127, length_m = 0.0254, clearance_m = 2.5e-5, "
    "mass_kg = 2.27, count = 4}\nlubricant.viscosity_pa_s = 0.002\nload.normal_n = 104.0\n",
    "comments": RIG.replace("\n", " # µ ∅\n").replace("\n # µ ∅\n", "\n"),
    "quoted keys": rig("count", '"count"'),
}


def write(content: str | bytes, name: str = "bad.toml") -> None:
    Path(name).write_bytes(content if isinstance(content, bytes) else content.encode())


@pytest.mark.parametrize("name", REFUSED)
def test_one_line_names_the_key(name: str, capfd: Capture) -> None:
    content, fragment = REFUSED[name]
    write(content)
    law = "coulomb" if b"[drive]" in Path("bad.toml").read_bytes() else "journal"
    words = ["fit", "bad.toml", "a.csv", "--out", "new.toml", "--law", law]
    assert refused(words, fragment, capfd).startswith("jbf: bad.toml")


@pytest.mark.parametrize("name", MEANT)
def test_the_rig_comes_out(name: str) -> None:
    write(MEANT[name])
    assert read_rig("bad.toml") == read_rig("rig.toml")


@pytest.mark.parametrize("value", ["1e-12", "1e-6", "1.0", "1e6", "1e12"])
@pytest.mark.parametrize("key", ["radius_m", "length_m", "clearance_m", "mass_kg", "viscosity_pa_s",
                                 "normal_n"])  # fmt: skip
def test_sizes_between_are_numbers(key: str, value: str, capfd: Capture) -> None:
    """Whatever is accepted predicts finite numbers, and no library complains."""
    text = size(key, value)
    if key == "clearance_m" and float(value) > 0.0127:
        text = text.replace("radius_m = 0.0127", "radius_m = 1e12") if value != "1e12" else ""
    elif key == "radius_m" and float(value) < 2.5e-5:
        text = (
            text.replace("clearance_m = 2.5e-5", "clearance_m = 1e-12") if value != "1e-12" else ""
        )
    if not text:
        pytest.skip("no clearance is left")
    write(
        "".join(f"[rig.{li[1:]}\n" if li.startswith("[") else f"{li}\n" for li in text.split("\n"))
    )
    law = "f_m = 0.26\nU_tr_m_s = 0.055\nK0 = 6.5e5\ngamma = 33.0\n"
    head = 'format = 1\nlaw = "journal"\nclock = "journal"\n[parameters]\n'
    write(head + law + Path("bad.toml").read_text())
    told = compared("a.csv", capfd, "bad.toml")
    assert told["rms_n"] is not None
    assert 0.0 <= float(told["rms_n"]) < 1e40


def test_a_rig_is_no_model_nor_the_other_way_round(capfd: Capture) -> None:
    refused(["compare", "rig.toml", "a.csv"], "rig.toml: is a rig, not a model file", capfd)
    refused(["fit", "model.toml", "a.csv", "--out", "n.toml"], "is a model file, not a rig", capfd)
    refused(["fit", "map.toml", "a.csv", "--out", "map.toml"], "is also an input", capfd)
    write(MODEL)
    accepted(["compare", "bad.toml", "a.csv"], capfd)
    one_line(lambda: read_rig("bad.toml"), "key format: is not known")
