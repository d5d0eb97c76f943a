"""The house keeps its rules: rooms import one way, each says what it is, no file outgrows it."""

from __future__ import annotations

import ast
import os
import subprocess
import sys
from pathlib import Path
from statistics import median

import jbf
import pytest

PACKAGE = Path(jbf.__file__).parent
ROOT = PACKAGE.parents[1]
ROOMS = (
    "records",
    "importing",
    "models",
    "estimation",
    "comparison",
    "diagnosis",
    "control",
    "export",
    "plot",
    "reporting",
    "workbench",
    "cli",
)
ABOVE = ("reporting", "workbench", "cli")
"""Reporting, and the rooms above it."""
LONGEST, USUAL = 400, 150


def _modules() -> list[Path]:
    return sorted(PACKAGE.rglob("*.py"))


def _imports(path: Path) -> list[ast.ImportFrom]:
    tree = ast.parse(path.read_text(encoding="utf-8"))
    return [node for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)]


@pytest.mark.skipif(not (ROOT / "pyproject.toml").is_file(), reason="needs the source tree")
def test_rooms_import_one_way() -> None:
    linter = Path(sys.executable).with_name("lint-imports")
    environment = {**os.environ, "PYTHONPATH": str(PACKAGE.parent)}
    done = subprocess.run(
        [linter, "--no-cache"], cwd=ROOT, env=environment, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout[-3000:]


def test_nothing_inside_is_taken_from_the_top() -> None:
    """The linter lets `from jbf import _core` pass; nothing else comes that way."""
    wrong = [
        f"{path.relative_to(PACKAGE)}: {alias.name}"
        for path in _modules()
        if path.name != "__init__.py"
        for node in _imports(path)
        if node.module == "jbf"
        for alias in node.names
        if alias.name != "_core"
    ]
    assert wrong == []


def test_reporting_is_reached_through_one_door() -> None:
    below = [p for p in _modules() if p.relative_to(PACKAGE).parts[0] not in ABOVE]
    named = [p.name for p in below if "jbf.reporting" in p.read_text() and p.name != "demo.py"]
    # Rooms' pages may tell of one another; the door itself opens late.
    assert set(named) <= {"results.py", "__init__.py"}


@pytest.mark.parametrize("room", ROOMS)
def test_a_room_says_what_comes_in_what_goes_out_and_what_it_may_import(room: str) -> None:
    page = ast.get_docstring(ast.parse((PACKAGE / room / "__init__.py").read_text()))
    assert page is not None
    for promise in ("Comes in:", "oes out:", "May import:"):
        assert promise in page, f"{room}: its page has no {promise!r}"
    assert page.count("\n") < 30


def test_files_are_short() -> None:
    lengths = {path: path.read_text().count("\n") for path in _modules()}
    assert not {path.name: n for path, n in lengths.items() if n > LONGEST}
    assert median(lengths.values()) < USUAL
