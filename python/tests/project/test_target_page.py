"""The page of export targets agrees with the ledgers of exports."""

import runpy
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]
SCRIPT = ROOT / "docs" / "targets.py"


@pytest.mark.extended
@pytest.mark.filterwarnings("ignore")
def test_page_of_export_targets_is_up_to_date() -> None:
    page = runpy.run_path(str(SCRIPT))
    assert page["PAGE"].read_text(encoding="utf-8") == page["page"](), "run docs/targets.py"
