"""The example programs run and reach their documented results."""

import runpy
from pathlib import Path

import jbf
import pytest
from input_checks import Capture

EXAMPLES = Path(__file__).resolve().parents[3] / "examples"


@pytest.mark.extended
def test_example_compensates_better_with_diagnosed_model(tmp_path: Path, capsys: Capture) -> None:
    main = runpy.run_path(str(EXAMPLES / "diagnose_then_compensate.py"))["main"]
    gains = main(tmp_path)
    assert "missing direction_asymmetry" in capsys.readouterr().out
    assert jbf.Model.load(tmp_path / "model.toml").effects == ("direction_asymmetry",)
    assert jbf.Model.load(tmp_path / "bare.toml").effects == ()
    assert min(gains.values()) > 1.0
    assert gains["velocity triangle"] > 1.5
