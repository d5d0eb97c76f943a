"""The examples run, and say what the docs say."""

from __future__ import annotations

import runpy
from pathlib import Path

import jbf
import pytest

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"


def test_diagnose_then_compensate(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    main = runpy.run_path(str(EXAMPLES / "diagnose_then_compensate.py"))["main"]
    gains = main(tmp_path)
    assert "missing direction_asymmetry" in capsys.readouterr().out
    assert jbf.Model.load(tmp_path / "model.toml").effects == ("direction_asymmetry",)
    assert jbf.Model.load(tmp_path / "bare.toml").effects == ()
    assert min(gains.values()) > 1.0
    assert gains["velocity triangle"] > 1.5
