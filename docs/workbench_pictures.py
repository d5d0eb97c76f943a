"""Make the pictures of docs/workbench.md: `.venv/bin/python docs/workbench_pictures.py`.

The program shows the workbench with the demo data in a headless Chromium (Debian: `apt-get install
chromium`).
"""

from __future__ import annotations

import io
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "python" / "tests"))

from PIL import Image  # noqa: E402
from workbench_walk import examine_runs, served, why_not  # noqa: E402

if TYPE_CHECKING:
    from playwright.sync_api import Page


def shot(page: Page, name: str) -> None:
    """Save a screenshot of the page under a name."""
    page.wait_for_timeout(1500)
    picture = Image.open(io.BytesIO(page.screenshot())).convert("RGB")
    picture.save(HERE / "images" / f"workbench_{name}.png", optimize=True)


def models(page: Page, count: int) -> None:
    """Wait until the workbench has `count` models and no task runs."""
    page.wait_for_selector(f"#models .item:nth-of-type({count + 1}) [data-key^=model-]")
    page.wait_for_selector("[data-key=cancel]", state="detached")


def main() -> int:
    """Take the pictures of all pages of the workbench."""
    if why_not() is not None:
        print(f"SKIPPED: {why_not()}")
        return 1
    with (
        tempfile.TemporaryDirectory() as folder,
        served(Path(folder), "--demo") as address,
        examine_runs(address) as (page, _),
    ):
        page.wait_for_selector("[data-drawn] canvas")
        page.click("[data-key='run-two_way_0.25']")
        shot(page, "data")
        page.keyboard.press("3")
        page.click("[data-key=fit-law]")
        models(page, 1)
        page.click("[data-key=sketch-sensor_lag]")
        shot(page, "learn")
        page.keyboard.press("2")
        page.click("[data-key=fail-0]")
        size = page.viewport_size
        # The pictures of this page are complete only in a slightly larger window.
        page.set_viewport_size({"width": size["width"], "height": size["height"] + 30})
        shot(page, "see")
        page.set_viewport_size(size)
        page.keyboard.press("3")
        page.click("[data-key=add-sensor_lag]")
        models(page, 2)
        page.click("[data-key=add-coulomb_drag]")
        models(page, 3)
        shot(page, "fallen")
        page.keyboard.press("4")
        shot(page, "keep")
    return 0


if __name__ == "__main__":
    sys.exit(main())
