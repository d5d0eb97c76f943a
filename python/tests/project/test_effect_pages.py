"""The pages of docs/effects agree with the catalogue."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

import pytest
from jbf.models.catalogue import built_in

ROOT = Path(__file__).resolve().parents[3]


@pytest.fixture(scope="module")
def pages() -> ModuleType:
    """The script that writes the pages."""
    spec = importlib.util.spec_from_file_location("effect_pages", ROOT / "docs" / "effects.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


def test_page_and_picture_of_every_effect_are_up_to_date(pages: ModuleType) -> None:
    assert pages.stale() == [], "run docs/effects.py"


@pytest.mark.parametrize("name", ["drive_compliance", "dwell_stiction", "load_dependence"])
def test_effect_changes_each_curve_of_its_picture_by_more_than_five_percent(
    pages: ModuleType, name: str
) -> None:
    plane, along = pages.draw(built_in()[name]).axes
    for axes in (plane, along):
        changed, plain = (line.get_ydata() for line in axes.lines)
        assert max(abs(changed - plain)) > 0.05 * max(abs(plain))
