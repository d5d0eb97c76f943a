"""`jbf demo`: diagnosis of the packaged data, and the suggested next command."""

from pathlib import Path

import pytest
from jbf import Model
from jbf.cli.demo import called
from jbf.demo import run


@pytest.mark.extended
def test_demo_identifies_the_hidden_effects_and_writes_report_and_model(tmp_path: Path) -> None:
    demo = run(tmp_path / "demo")
    d = demo.diagnosis
    assert d.verdict == "missing"
    assert set(d.effects) == {"coulomb_drag", "sensor_lag"}
    assert demo.without_effects.verdict == "adequate"
    assert demo.after.rms < 0.5 * demo.before.rms
    lines = demo.text(command="bin/jbf").splitlines()
    assert len(lines) <= 30
    # The last line is the suggested next command.
    assert lines[-1].endswith(f"bin/jbf workbench {tmp_path / 'demo'}")
    assert d.summary(full=True) in demo.text(full=True)
    assert (tmp_path / "demo" / "report.html").stat().st_size > 50_000
    assert Model.load(tmp_path / "demo" / "model.toml") == d.model


def test_suggested_command_has_path_of_jbf_unless_on_search_path(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    program = tmp_path / "my venv" / "bin" / "jbf"
    program.parent.mkdir(parents=True)
    program.write_text("#!/bin/sh\n")
    program.chmod(0o755)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PATH", "/usr/bin")
    assert called(str(program)) == "'my venv/bin/jbf'"
    monkeypatch.setenv("PATH", str(program.parent))
    assert called(str(program)) == "jbf"
    assert called("/somewhere/jbf/__main__.py").endswith(" -m jbf")
