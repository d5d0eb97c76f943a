"""`jbf power`: what planned runs would show."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from by_hand import coulomb, four_runs
from jbf import Model, Rig, Run, fit, planned_power
from jbf.cli import main


@pytest.fixture
def plan(tmp_path: Path) -> Path:
    """Two motions of a slide, without friction."""
    folder = tmp_path / "plan"
    folder.mkdir()
    t = np.arange(0.0, 20.0, 0.02)
    for name, rate in (("slow", 0.5), ("fast", 3.0)):
        v = 0.1 * np.sin(rate * t)
        Run.from_arrays(t, v, position_m=np.cumsum(v) * 0.02).write_csv(folder / f"{name}.csv")
    (tmp_path / "rig.toml").write_text('[drive]\nmotion = "linear"\nfriction = "force"\n')
    return tmp_path


def test_a_rig_and_motions_are_enough(plan: Path, capsys: pytest.CaptureFixture[str]) -> None:
    rig, out = str(plan / "rig.toml"), plan / "power.json"
    command = ["power", rig, str(plan / "plan"), "--law", "coulomb", "--noise-n"]
    assert main([*command, "0.1", "--json", str(out)]) == 0
    said = capsys.readouterr().out
    assert "2 runs beside" in said
    assert "inertia_leak" in said
    rows = {row["effect"]: row for row in json.loads(out.read_text())["power"]}
    assert 0.0 < rows["inertia_leak"]["found_80"] < rows["inertia_leak"]["found_95"]
    # Half of the noise, half of the strength.
    assert main([*command, "0.05", "--json", str(out)]) == 0
    finer = {row["effect"]: row for row in json.loads(out.read_text())["power"]}
    half = rows["inertia_leak"]["found_80"] / 2.0
    assert finer["inertia_leak"]["found_80"] == pytest.approx(half, rel=0.15)


def test_a_fitted_model_knows_its_noise(plan: Path, capsys: pytest.CaptureFixture[str]) -> None:
    runs = four_runs(lambda t, v, a: coulomb(t, v, a) + 2.0 * a, noise_n=0.2)
    found = fit(Rig(), runs, ["inertia_leak"], law="coulomb")
    found.model.save(plan / "model.toml")
    assert main(["power", str(plan / "model.toml"), str(plan / "plan")]) == 0
    said = capsys.readouterr().out
    assert "coulomb" in said
    assert "inertia_leak" in said.splitlines()[0]
    assert "noise of 0.197 N" in said
    # What is said goes before what was fitted.
    assert main(["power", str(plan / "model.toml"), str(plan / "plan"), "--noise-n", "0.5"]) == 0
    assert "noise of 0.500 N" in capsys.readouterr().out
    planned = planned_power(found.model, runs, noise_n=0.2)
    assert "PlannedPower: 4 runs show" in repr(planned)
    assert "inertia_leak" not in [p.effect for p in planned.power]


def test_bad_input_is_one_line(plan: Path, capsys: pytest.CaptureFixture[str]) -> None:
    rig, runs = str(plan / "rig.toml"), str(plan / "plan")
    for arguments, words in (
        ([rig, runs, "--law", "coulomb"], "--noise-n is missing"),
        ([rig, runs, "--law", "coulomb", "--noise-n", "-1"], "-1 is not above zero"),
        ([rig, runs, "--law", "coulomb", "--noise-n", "nan"], "nan"),
        ([rig, str(plan / "none"), "--law", "coulomb", "--noise-n", "1"], "none"),
    ):
        assert main(["power", *arguments]) == 2
        said = capsys.readouterr()
        assert said.out == ""
        assert words in said.err
        assert said.err.count("\n") == 1
    with pytest.raises(ValueError, match="no run was given"):
        planned_power(Model(Rig(), "coulomb", (), {}), [], noise_n=0.1)
