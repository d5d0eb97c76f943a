"""A report in a browser: nothing is fetched, nothing complains, nothing hangs over; the first
screen says what was found, light and dark; it prints."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from jbf import Comparison, compare
from jbf.diagnosis.result import Diagnosis

sync_api = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="chromium is not installed")
SCREEN = {"width": 1280, "height": 800}
MOST_BYTES = 5e6
RUNS = 46


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with sync_api.sync_playwright() as played:
        # Where the tests run as root, Chromium has no sandbox.
        opened = played.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield opened
        opened.close()


@pytest.fixture(scope="module")
def report(
    make_diagnosis: Callable[[str], Diagnosis], tmp_path_factory: pytest.TempPathFactory
) -> Path:
    """The report of a campaign of many runs with long names."""
    found = make_diagnosis("missing")
    runs = [p.run for p in found.before.campaign.prepared]
    several = [
        replace(runs[i % len(runs)], name=f"{i:02d}_a_run_with_a_long_name_{i % 7}")
        for i in range(RUNS)
    ]

    def again(comparison: Comparison) -> Comparison:
        return compare(comparison.model, [run.select(slice(0, 400)) for run in several])

    many = replace(found, before=again(found.before), after=again(found.after))
    many = replace(many, failures=many.before.failures)
    path = tmp_path_factory.mktemp("report") / "report.html"
    many.report(path)
    return path


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_a_report_in_a_browser(browser: Any, report: Path, scheme: str) -> None:
    assert report.stat().st_size < MOST_BYTES
    page = browser.new_page(viewport=SCREEN, color_scheme=scheme)
    said: list[str] = []
    asked: list[str] = []
    page.on("console", lambda message: said.append(message.text))
    page.on("pageerror", lambda error: said.append(str(error)))
    page.on("request", lambda request: asked.append(request.url))
    page.goto(report.as_uri())
    assert said == []
    assert [url for url in asked if not url.startswith(("file:", "data:"))] == []
    assert page.evaluate("document.documentElement.scrollWidth") <= SCREEN["width"]
    over = "[...document.querySelectorAll('.wide')].filter(e => e.scrollWidth > e.clientWidth + 1)"
    assert page.evaluate(f"{over}.length") == 0
    for what in ("h1", "#ledger svg", "#before svg"):
        box = page.locator(what).first.bounding_box()
        assert box["y"] >= 0
        assert box["y"] + box["height"] <= SCREEN["height"]
        assert box["height"] > 20
    ground, ink = (
        page.evaluate(f"getComputedStyle(document.querySelector('{what}')).{how}")
        for what, how in (("body", "backgroundColor"), ("#ledger text", "fill"))
    )
    assert (_light(ground), _light(ink)) == ((True, False) if scheme == "light" else (False, True))
    page.close()


def test_a_report_prints_dark_on_white_within_the_paper(browser: Any, report: Path) -> None:
    page = browser.new_page(viewport={"width": 720, "height": 1000}, color_scheme="dark")
    page.goto(report.as_uri())
    page.emulate_media(media="print", color_scheme="dark")
    ink = page.evaluate("getComputedStyle(document.querySelector('h1')).color")
    assert not _light(ink)
    assert page.evaluate("document.documentElement.scrollWidth") <= 720
    assert page.pdf(format="A4").startswith(b"%PDF")
    page.close()


def _light(colour: str) -> bool:
    """Of `rgb(r, g, b)`."""
    levels = [float(x) for x in colour[colour.index("(") + 1 : -1].split(",")[:3]]
    return sum(levels) > 3 * 128
