"""The pages of docs/effects say what the catalogue says."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

import pytest
from jbf.models.catalogue import built_in

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def pages() -> ModuleType:
    """The script that writes them."""
    spec = importlib.util.spec_from_file_location("effect_pages", ROOT / "docs" / "effects.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


def test_every_effect_has_its_page_and_picture(pages: ModuleType) -> None:
    assert pages.stale() == [], "run docs/effects.py"


def test_a_changed_catalogue_makes_a_page_stale(
    pages: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    without = {name: e for name, e in built_in().items() if name != "sensor_lag"}
    monkeypatch.setattr(pages, "catalogue", lambda: without)
    assert pages.stale() == ["README.md", "sensor_lag.md", "sensor_lag.png"]


@pytest.mark.parametrize("name", ["drive_compliance", "dwell_stiction", "load_dependence"])
def test_a_picture_shows_the_effect(pages: ModuleType, name: str) -> None:
    plane, along = pages.draw(built_in()[name]).axes
    for axes in (plane, along):
        changed, plain = (line.get_ydata() for line in axes.lines)
        assert max(abs(changed - plain)) > 0.05 * max(abs(plain))
