"""`jbf fit`, `compare`, `predict` and `effects`: results, files, standard output and exit codes."""

import json
import os
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import jbf
import numpy as np
import pytest
from conftest import DRAG_N, NOISE_N
from input_checks import Capture
from jbf.cli import COMMANDS, main
from jbf.cli.progress import Estimate, shown
from jbf.estimation.work import TimeLimit

posix = pytest.mark.skipif(os.name != "posix", reason="needs pipes and terminals of POSIX")


@pytest.fixture
def model(campaign: Path, full_fit: jbf.Fit) -> Path:
    """The fitted model with the simulated effect, saved in the folder of the campaign."""
    full_fit.model.save(campaign / "model.toml")
    return campaign / "model.toml"


def test_help_option_lists_every_command(capsys: Capture) -> None:
    assert main(["--help"]) == 0
    printed = capsys.readouterr()
    assert all(f"\n    {name}" in printed.out for name in COMMANDS)
    assert printed.err == ""


def test_version_option_prints_the_version_of_the_package(capsys: Capture) -> None:
    assert main(["--version"]) == 0
    printed = capsys.readouterr()
    assert (printed.out, printed.err) == (f"jbf {jbf.__version__}\n", "")


def test_effects_command_prints_catalogue_or_parameters_of_one_effect(capsys: Capture) -> None:
    assert main(["effects"]) == 0
    assert "coulomb_drag" in capsys.readouterr().out
    assert main(["effects", "coulomb_drag"]) == 0
    assert "F_d" in capsys.readouterr().out


def test_effects_command_lists_effects_that_a_law_excludes_separately(capsys: Capture) -> None:
    assert main(["effects", "--law", "lugre"]) == 0
    applicable, refused = capsys.readouterr().out.split("[not with lugre")
    assert "sensor_lag" in applicable
    assert "thermal_thinning" not in applicable
    assert "thermal_thinning" in refused
    assert "presliding" in refused


def test_effects_json_has_every_effect_and_neither_nan_nor_infinity(capsys: Capture) -> None:
    assert main(["effects", "--json", "-"]) == 0

    def refuse(constant: str) -> None:
        raise AssertionError(constant)

    data = json.loads(capsys.readouterr().out, parse_constant=refuse)
    assert [page["name"] for page in data["effects"]] == list(jbf.effects())


def test_fit_command_writes_model_with_the_hidden_effect(campaign: Path, capsys: Capture) -> None:
    out = campaign / "fitted.toml"
    command = ["fit", str(campaign / "rig.toml"), str(campaign / "runs")]
    assert main([*command, "--effects", "coulomb_drag", "--out", str(out)]) == 0
    printed = capsys.readouterr()
    assert "[[Parameters]]" in printed.out
    assert printed.err == ""
    drag = jbf.Model.load(out).parameters["coulomb_drag.F_d"]
    assert drag.stderr is not None
    assert abs(drag.value - DRAG_N) < 4.0 * drag.stderr


def test_fit_command_without_out_prints_its_report(campaign: Path, capsys: Capture) -> None:
    files = set(campaign.rglob("*"))
    assert main(["fit", str(campaign / "rig.toml"), str(campaign / "runs")]) == 0
    assert "[[Parameters]]" in capsys.readouterr().out
    assert set(campaign.rglob("*")) == files


def test_parameters_given_with_the_fix_option_keep_their_values(campaign: Path) -> None:
    out = campaign / "fitted.toml"
    command = ["fit", str(campaign / "rig.toml"), str(campaign / "runs" / "*.csv")]
    command += ["--effects", "coulomb_drag", "--fix", "f_m=0.25", "--fix", "coulomb_drag.F_d=1"]
    assert main([*command, "--out", str(out)]) == 0
    parameters = jbf.Model.load(out).parameters
    assert parameters["f_m"].value == 0.25
    assert parameters["coulomb_drag.F_d"].value == 1.0


@pytest.mark.parametrize(("interval", "limit"), [("1:1.5", 1.5), ("2.5:", 2.5)])
def test_estimate_stays_within_the_bounds_option(
    campaign: Path, interval: str, limit: float
) -> None:
    out = campaign / "fitted.toml"
    command = ["fit", str(campaign / "rig.toml"), str(campaign / "runs"), "--out", str(out)]
    bounds = f"coulomb_drag.F_d={interval}"
    assert main([*command, "--effects", "coulomb_drag", "--bounds", bounds]) == 0
    # The hidden drag is outside the bounds.
    assert jbf.Model.load(out).parameters["coulomb_drag.F_d"].value == pytest.approx(limit)


