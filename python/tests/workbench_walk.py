"""A page of the workbench in headless Chromium that collects all console messages."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from jbf.workbench import vendored

if TYPE_CHECKING:
    from playwright.sync_api import Page

BROWSERS = ("chromium", "chromium-browser", "google-chrome")
PATIENCE_MS = 120_000.0


def browser() -> str | None:
    """Path of an installed Chromium or Chrome."""
    return next((path for name in BROWSERS if (path := shutil.which(name))), None)


def why_not() -> str | None:
    """Reason why browser tests cannot run here; None if they can."""
    try:
        import playwright.sync_api  # noqa: F401
    except ImportError:
        return "browser tests need: pip install playwright"
    if browser() is None:
        return "browser tests need: apt-get install chromium"
    if not vendored.is_complete():
        return "browser tests need: python -m jbf.workbench.vendored"
    return None


@contextmanager
def served(folder: Path, *more: str) -> Iterator[str]:
    """Run `jbf workbench FOLDER` in a separate process and return its address."""
    command = [sys.executable, "-m", "jbf", "workbench", str(folder), "--no-browser", *more]

    def interruptible() -> None:
        signal.signal(signal.SIGINT, signal.SIG_DFL)

    process = subprocess.Popen(
        command,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        preexec_fn=interruptible if os.name == "posix" else None,
    )
    assert process.stdout is not None
    try:
        yield process.stdout.readline().strip()
    finally:
        process.send_signal(signal.SIGINT)
        process.wait(30)
        rest = process.stdout.read()
    assert "Traceback" not in rest, rest


class Messages:
    """Console errors of a page, and requests to other hosts."""

    def __init__(self, page: Page) -> None:
        self.complaints: list[str] = []
        self.outside: list[str] = []
        page.on("console", self._console)
        page.on("pageerror", lambda error: self.complaints.append(str(error)))
        page.on("request", lambda request: self._requested(request.url))

    def _console(self, message: object) -> None:
        if getattr(message, "type", "") in ("error", "warning"):
            self.complaints.append(str(getattr(message, "text", message)))

    def _requested(self, url: str) -> None:
        if not url.startswith(("http://127.0.0.1:", "blob:http://127.0.0.1:", "data:")):
            self.outside.append(url)


@contextmanager
def examine_runs(address: str) -> Iterator[tuple[Page, Messages]]:
    """The page at an address, 1,280 pixels wide."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        chromium = playwright.chromium.launch(
            executable_path=browser(), args=["--no-sandbox", "--disable-gpu"]
        )
        page = chromium.new_page(viewport={"width": 1280, "height": 900})
        page.set_default_timeout(PATIENCE_MS)
        messages = Messages(page)
        page.goto(address)
        try:
            yield page, messages
        finally:
            chromium.close()


AXE = """async () => {
  const found = await axe.run(document, { runOnly: ["wcag2a", "wcag2aa", "wcag21aa"] });
  const words = (v) => `${v.impact} ${v.id}: ${v.nodes.slice(0, 3).map((n) => n.target)}`;
  return [found.passes.length, found.violations.map(words)];
}"""


def axe_source() -> str | None:
    """Source of axe-core from axe-playwright-python; None if it is not installed."""
    try:
        import axe_playwright_python as package
    except ImportError:
        return None
    return (Path(str(package.__file__)).parent / "axe.min.js").read_text(encoding="utf-8")


def accessibility_faults(page: Page, source: str) -> list[str]:
    """Violations of WCAG 2.1 A and AA that axe-core finds on a page."""
    page.evaluate(source)
    passes, faults = page.evaluate(AXE)
    assert passes > 8, "axe-core checked nothing"
    return list(faults)
