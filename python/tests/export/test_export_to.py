"""Export of a model to a target: ledger, limit of the loss, command, JSON."""

import json
from dataclasses import fields
from pathlib import Path

import jbf
import jsonschema
import numpy as np
import pytest
from input_checks import Capture
from jbf import export
from jbf.cli import main
from joint_runs import JOINT, joint_runs

SCHEMA = Path(__file__).resolve().parents[3] / "docs" / "schema" / "results.json"
VALUES = {"F_c": 5.0, "F_s": 8.0, "v_s": 0.1, "F_v": 2.0, "gravity.G": 3.0}


@pytest.fixture
def model() -> jbf.Model:
    return jbf.Model(JOINT, "stribeck", ["gravity", "sensor_lag"], VALUES)


@pytest.fixture
def saved(tmp_path: Path, model: jbf.Model) -> Path:
    """A folder with the model file and its runs."""
    model.save(tmp_path / "model.toml")
    (tmp_path / "runs").mkdir()
    for run in joint_runs():
        columns = zip(run.time_s, run.angle_rad, run.velocity, model.predict(run), strict=True)
        lines = [",".join(map(repr, map(float, row))) for row in columns]
        head = "time_s,angle_rad,velocity_rad_s,torque_n_m"
        (tmp_path / "runs" / f"{run.name}.csv").write_text("\n".join([head, *lines]) + "\n")
    return tmp_path


@pytest.mark.parametrize("target", export.TARGETS)
def test_ledger_of_every_target_lists_law_and_effects_in_order(
    model: jbf.Model, target: str
) -> None:
    ledger = export.to(model, target, joint_runs()).ledger
    assert [term.name for term in ledger.terms] == [model.law, *model.effects]
    assert ledger.unit == "N m"
    assert [loss.run for loss in ledger.runs] == [run.name for run in joint_runs()]
    assert 0.0 <= ledger.share < 0.5


def test_error_over_all_runs_is_the_rms_over_their_samples(model: jbf.Model) -> None:
    long, short = joint_runs()
    half = short.select(np.arange(len(short)) < len(short) // 4)
    ledger = export.to(model, "table", [long, half]).ledger
    squares = sum(loss.samples * loss.rms**2 for loss in ledger.runs)
    assert ledger.rms**2 * sum(loss.samples for loss in ledger.runs) == pytest.approx(squares)
    assert ledger.share == pytest.approx(ledger.rms / ledger.friction_rms)


def test_loss_above_the_limit_is_refused_and_below_it_accepted(model: jbf.Model) -> None:
    share = export.to(model, "table", joint_runs()).ledger.share
    export.to(model, "table", joint_runs(), max_loss=1.01 * share)
    with pytest.raises(jbf.InputError, match="loss"):
        export.to(model, "table", joint_runs(), max_loss=0.99 * share)


def test_unknown_target_is_refused_with_a_suggestion(model: jbf.Model) -> None:
    with pytest.raises(jbf.InputError, match="table"):
        export.to(model, "tabel", joint_runs())


@pytest.mark.parametrize(
    ("target", "option", "value"),
    [("st", "precision", "float"), ("c", "points", "12"), ("table", "joint", "elbow")],
)
def test_setting_that_the_target_does_not_use_is_refused(
    saved: Path, capsys: Capture, target: str, option: str, value: str
) -> None:
    arguments = ["export", str(saved / "model.toml"), str(saved / "runs"), "--to", target]
    assert main([*arguments, f"--{option}", value]) == 2
    (line,) = capsys.readouterr().err.strip().split("\n")
    assert f"the target {target} does not use the setting {option}" in line


def test_setting_of_a_target_is_refused_by_the_export_for_the_core(
    saved: Path, capsys: Capture
) -> None:
    out = saved / "friction.h"
    arguments = ["export", str(saved / "model.toml"), "--c", str(out), "--precision", "float"]
    assert main(arguments) == 2
    assert "does not use the setting precision" in capsys.readouterr().err
    assert not out.exists()


def test_settings_of_the_targets_exist() -> None:
    names = {field.name for field in fields(export.Settings)}
    assert {name for target in export.TARGETS.values() for name in target.settings} == names


def test_runs_without_motion_are_refused(model: jbf.Model) -> None:
    time_s = np.arange(0.0, 1.0, 0.01)
    still = jbf.Run.from_arrays(time_s, np.zeros(100), angle_rad=np.zeros(100))
    with pytest.raises(jbf.InputError):
        export.to(model, "table", [still])


def test_export_to_writes_all_files_next_to_each_other(tmp_path: Path) -> None:
    values = {"cogging.A": 0.5, "cogging.pitch": 1.0}
    model = jbf.Model(JOINT, "coulomb", ["cogging"], values)
    exported = export.to(model, "table", joint_runs())
    paths = exported.save(tmp_path / "joint.csv")
    assert [Path(path).name for path in paths] == ["joint.csv", "joint_cogging.csv"]
    assert (tmp_path / "joint.csv").read_text() == exported.text


def test_export_command_writes_file_and_ledger(saved: Path, capsys: Capture) -> None:
    out, json_file = saved / "table.csv", saved / "loss.json"
    arguments = ["export", str(saved / "model.toml"), str(saved / "runs"), "--to", "table"]
    assert main([*arguments, "--out", str(out), "--json", str(json_file)]) == 0
    printed = capsys.readouterr().out
    assert "loss" in printed
    assert str(out) in printed
    content = json.loads(json_file.read_text())
    schema = json.loads(SCHEMA.read_text(encoding="utf-8"))
    kind = {"$ref": "#/$defs/exported", "$defs": schema["$defs"]}
    jsonschema.validate(content, kind)
    model = jbf.Model.load(saved / "model.toml")
    runs = jbf.read_runs([saved / "runs"], model.rig)
    exported = export.to(model, "table", runs)
    assert content == exported.to_dict()
    assert out.read_text() == exported.text


def test_export_command_prints_the_main_file_alone_on_standard_output(
    saved: Path, capsys: Capture
) -> None:
    arguments = ["export", str(saved / "model.toml"), str(saved / "runs"), "--to", "table"]
    assert main([*arguments, "--out", "-"]) == 0
    assert capsys.readouterr().out.startswith("velocity_rad_s,torque_n_m\n")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--to", "table"], "no run"),
        (["runs", "--to", "table", "--max-loss", "1e-9"], "loss"),
        (["runs", "--to", "table", "--c", "-"], "--c"),
        (["--c", "-", "--max-loss", "0.1"], "--max-loss"),
        (["runs", "--rust", "-"], "RUN"),
    ],
)
def test_export_command_refuses_contradictory_arguments(
    saved: Path, monkeypatch: pytest.MonkeyPatch, capsys: Capture, arguments: list[str], words: str
) -> None:
    monkeypatch.chdir(saved)
    assert main(["export", "model.toml", *arguments]) == 2
    assert words in capsys.readouterr().err


def test_summary_repr_and_frame_of_an_export_state_its_loss(model: jbf.Model) -> None:
    exported = export.to(model, "table", joint_runs())
    for text in (exported.summary(), repr(exported), exported._repr_html_()):
        assert "N m" in text
    assert list(exported.to_frame()["rms"]) == [loss.rms for loss in exported.ledger.runs]
