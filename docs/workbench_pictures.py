"""Make the pictures of docs/workbench.md: `.venv/bin/python docs/workbench_pictures.py`.

The program shows the workbench with simulated data in a headless Chromium (Debian: `apt-get install
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

import numpy as np  # noqa: E402
from PIL import Image  # noqa: E402
from workbench_walk import examine_runs, served, why_not  # noqa: E402

if TYPE_CHECKING:
    from playwright.sync_api import Page


HALVES = (("light", "3"), ("dark", "2"))
"""Theme and key of the view of both halves of the narrow picture."""


def taken(page: Page) -> Image.Image:
    """Screenshot of the page."""
    page.wait_for_timeout(1500)
    return Image.open(io.BytesIO(page.screenshot())).convert("RGB")


def save(picture: Image.Image, name: str) -> None:
    """Save a picture under a name."""
    picture.save(HERE / "images" / f"workbench_{name}.png", optimize=True)


def shot(page: Page, name: str, height: int = 900) -> None:
    """Save a screenshot of the page under a name."""
    page.evaluate("document.activeElement.blur(); scrollTo(0, 0)")
    page.set_viewport_size({"width": 1280, "height": height})
    save(taken(page), name)


def models(page: Page, count: int) -> None:
    """Wait until the workbench has `count` models and no task runs."""
    page.wait_for_selector(f"#models .item:nth-of-type({count + 1}) [data-key^=model-]")
    page.wait_for_selector("[data-key=cancel]", state="detached")


def write_log(path: Path) -> None:
    """Write a log without units, with two columns that could be the friction."""
    t = np.arange(0.0, 24.0, 0.01)
    noise = 0.02 * np.random.default_rng(1).standard_normal(len(t))
    torque = 0.4 * np.sign(np.cos(1.3 * t)) + 0.2 * np.cos(1.3 * t) + noise
    rows = np.column_stack([1000 * t, 60 * np.sin(1.3 * t), torque, 0.05 + noise])
    np.savetxt(path, rows, "%.4f", ";", header="t;pos;torque;torque_ff", comments="")


def narrow(page: Page) -> None:
    """Save a picture of two views on a narrow screen, in light and in dark colours."""
    page.set_viewport_size({"width": 390, "height": 844})
    halves = []
    for theme, key in HALVES:
        page.keyboard.press(key)
        if page.evaluate("document.documentElement.dataset.theme") != theme:
            page.click("[data-key=theme]")
        halves.append(taken(page))
    picture = Image.new("RGB", (2 * 390 + 20, 844), "white")
    for number, half in enumerate(halves):
        picture.paste(half, (number * 410, 0))
    save(picture, "narrow")


def main() -> int:
    """Take the pictures of all views of the workbench."""
    if why_not() is not None:
        print(f"SKIPPED: {why_not()}")
        return 1
    with (
        tempfile.TemporaryDirectory() as folder,
        served(Path(folder)) as address,
        examine_runs(address) as (page, _),
    ):
        page.wait_for_selector("[data-listed]")
        shot(page, "first", 620)
        log = Path(folder) / "gearmotor.csv"
        write_log(log)
        page.reload()
        page.click("[data-key='pick-gearmotor.csv']")
        page.click("[data-key=import-chosen]")
        page.click("[data-key=answer-time_s-ms]")
        page.wait_for_selector("[data-key='answer-angle_rad-deg']")
        shot(page, "questions", 620)
        page.click("[data-key=answer-angle_rad-deg]")
        page.click("[data-key=answer-torque_n_m-torque]")
        page.click("[data-key='answer-torque_n_m-N m']")
        page.wait_for_selector("#section [data-drawn] canvas")
        page.click("[data-key=columns]")
        shot(page, "import", 820)
        page.select_option("[data-key=machine]", "bearing")
        page.wait_for_selector("[data-key=answer-values]")
        page.click("[data-key=columns]")
        shot(page, "bearing", 900)
        page.click("[data-key=close-import]")
        page.click("[data-key=sample-bearing]")
        page.wait_for_selector("[data-drawn] canvas")
        page.click("[data-key='run-two_way_0.25']")
        shot(page, "data")
        page.keyboard.press("3")
        page.click("[data-key=fit-law]")
        models(page, 1)
        page.click("[data-key='run-two_way_1.0']")
        page.click("[data-key=sketch-sensor_lag]")
        shot(page, "learn", 1280)
        page.keyboard.press("2")
        page.click("[data-key=fail-0]")
        shot(page, "see", 1460)
        page.keyboard.press("3")
        page.click("[data-key=add-sensor_lag]")
        models(page, 2)
        page.click("[data-key=add-coulomb_drag]")
        models(page, 3)
        page.click("[data-key=beside-1]")
        page.click("[data-key=beside-2]")
        page.wait_for_selector("[data-key=side-by-side]")
        shot(page, "fallen", 1000)
        page.fill("[data-key='value-coulomb_drag.F_d']", "3")
        page.wait_for_selector("[data-drawn*='coulomb_drag'] canvas")
        page.locator("[data-key=refit]").scroll_into_view_if_needed()
        save(taken(page), "parameters")
        page.keyboard.press("Escape")
        page.click("[data-key=tab-Export]")
        shot(page, "keep", 820)
        narrow(page)
    return 0


if __name__ == "__main__":
    sys.exit(main())
