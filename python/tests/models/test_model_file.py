"""Model files: exact round trips, files written by hand, and refused content."""

import math
import random
import sys
from pathlib import Path

import numpy as np
import pytest
from jbf.errors import InputError
from jbf.models.model_file import model_file_text, read_model_file
from jbf.models.parameter_value import ParameterValue
from jbf.models.vocabulary import ModelFile, Vocabulary
from jbf.records.rig import Rig

GOOD = """\
format = 1
law = "journal"
clock = "journal"
effects = ["coulomb_drag"]

[parameters]
f_m = { value = 0.26, stderr = 0.002 }
gamma = 33

[parameters.coulomb_drag]
F_d = { value = 0.5, note = "guess" }

[rig.bearing]
radius_m = 0.0127
length_m = 0.01905
clearance_m = 5.08e-5
mass_kg = 2.27
count = 4
[rig.lubricant]
viscosity_pa_s = 0.002
[rig.load]
normal_n = 104.0

[fit]
rms = 0.42
"""
VOCABULARY = Vocabulary(
    laws=("journal", "lugre"),
    effects={"coulomb_drag": {"F_d": (0.0, 100.0)}, "sensor_lag": {"tau_s": (0.0, math.inf)}},
    law_parameters={"journal": {"f_m": (0.0, 2.0), "gamma": (0.0, 1e4)}},
)


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "model.toml"


def refusal(path: Path) -> str:
    with pytest.raises(InputError) as caught:
        read_model_file(path, VOCABULARY)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def test_hand_written_model_file_is_read_with_all_its_sections(path: Path) -> None:
    path.write_text(GOOD)
    assert read_model_file(path, VOCABULARY) == ModelFile(
        law="journal",
        clock="journal",
        effects=("coulomb_drag",),
        parameters={
            "f_m": ParameterValue(0.26, 0.002),
            "gamma": ParameterValue(33.0),
            "coulomb_drag.F_d": ParameterValue(0.5, None, "guess"),
        },
        rig=Rig.thesis(),
        fit={"rms": 0.42},
    )
    path.write_text('format = 1\nlaw = "lugre"\n')
    assert read_model_file(path, VOCABULARY) == ModelFile("lugre")


BAD = [
    ("format = 1", "format = 2", "key format", "of jbf; write format = 1"),
    ("format = 1", "format = true", "key format", "is not supported by this version"),
    ("format = 1\n", "", "key format", "is missing; write format = 1"),
    ('law = "journal"\n', "", "key law", 'is missing; write law = "NAME"'),
    ('law = "journal"', "law = 3", "key law", "is not text"),
    ('law = "journal"', 'law = "jornal"', "key law", '"jornal" is not known; did you mean "jour'),
    ('clock = "journal"', 'clock = "thesys"', "key clock", 'did you mean "thesis"?'),
    ("clock =", "clok =", "key clok", 'is not known; did you mean "clock"?'),
    ('["coulomb_drag"]', '"coulomb_drag"', "key effects", "is not a list of names; write effects"),
    ('["coulomb_drag"]', "[1]", "key effects", "is not a list of names"),
    ('["coulomb_drag"]', '["coulomb_drag", "sensor_leg"]', "key effects", '"sensor_lag"?'),
    ('["coulomb_drag"]', '["coulomb_drag", "coulomb_drag"]', "key effects", "name each once"),
    ('["coulomb_drag"]', "[]", "key parameters.coulomb_drag.F_d",
     'the effect "coulomb_drag" is not in the list of effects; add it to effects or remove'),
    ("gamma", "gama", "key parameters.gama", 'is not known; did you mean "gamma"?'),
    ("F_d", "F_n", "key parameters.coulomb_drag.F_n", 'did you mean "F_d"?'),
    ("0.26", "2.6", "key parameters.f_m", "2.6 is out of range; choose from 0.0 to 2.0"),
    ("0.5,", "-0.5,", "key parameters.coulomb_drag.F_d", "-0.5 is out of range; choose from"),
    ("0.26", '"0.26"', "key parameters.f_m.value", '"0.26" is not a number; write a plain number'),
    ("0.26", "nan", "key parameters.f_m.value", "nan is not a value; write a number"),
    ("33", "nan", "key parameters.gamma.value", "nan is not a value"),
    ("33", "[1]", "key parameters.gamma.value", "a list is not a number"),
    ("33", "{}", "key parameters.gamma.value", "is missing; write { value = 0.26 }"),
    ("value = 0.26, ", "", "key parameters.f_m.value", "is missing; write { value"),
    ("stderr", "stder", "key parameters.f_m.stder", 'did you mean "stderr"?'),
    ("0.002 }", "-0.002 }", "key parameters.f_m.stderr", "is negative; remove the sign"),
    ('"guess"', "3", "key parameters.coulomb_drag.F_d.note", "is not text; put it in quot"),
    ("radius_m = 0.0127", "radius_m = 0", "key rig.bearing.radius_m", "is not above zero"),
    ("[rig.load]", "[rig.lod]", "key rig.lod", 'did you mean "load"?'),
    ("normal_n = 104.0", "", "key rig.load.normal_n", "is missing; add it to [rig.load]"),
    ("rms = 0.42", "rms = true", "key fit.rms", "a bool is not a number"),
    ("law =", "law", "row 2", "is not TOML ("),
]  # fmt: skip


