"""The demo, as a stranger runs it."""

from __future__ import annotations

from pathlib import Path

from jbf import Model
from jbf.demo import run


def test_the_demo_tells_the_whole_story(tmp_path: Path) -> None:
    said: list[str] = []
    d = run(tmp_path / "demo", said.append)
    assert d.verdict == "missing"
    assert set(d.effects) == {"coulomb_drag", "sensor_lag"}
    text = "\n".join(said)
    assert "adequate (nothing added)" in text
    assert "coulomb_drag: F_d" in text
    assert (tmp_path / "demo" / "report.html").stat().st_size > 50_000
    assert Model.load(tmp_path / "demo" / "model.toml") == d.model
