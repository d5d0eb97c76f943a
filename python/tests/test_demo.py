"""The demo, as a stranger runs it."""

from __future__ import annotations

from pathlib import Path

import pytest
from jbf import Model
from jbf.cli.demo import called
from jbf.demo import run


def test_the_demo_tells_the_whole_story(tmp_path: Path) -> None:
    said: list[str] = []
    d = run(tmp_path / "demo", said.append, jbf="bin/jbf")
    assert d.verdict == "missing"
    assert set(d.effects) == {"coulomb_drag", "sensor_lag"}
    text = "\n".join(said)
    assert "adequate (nothing added)" in text
    assert "coulomb_drag: F_d" in text
    # The last line is what to type next.
    assert text.splitlines()[-1] == f"  bin/jbf workbench {tmp_path / 'demo'}"
    assert (tmp_path / "demo" / "report.html").stat().st_size > 50_000
    assert Model.load(tmp_path / "demo" / "model.toml") == d.model


def test_the_demo_says_the_command_as_it_can_be_typed(
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
