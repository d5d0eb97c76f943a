"""Model files on the command line: invalid content is refused, unusual notation is read."""

import math
from pathlib import Path

import pytest
from input_checks import MODEL, RMS_N, Capture, Text, compared, refused, write
from jbf.models.catalogue import parameters_of

F_C = "F_c = {value = 5.0, stderr = 0.1}"
WITH_OFFSET = MODEL.replace("effects = []", 'effects = ["sensor_offset"]')


def model(old: str, new: str) -> str:
    assert old in MODEL
    return MODEL.replace(old, new)


def value(text: str) -> str:
    return model(F_C, f"F_c = {text}")


REFUSED: dict[str, tuple[Text, str]] = {
    "key twice": (model("format = 1", "format = 1\nformat = 1"), "is not TOML"),
    "no format": (model("format = 1\n", ""), "key format: is"),
    "effect of a bearing": (model("[]", '["film_memory"]'), "film_memory"),
    "section unknown": (MODEL + "[colour]\na = 1\n", "key colour: is not known"),
    "parameter of another law": (MODEL + "gamma = 3.0\n", "key parameters.gamma: is not known"),
    "true": (value("true"), "key parameters.F_c.value: a bool is not a number"),
    "inf": (value("inf"), "key parameters.F_c"),
    "1e300": (value("1e300"), "key parameters.F_c"),
    "a long integer": (value("9" * 400), "key parameters.F_c.value: is too large"),
    "held error": (
        value("{value = 5.0, stderr = 1, held = true}"),
        "a held parameter has no standard error",
    ),
    "rig a text": (model("[par", 'rig = "rig.toml"\n[par'), "key rig: is not a table"),
    "a bearing's law": (model('"coulomb"', '"journal"'), "parameters."),
}

ACCEPTED = {
    "bare numbers": MODEL.replace("{value = 5.0, stderr = 0.1}", "5.0"),
    "an integer": MODEL.replace("{value = 5.0, stderr = 0.1}", "5"),
    "error nan": MODEL.replace("stderr = 0.1", "stderr = nan"),
    "crlf": MODEL.replace("\n", "\r\n"),
    "held": MODEL.replace("stderr = 0.1", "held = true"),
    "no clock": MODEL.replace('clock = "journal"\n', ""),
    "no effects": MODEL.replace("effects = []\n", ""),
    "effect without numbers": WITH_OFFSET,
    "a fit's words": MODEL + "[fit]\nrms_n = 0.5\n",
}


@pytest.mark.parametrize(("content", "fragment"), REFUSED.values(), ids=REFUSED)
def test_invalid_model_is_refused_with_file_and_cause(
    content: Text, fragment: str, capfd: Capture
) -> None:
    write(content)
    line = refused(["compare", "bad.toml", "a.csv"], fragment, capfd)
    assert line.startswith("jbf: bad.toml")


@pytest.mark.parametrize("name", ACCEPTED)
def test_rms_is_unchanged_by_an_unusual_notation_of_the_model_file(
    name: str, capfd: Capture
) -> None:
    write(ACCEPTED[name])
    assert compared("a.csv", capfd, "bad.toml")["rms"] == pytest.approx(RMS_N, rel=5e-3)


def test_parameter_missing_in_a_model_file_has_its_starting_value(capfd: Capture) -> None:
    write(model(F_C + "\n", ""))
    start_n = parameters_of("coulomb", ())["F_c"].starts[0]
    expected_rms = math.hypot(start_n - 5.0, RMS_N)
    assert compared("a.csv", capfd, "bad.toml")["rms"] == pytest.approx(expected_rms, rel=5e-3)


def test_time_column_with_a_unit_of_speed_is_refused(capfd: Capture) -> None:
    text = Path("a.csv").read_text().replace("time_s", "time_m_s", 1)
    Path("odd.csv").write_text(text)
    Path("map.toml").unlink()
    refused(["import", "odd.csv", "--folder", "new"], "odd.csv", capfd)