def test_compare_command_writes_json_and_page(model: Path, campaign: Path, capsys: Capture) -> None:
    runs = [str(path) for path in sorted((campaign / "runs").iterdir())]
    result, page = campaign / "c.json", campaign / "c.html"
    assert main(["compare", str(model), *runs, "--json", str(result), "--report", str(page)]) == 0
    printed = capsys.readouterr()
    assert printed.out.startswith("RMS 0.30")
    assert printed.err == ""
    data = json.loads(result.read_text())
    assert data["rms"] == pytest.approx(NOISE_N, abs=0.02)
    assert data["failures"] == []
    assert [run["run"] for run in data["runs"]] == ["sine_w0.5", "sine_w2.0", "stopgo"]
    assert page.read_text().startswith("<!doctype html>")


def test_json_on_stdout_replaces_the_report(model: Path, campaign: Path, capsys: Capture) -> None:
    assert main(["compare", str(model), str(campaign / "runs"), "--json", "-"]) == 0
    assert "rms" in json.loads(capsys.readouterr().out)


def test_predict_command_accepts_motion_without_friction(
    model: Path, campaign: Path, runs: Any, capsys: Capture
) -> None:
    source = runs[0]
    motion, out = campaign / "motion.csv", campaign / "p.csv"
    replace(source, friction=None).write_csv(motion)
    assert main(["predict", str(model), str(motion), "--out", str(out)]) == 0
    assert out.read_text().startswith("time_s,friction_n\n")
    table = np.loadtxt(out, delimiter=",", skiprows=1)
    assert np.array_equal(table[:, 0], source.time_s)
    assert np.array_equal(table[:, 1], jbf.Model.load(model).predict(source))
    for options in ([], ["--out", "-"]):
        capsys.readouterr()
        assert main(["predict", str(model), str(motion), *options]) == 0
        assert capsys.readouterr().out == out.read_text()


def test_predict_warns_of_a_too_fast_film(tmp_path: Path, runs: Any, capsys: Capture) -> None:
    rig = jbf.Rig.thesis("4.2")
    jbf.Model(rig, parameters={"U_tr": 100.0}).save(tmp_path / "fast.toml")
    runs[0].write_csv(tmp_path / "run.csv")
    files = [str(tmp_path / name) for name in ("fast.toml", "run.csv", "out.csv")]
    assert main(["predict", *files[:2], "--out", files[2]]) == 0
    message = capsys.readouterr().err
    assert message.startswith("jbf: the film of this model responds at ")
    assert message.count("\n") == 1


@posix
def test_command_ends_without_a_message_if_its_output_pipe_is_closed() -> None:
    read, write = os.pipe()
    os.close(read)
    command = [sys.executable, "-m", "jbf", "effects"]
    done = subprocess.run(command, stdout=write, stderr=subprocess.PIPE)
    os.close(write)
    assert (done.returncode, done.stderr) == (141, b"")


def test_progress_is_logged_in_lines_where_stderr_is_not_a_terminal(capsys: Capture) -> None:
    with shown("starting", log_interval_s=0.05) as report:
        time.sleep(0.2)
        report("run [a]", 3, 10)
        time.sleep(0.2)
    lines = capsys.readouterr().err.splitlines()
    assert lines[0].startswith("jbf: starting")
    assert "run [a]" in lines[-1]
    assert "3 of 10" in lines[-1]


def test_remaining_time_is_estimated_from_the_completed_share() -> None:
    now = [0.0]
    estimate = Estimate(clock=lambda: now[0])
    assert estimate.words() == ""
    estimate.report("fitting again", 0, 40)
    now[0] = 10.0
    estimate.report("fitting again", 10, 40)
    assert "30 s" in estimate.words()
    now[0] = 15.0
    assert "25 s" in estimate.words()
    now[0] = 60.0
    assert estimate.words() == ""


def test_remaining_time_of_a_round_covers_its_later_stages() -> None:
    now = [0.0]
    stages = {"first": (0.0, 0.2), "second": (0.2, 0.8)}
    estimate = Estimate(stages, TimeLimit(100.0, lambda: now[0]), lambda: now[0])
    estimate.report("first a", 0, 2)
    now[0] = 2.0
    estimate.report("first b", 1, 2)
    assert "18 s" in estimate.words()
    now[0] = 10.0
    estimate.report("second a", 1, 2)
    assert "7 s" in estimate.words()
    assert "90 s" in estimate.words() or "2 min" in estimate.words()
    # The next round begins anew.
    estimate.report("first a", 0, 2)
    now[0] = 12.0
    estimate.report("first b", 1, 2)
    assert "18 s" in estimate.words()


@posix
def test_progress_is_shown_on_the_terminal_but_not_on_standard_output(campaign: Path) -> None:
    import pty

    ours, theirs = pty.openpty()
    command = [sys.executable, "-m", "jbf", "fit", str(campaign / "rig.toml")]
    command += [str(campaign / "runs"), "--out", str(campaign / "m.toml")]
    terminal = {**os.environ, "TERM": "xterm", "COLUMNS": "80"}
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=theirs, env=terminal)
    os.close(theirs)
    assert done.returncode == 0
    assert b"fitting" in os.read(ours, 65536)
    assert b"\x1b" not in done.stdout
    assert b"[[Parameters]]" in done.stdout
    os.close(ours)
