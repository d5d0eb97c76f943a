"""The pages of reference have all there is."""

from __future__ import annotations

import re

import commands
import figures
import jbf
import pytest
from jbf import control, plot
from jbf.reporting.advice import advice_on
from pages import DOCS

PYTHON = (DOCS / "reference" / "python.md").read_text(encoding="utf-8")


def test_commands_are_what_the_parsers_say() -> None:
    assert commands.PAGE.read_text(encoding="utf-8") == commands.page(), "docs/site/commands.py"


def test_every_public_name_is_on_the_page_of_python() -> None:
    named = set(re.findall(r"^::: jbf\.(\w+)$", PYTHON, re.MULTILINE))
    assert named == {*jbf.__all__} - {"__version__"}


@pytest.mark.parametrize("room", [control, plot])
def test_every_public_function_of_a_room_is_there(room: object) -> None:
    names = [n for n in room.__all__ if callable(getattr(room, n))]  # type: ignore[attr-defined]
    for name in names:
        assert re.search(rf"\b{name}\b", PYTHON), name


def test_every_picture_has_a_script_that_makes_it() -> None:
    patterns = [p for written in figures.SCRIPTS.values() for p in written] + [*figures.NOT_ANEW]
    pictures = [p for kind in ("png", "svg") for p in DOCS.rglob(f"*.{kind}")]
    assert pictures
    for picture in pictures:
        name = picture.relative_to(DOCS)
        assert any(name.match(pattern) for pattern in patterns), name


def test_every_script_of_docs_is_called() -> None:
    scripts = {f"docs/{p.name}" for p in DOCS.glob("*.py")}
    assert scripts - {"docs/control_figures.py"} <= set(figures.SCRIPTS)  # it prints, draws nothing


def test_the_gallery_has_the_advice_of_the_reports() -> None:
    page = " ".join((DOCS / "why" / "failures.md").read_text(encoding="utf-8").split())
    for kind in ("velocity", "direction", "acceleration", "angle", "time", "run", "frequency"):
        assert f"{advice_on(kind).causes}." in page, kind
        assert (DOCS / "images" / "failures" / f"{kind}.png").exists()
