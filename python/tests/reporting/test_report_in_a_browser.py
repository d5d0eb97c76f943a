"""A report in a browser: network requests, layout, colour schemes and print."""

import shutil
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from by_hand import diagnosis_by_hand
from jbf import Comparison, compare

sync_api = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="chromium is not installed")
SCREEN = {"width": 1280, "height": 800}
MOST_BYTES = 5e6
RUNS = 46


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with sync_api.sync_playwright() as playwright:
        # Chromium has no sandbox if the tests run as root.
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield browser
        browser.close()


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The report of a campaign of many runs with long names."""
    diagnosis = diagnosis_by_hand("missing")
    runs = [p.run for p in diagnosis.before.campaign.prepared]
    names = [f"{i:02d}_a_run_with_a_long_name_{i % 7}" for i in range(RUNS)]
    many = [replace(runs[i % len(runs)], name=name) for i, name in enumerate(names)]

    def repeated(comparison: Comparison) -> Comparison:
        return compare(comparison.model, [run.select(slice(0, 400)) for run in many])

    before, after = repeated(diagnosis.before), repeated(diagnosis.after)
    path = tmp_path_factory.mktemp("report") / "report.html"
    replace(diagnosis, before=before, after=after, failures=before.failures).save_html(path)
    return path


@pytest.mark.extended
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_report_fits_the_screen_width_and_loads_no_external_files(
    browser: Any, report: Path, scheme: str
) -> None:
    assert report.stat().st_size < MOST_BYTES
    page = browser.new_page(viewport=SCREEN, color_scheme=scheme)
    messages: list[str] = []
    requests: list[str] = []
    page.on("console", lambda message: messages.append(message.text))
    page.on("pageerror", lambda error: messages.append(str(error)))
    page.on("request", lambda request: requests.append(request.url))
    page.goto(report.as_uri())
    assert messages == []
    assert [url for url in requests if not url.startswith(("file:", "data:"))] == []
    assert page.evaluate("document.documentElement.scrollWidth") <= SCREEN["width"]
    over = "[...document.querySelectorAll('.wide')].filter(e => e.scrollWidth > e.clientWidth + 1)"
    assert page.evaluate(f"{over}.length") == 0
    # The verdict, the ledger and the plot of the base law are visible without scrolling.
    for selector in ("h1", "#ledger svg", "#before svg"):
        box = page.locator(selector).first.bounding_box()
        assert box["y"] >= 0
        assert box["y"] + box["height"] <= SCREEN["height"]
        assert box["height"] > 20
    background, text = (
        page.evaluate(f"getComputedStyle(document.querySelector('{selector}')).{style}")
        for selector, style in (("body", "backgroundColor"), ("#ledger text", "fill"))
    )
    is_light = (light(background), light(text))
    assert is_light == ((True, False) if scheme == "light" else (False, True))
    page.close()


@pytest.mark.extended
def test_printed_report_has_dark_headings_and_fits_the_page(browser: Any, report: Path) -> None:
    page = browser.new_page(viewport={"width": 720, "height": 1000}, color_scheme="dark")
    page.goto(report.as_uri())
    page.emulate_media(media="print", color_scheme="dark")
    ink = page.evaluate("getComputedStyle(document.querySelector('h1')).color")
    assert not light(ink)
    assert page.evaluate("document.documentElement.scrollWidth") <= 720
    assert page.pdf(format="A4").startswith(b"%PDF")
    page.close()


def light(colour: str) -> bool:
    """Return whether a colour of the form `rgb(r, g, b)` is light."""
    levels = [float(x) for x in colour[colour.index("(") + 1 : -1].split(",")[:3]]
    return sum(levels) > 3 * 128
