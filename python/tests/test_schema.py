"""What the commands write as JSON is what docs/schema/results.json says, and nothing else."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import jbf
import jsonschema
import pytest
from conftest import make_runs
from jbf.cli import main
from jbf.control import robustness
from jbf.diagnosis.result import Diagnosis
from jbf.reporting.control_json import robustness_dict
from jbf.reporting.json import json_text

FILE = Path(__file__).resolve().parents[2] / "docs" / "schema" / "results.json"
SCHEMA: dict[str, Any] = json.loads(FILE.read_text(encoding="utf-8"))


def closed(schema: Any) -> Any:
    """The same, with no key but those that it names."""
    if isinstance(schema, list):
        return [closed(item) for item in schema]
    if not isinstance(schema, Mapping):
        return schema
    found = {key: closed(value) for key, value in schema.items()}
    if found.get("type") == "object" and isinstance(found.get("properties"), dict):
        found.setdefault("additionalProperties", False)
    return found


CLOSED = closed(SCHEMA)


def faults(kind: str, told: Any, schema: Any = CLOSED) -> list[str]:
    """What is wrong with a document of a kind."""
    of_kind = {"$defs": schema["$defs"], "$ref": f"#/$defs/{kind}"}
    return [
        f"{error.json_path}: {error.message}"
        for error in jsonschema.Draft202012Validator(of_kind).iter_errors(told)
    ]


def as_written(told: Any) -> Any:
    return json.loads(json_text(told))


@pytest.fixture(scope="module")
def diagnosis(rig: jbf.Rig, runs: list[jbf.Run]) -> Diagnosis:
    return jbf.diagnose(rig, runs)


def test_the_schema_is_one() -> None:
    jsonschema.Draft202012Validator.check_schema(SCHEMA)


def test_a_diagnosis(diagnosis: Diagnosis) -> None:
    told = as_written(diagnosis.to_dict())
    assert faults("diagnosis", told) == []
    # Open to keys that come later, as users should have it.
    assert faults("diagnosis", told | {"later": 1}, SCHEMA) == []
    assert any("'later'" in fault for fault in faults("diagnosis", told | {"later": 1}))
    assert any("'maybe'" in f for f in faults("diagnosis", told | {"verdict": "maybe"}, SCHEMA))
    del told["steps"][0]["noise_n"]
    assert any("noise_n" in fault for fault in faults("diagnosis", told, SCHEMA))


def test_a_diagnosis_of_a_drive_with_a_law_of_its_choice() -> None:
    """With units, laws that were compared, what was held, what remains."""
    rig = jbf.Rig(drive=jbf.Drive("linear", "force"))
    runs = make_runs()
    slides = [
        jbf.Run.from_arrays(
            r.time_s, r.velocity_m_s, r.friction_n, position_m=0.0127 * r.angle_rad, name=r.name
        )
        for r in runs
        if r.friction_n is not None and r.angle_rad is not None
    ]
    told = as_written(jbf.diagnose(rig, slides[:2], law="auto").to_dict())
    assert faults("diagnosis", told) == []
    assert told["units"]
    assert told["laws"]


def test_what_the_commands_write(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    rig = jbf.Rig.thesis()
    rig.write("rig.toml")
    model = jbf.Model(rig, effects=["coulomb_drag"], parameters={"coulomb_drag.F_d_n": 2.0})
    model.save("model.toml")
    for folder in ("rigs/a", "rigs/b"):
        Path(folder).mkdir(parents=True)
    rig.write("rigs/a/rig.toml")
    rig.write("rigs/b/rig.toml")
    Path("rigs/b/broken.csv").write_text("time_s\n0\n")
    for run in make_runs():
        run.write_csv(f"{run.name}.csv")
        run.write_csv(f"rigs/a/{run.name}.csv")
    noise = ["--noise-n", "0.3"]
    commands = {
        "comparison": ["compare", "model.toml", "*.csv"],
        "planned": ["power", "model.toml", "*.csv", *noise],
        "plan": ["plan", "rig.toml", "--minutes", "3", "--max-velocity-m-s", "0.1", *noise],
        "check": ["check", "model.toml", "*.csv", "-n", "1", "--jobs", "1"],
        "effects": ["effects"],
        "many": ["diagnose", "--many", "rigs", "--jobs", "1"],
        "diagnosis": ["diagnose", "rig.toml", "*.csv", "--hold-out", "stop*"],
    }
    for kind, command in commands.items():
        assert main([*command, "--json", f"{kind}.json"]) == 0, kind
        told = json.loads(Path(f"{kind}.json").read_text(encoding="utf-8"))
        assert faults(kind, told) == [], kind
        jsonschema.validate(told, SCHEMA)
    many = json.loads(Path("many.json").read_text(encoding="utf-8"))
    assert set(many["b"]) == {"error"}
    assert "hold_out" in json.loads(Path("diagnosis.json").read_text(encoding="utf-8"))


def test_the_robustness_of_a_compensator() -> None:
    told = robustness_dict([robustness.Outcome("a case", {"velocity sine": 0.3})])
    assert faults("robustness", as_written(told)) == []


def test_the_tables_of_the_thesis(tmp_path: Path) -> None:
    path = tmp_path / "tables.json"
    assert main(["control", "tables", "--json", str(path)]) == 0
    assert faults("tables", json.loads(path.read_text(encoding="utf-8"))) == []
