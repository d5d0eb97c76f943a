"""The pages of docs/effects agree with the catalogue."""

import runpy
from pathlib import Path

import pytest
from jbf.models.catalogue import built_in

SCRIPT = Path(__file__).resolve().parents[3] / "docs" / "effects.py"
PAGES = runpy.run_path(str(SCRIPT))


def test_page_and_picture_of_every_effect_are_up_to_date() -> None:
    assert PAGES["stale"]() == [], "run docs/effects.py"


@pytest.mark.parametrize("name", ["drive_compliance", "dwell_stiction", "load_dependence"])
def test_effect_changes_each_curve_of_its_picture_by_over_five_percent(name: str) -> None:
    plane, along = PAGES["draw"](built_in()[name]).axes
    for axes in (plane, along):
        changed, plain = (line.get_ydata() for line in axes.lines)
        assert max(abs(changed - plain)) > 0.05 * max(abs(plain))
