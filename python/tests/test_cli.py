"""The commands: what they print, write and return."""

from __future__ import annotations

import json
import math
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import jbf
import jbf.diagnosis
import numpy as np
import pytest
from jbf.cli import COMMANDS, main
from jbf.diagnosis.result import Diagnosis
from jbf.reporting.json import json_text


@pytest.fixture
def model(campaign: Path, full_fit: jbf.Fit) -> Path:
    """A model file beside the campaign."""
    full_fit.model.save(campaign / "model.toml")
    return campaign / "model.toml"


@pytest.fixture
def instant_diagnosis(
    monkeypatch: pytest.MonkeyPatch, make_diagnosis: Callable[[str], Diagnosis]
) -> None:
    """`diagnose` that answers at once: the search has tests of its own."""

    def answer(rig: object, runs: list[jbf.Run], **options: object) -> Diagnosis:
        assert options["law"] == options["clock"] == "journal"
        assert len(runs) == 3
        return make_diagnosis("missing")

    monkeypatch.setattr(jbf.diagnosis, "diagnose", answer)


def test_help_names_every_command(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--help"]) == 0
    shown = capsys.readouterr().out
    assert all(f"\n    {name}" in shown for name in COMMANDS)
    for name in COMMANDS:
        assert main([name, "--help"]) == 0


def test_version(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--version"]) == 0
    assert capsys.readouterr().out == f"jbf {jbf.__version__}\n"


def test_effects(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["effects"]) == 0
    assert "coulomb_drag" in capsys.readouterr().out
    assert main(["effects", "coulomb_drag"]) == 0
    assert "F_d_n" in capsys.readouterr().out


def test_effects_json_is_strict(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["effects", "--json", "-"]) == 0

    def refuse(constant: str) -> None:
        raise AssertionError(constant)

    data = json.loads(capsys.readouterr().out, parse_constant=refuse)
    assert [page["name"] for page in data["effects"]] == list(jbf.effects())


def test_json_numbers() -> None:
    data = {"a": np.float64("nan"), "b": math.inf, "c": np.array([1, 2]), "d": (np.int64(3), -0.5)}
    assert json.loads(json_text(data)) == {"a": None, "b": "inf", "c": [1, 2], "d": [3, -0.5]}


def test_fit_writes_a_model(campaign: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = campaign / "fitted.toml"
    command = ["fit", str(campaign / "rig.toml"), str(campaign / "runs")]
    assert main([*command, "--effects", "coulomb_drag", "--out", str(out)]) == 0
    said = capsys.readouterr()
    assert "[[Parameters]]" in said.out
    assert said.err == ""
    drag = jbf.Model.load(out).parameters["coulomb_drag.F_d_n"]
    assert drag.value == pytest.approx(2.0, abs=0.15)


def test_fit_holds_what_is_fixed(campaign: Path) -> None:
    out = campaign / "fitted.toml"
    command = ["fit", str(campaign / "rig.toml"), str(campaign / "runs" / "*.csv")]
    command += ["--effects", "coulomb_drag", "--fix", "f_m=0.25", "--fix", "coulomb_drag.F_d=1"]
    assert main([*command, "--out", str(out)]) == 0
    fitted = jbf.Model.load(out)
    assert fitted.values[0] == 0.25
    assert fitted.values[-1] == 1.0


def test_compare(model: Path, campaign: Path, capsys: pytest.CaptureFixture[str]) -> None:
    runs = [str(path) for path in sorted((campaign / "runs").iterdir())]
    found, page = campaign / "c.json", campaign / "c.html"
    assert main(["compare", str(model), *runs, "--json", str(found), "--report", str(page)]) == 0
    said = capsys.readouterr()
    assert said.out.startswith("RMS 0.30")
    assert said.err == ""
    data = json.loads(found.read_text())
    assert data["rms_n"] == pytest.approx(0.3, abs=0.02)
    assert data["failures"] == []
    assert [run["run"] for run in data["runs"]] == ["sine_w0.5", "sine_w2.0", "stopgo"]
    assert page.read_text().startswith("<!doctype html>")


def test_json_to_stdout_stands_alone(
    model: Path, campaign: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["compare", str(model), str(campaign / "runs"), "--json", "-"]) == 0
    assert "rms_n" in json.loads(capsys.readouterr().out)


def test_predict_needs_no_friction(
    model: Path, campaign: Path, runs: list[jbf.Run], capsys: pytest.CaptureFixture[str]
) -> None:
    source = runs[0]
    motion, out = campaign / "motion.csv", campaign / "p.csv"
    jbf.Run.from_arrays(
        source.time_s, source.velocity_m_s, angle_rad=source.angle_rad, load_n=source.load_n
    ).write_csv(motion)
    assert main(["predict", str(model), str(motion), "--out", str(out)]) == 0
    header, *rows = out.read_text().splitlines()
    assert header == "time_s,friction_n"
    table = np.array([[float(cell) for cell in row.split(",")] for row in rows])
    assert np.array_equal(table[:, 0], source.time_s)
    assert np.array_equal(table[:, 1], jbf.Model.load(model).predict(source))
    capsys.readouterr()
    assert main(["predict", str(model), str(motion), "--out", "-"]) == 0
    assert capsys.readouterr().out == out.read_text()


@pytest.mark.usefixtures("instant_diagnosis")
def test_diagnose(campaign: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out, found, page = (campaign / name for name in ("m.toml", "d.json", "d.html"))
    command = ["diagnose", str(campaign / "rig.toml"), str(campaign / "runs")]
    command += ["--out", str(out), "--json", str(found), "--report", str(page)]
    assert main(command) == 0
    said = capsys.readouterr()
    assert said.out.startswith("Verdict: missing")
    assert said.err == ""
    data = json.loads(found.read_text())
    assert set(data) >= {
        "verdict", "effects", "alternatives", "steps", "failures", "unexplained",
        "next_experiment", "parameters",
    }  # fmt: skip
    assert data["effects"] == ["coulomb_drag"]
    assert set(data["steps"][0]) >= {"effects", "rms_n", "holdout_rms_n", "noise_n"}
    assert tuple(jbf.Model.load(out).effects) == ("coulomb_drag",)
    assert "Diagnosis: missing" in page.read_text()


def test_an_interrupt_is_quiet(
    campaign: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def interrupt(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(jbf.diagnosis, "diagnose", interrupt)
    out = campaign / "m.toml"
    command = ["diagnose", str(campaign / "rig.toml"), str(campaign / "runs"), "--out", str(out)]
    assert main(command) == 130
    assert capsys.readouterr() == ("", "jbf: interrupted\n")
    assert not out.exists()


def test_as_a_module() -> None:
    done = subprocess.run(
        [sys.executable, "-m", "jbf", "effects"], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0
    assert "coulomb_drag" in done.stdout
    assert done.stderr == ""


@pytest.mark.skipif(os.name != "posix", reason="pipes that close early are POSIX's")
def test_a_closed_pipe_is_no_error() -> None:
    read, write = os.pipe()
    os.close(read)
    done = subprocess.run(
        [sys.executable, "-m", "jbf", "effects"], stdout=write, stderr=subprocess.PIPE, check=False
    )
    os.close(write)
    assert done.stderr == b""
    assert done.returncode == 141


@pytest.mark.skipif(os.name != "posix", reason="needs a pseudo-terminal")
def test_progress_shows_on_a_terminal_only(campaign: Path) -> None:
    import pty

    ours, theirs = pty.openpty()
    command = [sys.executable, "-m", "jbf", "fit", str(campaign / "rig.toml")]
    command += [str(campaign / "runs"), "--out", str(campaign / "m.toml")]
    environment = {**os.environ, "TERM": "xterm", "COLUMNS": "80"}
    done = subprocess.run(
        command, stdout=subprocess.PIPE, stderr=theirs, env=environment, check=False
    )
    os.close(theirs)
    assert done.returncode == 0
    assert b"fitting" in os.read(ours, 65536)
    assert b"\x1b" not in done.stdout
    os.close(ours)


@pytest.mark.skipif(os.name != "posix", reason="needs a pseudo-terminal")
def test_what_is_printed_during_progress_stays_on_stdout() -> None:
    import pty

    ours, theirs = pty.openpty()
    code = "from jbf.cli.progress import shown\nwith shown('x') as tell: tell('y', 1, 2); print(7)"
    environment = {**os.environ, "TERM": "xterm"}
    done = subprocess.run(
        [sys.executable, "-c", code],
        stdout=subprocess.PIPE,
        stderr=theirs,
        env=environment,
        check=False,
    )
    os.close(theirs)
    os.close(ours)
    assert done.stdout == b"7\n"
