"""The HTML pages: whole, self-contained, escaped."""

from __future__ import annotations

import base64
import re
from collections.abc import Callable
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import pytest
from jbf import Fit, Run, compare
from jbf.diagnosis.result import Diagnosis
from jbf.errors import InputError

VOID = {"meta", "img", "br", "link"}


class Balance(HTMLParser):
    """Collects what is left open, and what the page would fetch."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.fetched: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.fetched += [v or "" for k, v in attrs if k in ("src", "href")]
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag


def checked(page: str) -> Balance:
    balance = Balance()
    balance.feed(page)
    assert balance.open == []
    for address in balance.fetched:
        head, _, data = address.partition(",")
        assert head == "data:image/png;base64"
        assert base64.b64decode(data).startswith(b"\x89PNG")
    return balance


@pytest.mark.parametrize("verdict", ["adequate", "missing", "ambiguous", "unexplained"])
def test_diagnosis(
    verdict: str, make_diagnosis: Callable[[str], Diagnosis], tmp_path: Path
) -> None:
    diagnosis = make_diagnosis(verdict)
    diagnosis.save_html(tmp_path / "d.html")
    page = (tmp_path / "d.html").read_text()
    assert checked(page).fetched
    headings = re.findall(r"<h2>(.*?)</h2>", page)
    wanted = ["The error falling", "Where the bare law fails", "Candidates tried"]
    wanted += ["What was added"] * bool(diagnosis.effects)
    wanted += ["What remains", "Parameters of the final model", "Each run"]
    assert headings == wanted
    assert f"Diagnosis: {verdict}" in page
    assert ("record a run at twice the load" in page) == (verdict == "ambiguous")
    assert [p.name for p in tmp_path.iterdir()] == ["d.html"]


def test_comparison(bare_fit: Fit, runs: list[Run], tmp_path: Path) -> None:
    comparison = compare(bare_fit.model, runs)
    comparison.report(tmp_path / "c.html")
    page = (tmp_path / "c.html").read_text()
    assert len(checked(page).fetched) == 2
    assert "numpy" in page
    assert all(run.name in page for run in runs)


def test_names_of_runs_cannot_break_the_page(
    bare_fit: Fit, runs: list[Run], tmp_path: Path
) -> None:
    evil = [replace(run, name=f"<script>$x^{{$</script>{i}") for i, run in enumerate(runs)]
    compare(bare_fit.model, evil).save_html(tmp_path / "c.html")
    page = (tmp_path / "c.html").read_text()
    checked(page)
    assert "<script>" not in page
    assert "&lt;script&gt;" in page


def test_no_folder_no_page(bare_fit: Fit, runs: list[Run], tmp_path: Path) -> None:
    with pytest.raises(InputError, match="folder does not exist"):
        compare(bare_fit.model, runs).save_html(tmp_path / "no" / "c.html")
