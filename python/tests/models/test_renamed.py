"""Names of earlier versions in model files, arguments and options."""

from __future__ import annotations

from pathlib import Path

import jbf
import pytest
from jbf import renamed
from jbf.cli import main
from jbf.models.catalogue import find_effect, parameters_of
from jbf.units.quantity import number_in

OLD_MODEL = """
format = 1
law = "coulomb"
effects = ["inertia_leak"]
[parameters]
F_c_n = { value = 5.0, stderr = 0.1 }
F_v_n_s_m = 20.0
[parameters.inertia_leak]
m_e_kg = 2.0
"""


def test_model_file_with_earlier_names_is_read_with_a_warning(tmp_path: Path) -> None:
    path = tmp_path / "model.toml"
    path.write_text(OLD_MODEL)
    with pytest.warns(FutureWarning, match='"inertia_leak" is now called "inertia"'):
        model = jbf.Model.load(path)
    assert model.effects == ("inertia",)
    values = {name: p.value for name, p in model.parameters.items()}
    assert values["F_c"] == 5.0
    assert values["F_v"] == 20.0
    assert values["inertia.m_e"] == 2.0


def test_every_current_name_exists_and_no_earlier_name_does() -> None:
    effects = jbf.effects()
    assert set(renamed.EFFECTS.values()) <= set(effects)
    assert not set(renamed.EFFECTS) & set(effects)
    known = {name for law in jbf.laws() for name in parameters_of(law, ())}
    known |= {f"{e.name}.{p.name}" for e in effects.values() for p in e.parameters}
    assert set(renamed.PARAMETERS.values()) <= known
    assert not set(renamed.PARAMETERS) & known


def test_effect_is_found_by_its_earlier_name() -> None:
    with pytest.warns(FutureWarning):
        assert find_effect("wear_in").name == "running_in"


def test_option_with_an_earlier_name_is_accepted_with_a_note(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["power", "rig.toml", "a.csv", "--noise-n=0.1"]) == 2
    errors = capsys.readouterr().err.splitlines()
    assert errors[0] == 'jbf: "--noise-n" is now called "--noise"'
    assert "rig.toml" in errors[1]


@pytest.mark.parametrize(
    ("text", "unit", "number"),
    [("0.2", "rad/s", 0.2), ("180 deg/s", "rad/s", 3.141592653589793), ("2 kN", "N", 2000.0)],
)
def test_option_value_is_converted_to_the_unit_of_the_rig(
    text: str, unit: str, number: float
) -> None:
    assert number_in(unit, text, "--noise") == pytest.approx(number, rel=1e-15)


@pytest.mark.parametrize("text", ["0.2 N", "fast", "1 2", ""])
def test_option_value_of_another_dimension_is_refused(text: str) -> None:
    with pytest.raises(jbf.InputError, match=r"--max-velocity: .* is not a quantity in rad/s"):
        number_in("rad/s", text, "--max-velocity")
