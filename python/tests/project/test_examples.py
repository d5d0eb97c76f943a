"""The example programs run and reach their documented results."""

from __future__ import annotations

import runpy
from pathlib import Path

import jbf
import pytest

EXAMPLES = Path(__file__).resolve().parents[3] / "examples"


@pytest.mark.extended
def test_example_compensates_better_with_the_diagnosed_model_than_with_the_base_law(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    main = runpy.run_path(str(EXAMPLES / "diagnose_then_compensate.py"))["main"]
    gains = main(tmp_path)
    assert "missing direction_asymmetry" in capsys.readouterr().out
    assert jbf.Model.load(tmp_path / "model.toml").effects == ("direction_asymmetry",)
    assert jbf.Model.load(tmp_path / "bare.toml").effects == ()
    assert min(gains.values()) > 1.0
    assert gains["velocity triangle"] > 1.5
