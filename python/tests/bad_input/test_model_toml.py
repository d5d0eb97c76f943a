"""What may stand in a model file and in a map: one line names file and key."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from bad_input.checking import MAP, MODEL, RMS_N, Capture, compared, refused
from jbf.models.catalogue import parameters_of

F_C = "F_c_n = {value = 5.0, stderr = 0.1}"
DRAG = MODEL.replace("effects = []", 'effects = ["sensor_offset"]')


def model(old: str, new: str) -> str:
    assert old in MODEL
    return MODEL.replace(old, new)


def value(text: str) -> str:
    return model(F_C, f"F_c_n = {text}")


REFUSED: dict[str, tuple[str | bytes, str]] = {
    "empty": ("", "is missing"),
    "not toml": (MODEL + "[", "is not TOML"),
    "key twice": (model("format = 1", "format = 1\nformat = 1"), "is not TOML"),
    "utf-16": (MODEL.encode("utf-16"), "is UTF-16 text"),
    "latin-1": (("# µ\n" + MODEL).encode("latin-1"), "row 1: is not UTF-8"),
    "no format": (model("format = 1\n", ""), "key format: is"),
    "another format": (model("format = 1", "format = 2"), "key format: is not one this jbf reads"),
    "format a text": (model("format = 1", 'format = "1"'), "key format: is not one"),
    "format true": (model("format = 1", "format = true"), "key format: is not one"),
    "no law": (model('law = "coulomb"\n', ""), "key law: is missing"),
    "law a number": (model('"coulomb"', "3"), "key law: is not text"),
    "law misspelt": (
        model('"coulomb"', '"coulom"'),
        'key law: "coulom" is not known; did you mean',
    ),
    "law empty": (model('"coulomb"', '""'), 'key law: "" is not known'),
    "clock unknown": (model('"journal"', '"wall"'), 'key clock: "wall" is not known'),
    "clock a list": (model('"journal"', "[]"), "key clock: is not text"),
    "effects a text": (model("[]", '"coulomb_drag"'), "key effects: is not a list of names"),
    "effects numbers": (model("[]", "[1, 2]"), "key effects: is not a list of names"),
    "effect unknown": (model("[]", '["sensor_ofset"]'), 'did you mean "sensor_offset"?'),
    "effect twice": (model("[]", '["sensor_offset", "sensor_offset"]'), "key effects: "),
    "effect of a bearing": (model("[]", '["film_memory"]'), "film_memory"),
    "top key misspelt": ("efects = []\n" + model("effects = []\n", ""), 'did you mean "effects"?'),
    "section unknown": (MODEL + "[colour]\na = 1\n", "key colour: is not known"),
    "parameters a list": (
        model("[parameters]", "parameters = []\n[fit]"),
        "key parameters: is not",
    ),
    "parameter misspelt": (model("F_c_n", "F_k_n"), "key parameters.F_k_n: is not known; did you"),
    "parameter of another law": (MODEL + "gamma = 3.0\n", "key parameters.gamma: is not known"),
    "field misspelt": (value("{valu = 5.0}"), "parameters.F_c_n"),
    "field beside": (value("{value = 5.0, error = 1}"), "parameters.F_c_n.error: is not known"),
    "value missing": (value("{stderr = 0.1}"), "key parameters.F_c_n.value: is missing"),
    "text": (value('"five"'), 'key parameters.F_c_n.value: "five" is not a number'),
    "text of a number": (value('{value = "5.0"}'), 'F_c_n.value: "5.0" is not a number'),
    "true": (value("true"), "key parameters.F_c_n.value: a bool is not a number"),
    "a list": (value("[5.0]"), "key parameters.F_c_n.value: a list is not a number"),
    "nan": (value("nan"), "key parameters.F_c_n.value: nan is not a value; write a number"),
    "inf": (value("inf"), "key parameters.F_c_n"),
    "negative": (value("-5.0"), "key parameters.F_c_n: -5"),
    "1e300": (value("1e300"), "key parameters.F_c_n"),
    "a long integer": (value("9" * 400), "key parameters.F_c_n.value: is too large"),
    "error negative": (value("{value = 5.0, stderr = -1}"), "F_c_n.stderr: is negative"),
    "error a text": (value('{value = 5.0, stderr = "1"}'), 'F_c_n.stderr: "1" is not a number'),
    "note a number": (value("{value = 5.0, note = 3}"), "F_c_n.note: is not text"),
    "held a text": (value('{value = 5.0, held = "yes"}'), "F_c_n.held: is not true or false"),
    "held with error": (
        value("{value = 5.0, stderr = 1, held = true}"),
        "what is held has no error",
    ),
    "rig a text": (
        model("[parameters]", 'rig = "rig.toml"\n[parameters]'),
        "key rig: is not a table",
    ),
    "rig unknown": (
        MODEL + "[rig.bering]\n",
        'key rig.bering: is not known; did you mean "bearing"',
    ),
    "rig zero": (MODEL + "[rig.load]\nnormal_n = 0\n", "key rig.load.normal_n: 0.0 is not above"),
    "a bearing's law": (model('"coulomb"', '"journal"'), "parameters."),
}

MEANT = {
    "bare numbers": MODEL.replace("{value = 5.0, stderr = 0.1}", "5.0"),
    "an integer": MODEL.replace("{value = 5.0, stderr = 0.1}", "5"),
    "error nan": MODEL.replace("stderr = 0.1", "stderr = nan"),
    "crlf": MODEL.replace("\n", "\r\n"),
    "held": MODEL.replace("stderr = 0.1", "held = true"),
    "no clock": MODEL.replace('clock = "journal"\n', ""),
    "no effects": MODEL.replace("effects = []\n", ""),
    "effect without numbers": DRAG,
    "a fit's words": MODEL + "[fit]\nrms_n = 0.5\n",
}

MAPS: dict[str, tuple[str | bytes, str]] = {
    "empty": ("", "key columns: is missing; add [columns] with lines such as"),
    "not toml": (MAP + "[", "is not TOML"),
    "section misspelt": (MAP + "[clock]\n", 'key clock: is not known; did you mean "clocks"?'),
    "open": (MAP.replace('"friction_n"\n', '"?"\n'), "key columns.friction_n: is open; put what"),
    "columns a list": ("columns = []\n", "key columns: is not a table"),
    "a number": (MAP.replace('"friction_n"\n', "3\n"), "key columns.friction_n: 3 is no text"),
    "column absent": (MAP.replace('"friction_n"\n', '"Kraft"\n'), '"Kraft"'),
    "an expression cut off": (MAP.replace('"friction_n"\n', '"friction_n *"\n'), "friction_n"),
    "brackets": (MAP.replace('"friction_n"\n', '"((((friction_n"\n'), "friction_n"),
    "deep": (MAP.replace('"friction_n"\n', '"' + "(" * 3000 + '1"\n'), "friction_n"),
    "by zero": (MAP.replace('"friction_n"\n', '"friction_n / 0"\n'), "friction_n"),
    "a function": (MAP.replace('"friction_n"\n', '"exec(friction_n)"\n'), "friction_n"),
    "huge": (MAP.replace('"friction_n"\n', '"friction_n * 1e300"\n'), "friction_n"),
    "another unit": (MAP.replace('"friction_n"\n', '"friction_n [m/s]"\n'), "friction_n"),
    "target unknown": (MAP.replace("friction_n =", "fricton_n ="), "key columns.fricton_n: "),
    "no rig": (MAP[: MAP.index("[drive]")], "key drive: nothing says what it was recorded on"),
    "no friction": (
        MAP.replace('friction_n = "friction_n"\n', ""),
        "holds no column for a friction",
    ),
    "no motion": (MAP.replace('velocity_m_s = "velocity_m_s"\n', ""), "no column for a motion"),
    "delimiter long": (MAP + '[file]\ndelimiter = ";;"\n', "key file.delimiter: ';;' does not fit"),
    "decimal odd": (MAP + '[file]\ndecimal = "x"\n', "key file.decimal: 'x' does not fit; write"),
    "encoding unknown": (MAP + '[file]\nencoding = "utf-99"\n', "utf-99"),
    "header negative": (MAP + "[file]\nheader = -1\n", "key file.header: -1 does not fit"),
    "header beyond": (MAP + "[file]\nheader = 9999999999999\n", "a.csv"),
    "rate zero": (MAP + "[file]\nrate_hz = 0\n", "key file.rate_hz: 0 does not fit"),
    "rate nan": (MAP + "[file]\nrate_hz = nan\n", "key file.rate_hz: nan does not fit"),
    "rate of 400 digits": (MAP + f"[file]\nrate_hz = {'9' * 400}\n", "key file.rate_hz: "),
    "empty words": (MAP + "[file]\nempty = [1]\n", "key file.empty: [1] does not fit"),
    "an option unknown": (MAP + "[file]\ndelimeter = 1\n", 'did you mean "delimiter"?'),
    "cut unknown": (MAP + "[cut]\nby = 3\n", "key cut"),
}


def write(content: str | bytes) -> None:
    Path("bad.toml").write_bytes(content if isinstance(content, bytes) else content.encode())


@pytest.mark.parametrize("name", REFUSED)
def test_one_line_names_the_key(name: str, capfd: Capture) -> None:
    content, fragment = REFUSED[name]
    write(content)
    line = refused(["compare", "bad.toml", "a.csv"], fragment, capfd)
    assert line.startswith("jbf: bad.toml")


@pytest.mark.parametrize("name", MEANT)
def test_the_number_comes_out(name: str, capfd: Capture) -> None:
    write(MEANT[name])
    assert compared("a.csv", capfd, "bad.toml")["rms_n"] == pytest.approx(RMS_N, rel=5e-3)


def test_what_is_not_given_starts_as_the_catalogue_has_it(capfd: Capture) -> None:
    write(model(F_C + "\n", ""))
    start_n = parameters_of("coulomb", ())["F_c_n"].starts[0]
    left_n = math.hypot(start_n - 5.0, RMS_N)
    assert compared("a.csv", capfd, "bad.toml")["rms_n"] == pytest.approx(left_n, rel=5e-3)


@pytest.mark.parametrize("name", MAPS)
def test_one_line_names_the_key_of_a_map(name: str, capfd: Capture) -> None:
    content, fragment = MAPS[name]
    write(content)
    refused(["import", "a.csv", "--map", "bad.toml", "--out", "new"], fragment, capfd)


def test_a_header_of_a_time_in_metres_a_second_is_no_time(capfd: Capture) -> None:
    """Found by broken files: a name that says time, a unit that says speed."""
    text = Path("a.csv").read_text().replace("time_s", "time_m_s", 1)
    Path("odd.csv").write_text(text)
    Path("map.toml").unlink()
    refused(["import", "odd.csv", "--out", "new"], "odd.csv", capfd)