@pytest.mark.parametrize(("old", "new", "place", "fragment"), BAD)
def test_model_file_with_invalid_content_is_refused_with_file_and_key(
    path: Path, old: str, new: str, place: str, fragment: str
) -> None:
    assert old in GOOD
    path.write_text(GOOD.replace(old, new, 1))
    message = refusal(path)
    assert message.startswith(f"{path}, {place}: ")
    assert fragment in message


@pytest.mark.parametrize("key", ["parameters", "rig", "fit"])
def test_section_of_a_model_file_that_is_not_a_table_is_refused(path: Path, key: str) -> None:
    path.write_text(f'format = 1\nlaw = "journal"\n{key} = 3\n')
    assert refusal(path) == f"{path}, key {key}: is not a table; write it as [{key}] with keys"


def test_unknown_names_in_a_model_file_are_accepted_without_a_vocabulary(path: Path) -> None:
    path.write_text(GOOD.replace("gamma", "anything").replace("journal", "some"))
    assert read_model_file(path).law == "some"


def test_standard_error_of_nan_in_a_parameter_value_is_replaced_by_none() -> None:
    assert ParameterValue(1, math.nan) == ParameterValue(1.0, None)


def test_model_file_object_with_an_invalid_parameter_name_is_refused() -> None:
    for name in ("a.b", "coulomb_drag.a.b", "coulomb_drag.", "coulomb_drag"):
        with pytest.raises(InputError, match=r"^key parameters\.") as caught:
            ModelFile("journal", effects=("coulomb_drag",), parameters={name: ParameterValue(1)})
        assert caught.value.key == f"parameters.{name}"


def test_written_model_file_has_a_comment_and_one_line_for_each_parameter(path: Path) -> None:
    path.write_text(GOOD)
    path.write_text(model_file_text(read_model_file(path), {"coulomb_drag.F_d": "N"}))
    text = path.read_text()
    assert text.startswith("# jbf model file.")
    assert "\nf_m = {value = 0.26, stderr = 0.002}\n" in text
    assert '\n[parameters.coulomb_drag]\nF_d = {value = 0.5, note = "guess"} # N\n' in text
    assert "\n[rig.bearing]\nradius_m = 0.0127\n" in text
    assert "\n[rig]\n" not in text


def test_random_model_files_are_unchanged_by_writing_and_reading(path: Path) -> None:
    rng = random.Random(11)
    largest, smallest = sys.float_info.max, sys.float_info.min
    extremes = [5e-324, smallest, 1e300, largest, math.inf, 0.0, -0.0, 0.1, 1e22, 2.0**53]
    text = ["", 'a "quoted" note', "two\nlines\ttab", "back\\slash", "gr\u00fcn \u00b5", "\x01#'''"]

    def number() -> float:
        return rng.choice([rng.choice(extremes), rng.random() * 10.0 ** rng.randint(-320, 300)])

    def parameter() -> ParameterValue:
        held = rng.random() < 0.3
        stderr = None if held else rng.choice([None, abs(number())])
        note = rng.choice([None, *text])
        return ParameterValue(rng.choice([-1, 1]) * number(), stderr, note, held)

    for _ in range(100):
        effects = rng.sample(["coulomb_drag", "sensor_lag", "running_in"], rng.randint(0, 3))
        names = ["f_m", "U_tr_m_s"] + [f"{e}.{p}" for e in effects for p in ("a", "s_0", "value")]
        names = rng.sample(names, rng.randint(0, len(names)))
        model = ModelFile(
            law="journal",
            clock=rng.choice(["journal", "thesis"]),
            effects=tuple(effects),
            parameters={name: parameter() for name in names},
            rig=rng.choice([Rig(), Rig.thesis(), Rig(load=Rig.thesis().load)]),
            fit={"rms": number(), "runs": rng.randint(-9, 9), "an odd key": rng.choice(text)},
        )
        path.write_text(model_file_text(model, {}), encoding="utf-8")
        back = read_model_file(path)
        assert back == model
        # Equality does not distinguish -0.0 from 0.0; repr does.
        assert repr(sorted(back.parameters.items())) == repr(sorted(model.parameters.items()))
        assert repr(back.fit) == repr(model.fit)
    assert [p.name for p in path.parent.iterdir()] == ["model.toml"]


def test_numpy_scalars_are_written_to_a_model_file_as_plain_numbers(path: Path) -> None:
    values = {"a": ParameterValue(np.float64(0.3), np.float32(1))}
    fit = {"rms": np.float64(0.1), "n": np.int64(3), "x": np.float32(0.5)}
    model = ModelFile("j", parameters=values, fit=fit)
    path.write_text(model_file_text(model, {}), encoding="utf-8")
    assert read_model_file(path) == model
    assert "np." not in path.read_text()
