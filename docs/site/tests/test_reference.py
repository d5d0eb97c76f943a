"""The pages of reference have all there is."""

from __future__ import annotations

import re

import commands
import jbf
import pytest
from jbf import control, plot
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
