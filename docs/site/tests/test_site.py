"""Tests of the built site: no broken links, no external requests, and an offline search."""

from __future__ import annotations

import shutil
import threading
from collections.abc import Iterator
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

import pytest
from build import SITE
from built import faults

HTML = SITE / "html"
CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
needs_site = pytest.mark.skipif(not HTML.exists(), reason="not built: docs/site/build.py")


def _page(folder: Path, name: str, body: str) -> None:
    (folder / name).write_text(f"<html><body>{body}</body></html>", encoding="utf-8")


def test_site_check_lists_broken_links_missing_anchors_and_external_images(tmp_path: Path) -> None:
    _page(tmp_path, "a.html", "<h1 id=one>A</h1><a href=b.html#two>b</a><a href=c.html>c</a>")
    _page(tmp_path, "b.html", "<a href=a.html#one>a</a><img src=https://x.org/a.png>")
    problems = faults(tmp_path)
    assert sorted(problems) == [
        "a.html: b.html#two has no such anchor",
        "a.html: c.html is not there",
        "b.html: loads https://x.org/a.png",
    ]


@pytest.mark.parametrize(
    "tag",
    [
        "<script src='//cdn.org/x.js'></script>",
        "<link rel=stylesheet href='https://fonts.org/a.css'>",
        "<link rel=preconnect href='https://fonts.org'>",
        "<iframe src='http://x.org'></iframe>",
        "<img srcset='https://x.org/a.png 2x'>",
    ],
)
def test_site_check_lists_external_scripts_styles_frames_and_images(
    tmp_path: Path, tag: str
) -> None:
    _page(tmp_path, "a.html", tag)
    assert len(faults(tmp_path)) == 1


@needs_site
def test_built_site_has_no_broken_links_and_no_external_resources() -> None:
    assert faults(HTML, skip=("rust",)) == []


class _Quiet(SimpleHTTPRequestHandler):
    def log_message(self, *_: Any) -> None:
        pass


@pytest.fixture(scope="module")
def address() -> Iterator[str]:
    server = ThreadingHTTPServer(("127.0.0.1", 0), partial(_Quiet, directory=str(HTML)))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield f"http://127.0.0.1:{server.server_port}"
    server.shutdown()


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    sync_api = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    if CHROMIUM is None:
        pytest.skip("chromium is not installed")
    with sync_api.sync_playwright() as played:
        opened = played.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield opened
        opened.close()


@needs_site
@pytest.mark.parametrize("place", ["", "start/analyst/", "reference/python/", "why/failures/"])
def test_site_page_makes_no_external_request_and_fits_the_window(
    browser: Any, address: str, place: str
) -> None:
    page = browser.new_page(viewport={"width": 1280, "height": 900})
    requested: list[str] = []
    logged: list[str] = []
    page.on("request", lambda request: requested.append(request.url))
    page.on("console", lambda message: logged.append(message.text))
    page.goto(f"{address}/{place}", wait_until="networkidle")
    assert requested
    assert [url for url in requested if not url.startswith((address, "data:", "blob:"))] == []
    assert [text for text in logged if "error" in text.lower()] == []
    width = page.evaluate("document.documentElement.scrollWidth")
    assert width <= 1280, "hangs over"
    page.close()


@needs_site
def test_site_search_loads_its_index_without_external_requests(browser: Any, address: str) -> None:
    page = browser.new_page()
    requested: list[str] = []
    page.on("request", lambda request: requested.append(request.url))
    page.goto(address, wait_until="networkidle")
    page.keyboard.press("Control+k")
    page.wait_for_timeout(1000)
    assert f"{address}/search.json" in requested
    assert [url for url in requested if not url.startswith((address, "data:", "blob:"))] == []
    assert "eccentricity" in (HTML / "search.json").read_text(encoding="utf-8")
    page.close()
