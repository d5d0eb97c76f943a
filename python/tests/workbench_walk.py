"""A page in a real browser: the workbench's own server, headless Chromium, and what both said."""

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
    """Debian's Chromium, or another."""
    return next((path for name in BROWSERS if (path := shutil.which(name))), None)


def why_not() -> str | None:
    """Why no page can be looked at here; None where one can."""
    try:
        import playwright.sync_api  # noqa: F401
    except ImportError:
        return "no page is looked at: pip install playwright"
    if browser() is None:
        return "no page is looked at: apt-get install chromium"
    if not vendored.is_there():
        return "no page is looked at: python -m jbf.workbench.vendored"
    return None


@contextmanager
def served(folder: Path, *more: str) -> Iterator[str]:
    """`jbf workbench FOLDER`, as a user starts it; its address."""
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


class Said:
    """What a page asked for and complained of."""

    def __init__(self, page: Page) -> None:
        self.complaints: list[str] = []
        self.outside: list[str] = []
        page.on("console", self._console)
        page.on("pageerror", lambda error: self.complaints.append(str(error)))
        page.on("request", lambda request: self._asked(request.url))

    def _console(self, message: object) -> None:
        if getattr(message, "type", "") in ("error", "warning"):
            self.complaints.append(str(getattr(message, "text", message)))

    def _asked(self, url: str) -> None:
        if not url.startswith(("http://127.0.0.1:", "blob:http://127.0.0.1:", "data:")):
            self.outside.append(url)


@contextmanager
def looked_at(address: str) -> Iterator[tuple[Page, Said]]:
    """The page at an address, 1,280 pixels wide."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        chromium = playwright.chromium.launch(
            executable_path=browser(), args=["--no-sandbox", "--disable-gpu"]
        )
        page = chromium.new_page(viewport={"width": 1280, "height": 900})
        page.set_default_timeout(PATIENCE_MS)
        said = Said(page)
        page.goto(address)
        try:
            yield page, said
        finally:
            chromium.close()
