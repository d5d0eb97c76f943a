"""Results as JSON: values that JSON cannot represent, and the published schema."""

import json
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import jbf
import jsonschema
import numpy as np
import pytest
from by_hand import comparison_by_hand, diagnosis_by_hand
from conftest import make_runs
from golden import golden
from jbf.cli import main
from jbf.control.robustness import Outcome
from jbf.control.thesis_tables import tables
from jbf.reporting.control_json import robustness_dict, tables_dict
from jbf.reporting.json import json_text

FILE = Path(__file__).resolve().parents[3] / "docs" / "schema" / "results.json"
EXTENDED = pytest.mark.extended
SCHEMA: dict[str, Any] = json.loads(FILE.read_text(encoding="utf-8"))


def test_json_text_has_null_for_nan_a_string_for_infinity_and_lists_for_arrays() -> None:
    inf, nan = float("inf"), float("nan")
    numpy = {"c": np.float64(2.0), "d": np.int64(3), "f": np.bool_(True)}
    array = np.array([[1.0, -inf], [nan, 2.0]])
    text = json_text({1: nan, "a": (inf, -inf, True, None, "é"), "b": numpy, "e": array})
    content = json.loads(text)
    assert content.pop("1") is None
    assert content.pop("a") == ["inf", "-inf", True, None, "é"]
    assert content == {"b": {"c": 2.0, "d": 3, "f": True}, "e": [[1.0, "-inf"], [None, 2.0]]}
    assert text.endswith("\n")


def closed(schema: Any) -> Any:
    """The schema without permission for additional keys."""
    if isinstance(schema, list):
        return [closed(item) for item in schema]
    if not isinstance(schema, Mapping):
        return schema
    copy = {key: closed(value) for key, value in schema.items()}
    if copy.get("type") == "object" and isinstance(copy.get("properties"), dict):
        copy.setdefault("additionalProperties", False)
    return copy


def violations(kind: str, content: Any, schema: Any = None) -> list[str]:
    """Violations of the closed schema by a document of the given kind."""
    chosen = closed(SCHEMA) if schema is None else schema
    of_kind = {"$defs": chosen["$defs"], "$ref": f"#/$defs/{kind}"}
    return [
        f"{error.json_path}: {error.message}"
        for error in jsonschema.Draft202012Validator(of_kind).iter_errors(content)
    ]


def as_written(content: Any) -> Any:
    return json.loads(json_text(content))


def test_published_schema_is_a_valid_json_schema() -> None:
    jsonschema.Draft202012Validator.check_schema(SCHEMA)


def test_result_schema_allows_new_keys_but_no_unknown_verdict_or_missing_key() -> None:
    content = as_written(diagnosis_by_hand("missing").to_dict())
    assert violations("diagnosis", content | {"later": 1}, SCHEMA) == []
    assert any("'later'" in v for v in violations("diagnosis", content | {"later": 1}))
    assert any("'maybe'" in v for v in violations("diagnosis", content | {"verdict": "maybe"}))
    del content["steps"][0]["noise_rms"]
    assert any("noise_rms" in v for v in violations("diagnosis", content, SCHEMA))


@pytest.mark.parametrize("verdict", ["adequate", "missing", "ambiguous", "unexplained"])
def test_json_of_a_diagnosis_with_each_verdict_agrees_with_the_schema(verdict: str) -> None:
    assert violations("diagnosis", as_written(diagnosis_by_hand(verdict).to_dict())) == []


SIMULATED = ("bearing_coulomb_drag", pytest.param("slide_law_selection", marks=EXTENDED))


@pytest.mark.parametrize("name", SIMULATED)
def test_json_of_a_simulated_diagnosis_has_power_and_agrees_with_the_schema(name: str) -> None:
    content = as_written(golden(name).to_dict())
    assert violations("diagnosis", content) == []
    assert content["power"]
    assert bool(content["laws"]) == (name == "slide_law_selection")


def test_json_of_a_comparison_has_units_of_the_drive_and_agrees_with_the_schema() -> None:
    rig = jbf.Rig(drive=jbf.Drive("rotary", "current", torque_constant_n_m_a=0.5))
    linear = comparison_by_hand(1.25, (1.0, 1.5))
    content = as_written(replace(linear, model=replace(linear.model, rig=rig)).to_dict())
    assert violations("comparison", content) == []
    assert content["units"] == {"force": "N m", "motion": "rad", "velocity": "rad/s"}


def test_json_of_robustness_and_thesis_tables_agrees_with_the_schema() -> None:
    outcomes = [Outcome("a case", {"velocity sine": 0.3})]
    assert violations("robustness", as_written(robustness_dict(outcomes))) == []
    short = {row: replace(task, seconds=3.0) for row, task in jbf.control.TASKS.items()}
    bench = jbf.control.THESIS_BENCH
    found = tables(jbf.control.thesis_model(), bench, tasks=short, seeds=1)
    content = as_written(tables_dict(found, [("the same", found)]))
    assert violations("tables", content) == []


@pytest.mark.extended
@pytest.mark.usefixtures("working_folder")
def test_json_of_each_command_agrees_with_the_schema() -> None:
    rig = jbf.Rig.thesis()
    rig.write("rig.toml")
    model = jbf.Model(rig, effects=["coulomb_drag"], parameters={"coulomb_drag.F_d": 2.0})
    model.save("model.toml")
    for folder in ("rigs/a", "rigs/b"):
        Path(folder).mkdir(parents=True)
        rig.write(f"{folder}/rig.toml")
    Path("rigs/b/broken.csv").write_text("time_s\n0\n")
    for run in make_runs():
        run.write_csv(f"{run.name}.csv")
        run.write_csv(f"rigs/a/{run.name}.csv")
    noise = ["--noise", "0.3"]
    commands = {
        "comparison": ["compare", "model.toml", "*.csv"],
        "planned": ["power", "model.toml", "*.csv", *noise],
        "plan": ["plan", "rig.toml", "--minutes", "3", "--max-velocity", "0.1", *noise],
        "check": ["check", "model.toml", "*.csv", "-n", "1", "--jobs", "1"],
        "effects": ["effects"],
        "many": ["diagnose", "--many", "rigs", "--jobs", "1"],
        "diagnosis": ["diagnose", "rig.toml", "*.csv", "--hold-out", "stop*"],
        "tables": ["control", "tables"],
    }
    for kind, command in commands.items():
        assert main([*command, "--json", f"{kind}.json"]) == 0, kind
        content = json.loads(Path(f"{kind}.json").read_text(encoding="utf-8"))
        assert violations(kind, content) == [], kind
        jsonschema.validate(content, SCHEMA)
    many = json.loads(Path("many.json").read_text(encoding="utf-8"))
    assert set(many["b"]) == {"error"}
    assert "hold_out" in json.loads(Path("diagnosis.json").read_text(encoding="utf-8"))
