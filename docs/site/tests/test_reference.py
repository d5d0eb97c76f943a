"""Tests that the reference pages are complete and up to date."""

from __future__ import annotations

import re

import commands
import figures
import jbf
import pytest
from jbf import control, export, plot
from jbf.reporting.advice import advice_on
from pages import DOCS

PYTHON = (DOCS / "reference" / "python.md").read_text(encoding="utf-8")


def test_command_reference_is_up_to_date_with_the_parsers() -> None:
    assert commands.PAGE.read_text(encoding="utf-8") == commands.page(), "docs/site/commands.py"


def test_python_reference_lists_every_public_name() -> None:
    named = set(re.findall(r"^::: jbf\.(\w+)$", PYTHON, re.MULTILINE))
    assert named == {*jbf.__all__} - {"__version__"}


@pytest.mark.parametrize("module", [control, export, plot])
def test_python_reference_names_every_public_function_of_a_package(module: object) -> None:
    names = [n for n in module.__all__ if callable(getattr(module, n))]  # type: ignore[attr-defined]
    for name in names:
        assert re.search(rf"\b{name}\b", PYTHON), name


def test_every_picture_of_the_docs_is_listed_with_its_script_or_as_fixed() -> None:
    patterns = [p for written in figures.SCRIPTS.values() for p in written] + [*figures.NOT_ANEW]
    pictures = [p for kind in ("png", "svg") for p in DOCS.rglob(f"*.{kind}")]
    assert pictures
    for picture in pictures:
        name = picture.relative_to(DOCS)
        assert any(name.match(pattern) for pattern in patterns), name


def test_every_script_of_the_docs_folder_is_listed_as_a_figure_script() -> None:
    scripts = {f"docs/{p.name}" for p in DOCS.glob("*.py")}
    assert scripts - {"docs/control_figures.py"} <= set(figures.SCRIPTS)  # it prints, draws nothing


def test_failure_gallery_contains_the_causes_and_the_picture_of_every_failure() -> None:
    page = " ".join((DOCS / "why" / "failures.md").read_text(encoding="utf-8").split())
    for kind in ("velocity", "direction", "acceleration", "angle", "time", "run", "frequency"):
        assert f"{advice_on(kind).causes}." in page, kind
        assert (DOCS / "images" / "failures" / f"{kind}.png").exists()
