"""`--hold-out`: runs that no fit sees."""

from __future__ import annotations

import json
from pathlib import Path

import jbf
import numpy as np
import pytest
from jbf.cli import main

LAW = ["--law", "coulomb"]
NOISE_N = 0.1


@pytest.fixture
def slides(tmp_path: Path) -> Path:
    """Four runs of a slide; in the last one the force is three times as large."""
    random = np.random.default_rng(5)
    time = np.arange(0.0, 20.0, 0.01)
    for k in range(4):
        v = 0.1 * np.sin((0.9 + 0.3 * k) * time + k)
        force = (3.0 if k == 3 else 1.0) * (2.0 * np.sign(v) + 15.0 * v)
        force += NOISE_N * random.standard_normal(len(time))
        jbf.Run.from_arrays(time, v, force, name=f"r{k}").write_csv(tmp_path / f"r{k}.csv")
    (tmp_path / "rig.toml").write_text("")
    return tmp_path


def test_runs_held_out_of_a_fit(slides: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = slides / "m.toml"
    rig, runs = str(slides / "rig.toml"), [str(p) for p in sorted(slides.glob("r?.csv"))]
    assert main(["fit", rig, *runs, *LAW, "--hold-out", "r3", "--out", str(out)]) == 0
    said = capsys.readouterr().out
    # The odd run was used for nothing: the parameters are those of the others.
    fitted = jbf.Model.load(out).parameters
    assert fitted["F_c_n"].value == pytest.approx(2.0, abs=0.02)
    expected = jbf.compare(jbf.Model.load(out), [jbf.read_run(runs[3])])
    assert "Held out (1 run, used for nothing else)" in said
    assert f"RMS {expected.rms_n:.4g} N" in said
    assert expected.rms_n > 20.0 * NOISE_N


def test_runs_held_out_of_a_diagnosis(slides: Path, capsys: pytest.CaptureFixture[str]) -> None:
    told = slides / "d.json"
    asked = ["diagnose", str(slides / "rig.toml"), str(slides), *LAW, "--json", str(told)]
    assert main([*asked, "--hold-out", "r1", "--hold-out", "*3.csv"]) == 0
    assert "Held out (2 runs" in capsys.readouterr().out
    found = json.loads(told.read_text())
    assert (found["verdict"], found["effects"]) == ("adequate", [])
    by_run = {run["run"]: run["rms_n"] for run in found["hold_out"]["runs"]}
    assert set(by_run) == {"r1", "r3"}
    assert by_run["r1"] == pytest.approx(NOISE_N, rel=0.1)
    assert by_run["r3"] > 20.0 * NOISE_N


@pytest.mark.parametrize(
    ("pattern", "says"),
    [("x*", "--hold-out x*: fits no run; there are r0, r1, r2, r3"), ("r*", "fits every run")],
)
def test_a_wrong_pattern_is_one_line(
    slides: Path, capsys: pytest.CaptureFixture[str], pattern: str, says: str
) -> None:
    out = slides / "m.toml"
    asked = ["fit", str(slides / "rig.toml"), str(slides), *LAW, "--hold-out", pattern]
    assert main([*asked, "--out", str(out)]) == 2
    assert says in capsys.readouterr().err
    assert not out.exists()
