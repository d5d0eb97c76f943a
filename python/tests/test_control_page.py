"""docs/control.md's table of what helps when the model is wrong is what is found."""

from __future__ import annotations

import importlib
import re
from pathlib import Path

import pytest
from jbf.control import TASKS
from jbf.control.bench import thesis_model
from jbf.control.robustness import HARM, HELP, STRONG, cases, robustness

PAGE = Path(__file__).resolve().parents[2] / "docs" / "control.md"


def told() -> dict[str, float]:
    """Ratios of the page, by the name of the case."""
    section = PAGE.read_text(encoding="utf-8").partition("## When the model is wrong")[2]
    found = re.findall(r"\| `?([a-z_][\w %]*?)`? \| (\d\.\d{3}) ", section)
    return {name: float(ratio) for name, ratio in found}


def test_the_ratios_of_the_page_are_those_of_its_worst_row() -> None:
    """To the third decimal: every strength, every load and every gain is the one it was made
    with."""
    worst = {"position square": TASKS["position square"]}
    found = {o.name.removeprefix("hidden "): o.worst for o in robustness(tasks=worst)}
    assert found == pytest.approx(told(), abs=6e-4)
    assert max(found.values()) < HELP < 1.0 < HARM


def test_every_case_stands_on_the_page(monkeypatch: pytest.MonkeyPatch) -> None:
    """And every strength is of an effect that is hidden there."""
    module = importlib.import_module("jbf.control.robustness")
    monkeypatch.setattr(module, "misled", lambda base, seen: base)
    names = {case.name.removeprefix("hidden ") for case in cases(thesis_model(elastic="nothing"))}
    assert names == set(told())
    assert set(STRONG) <= names
