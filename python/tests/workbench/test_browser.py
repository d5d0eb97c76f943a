"""The workbench in a real browser, from loading records to a saved model."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING

import jbf
import numpy as np
import pytest

pytest.importorskip("starlette", reason="the workbench's server is an extra")

from workbench_parts import slide_log
from workbench_walk import examine_runs, served, why_not

if TYPE_CHECKING:
    from playwright.sync_api import Page

pytestmark = pytest.mark.skipif(why_not() is not None, reason=str(why_not()))


def click(page: Page, key: str) -> None:
    page.click(f'[data-key="{key}"]')


def open_tab(page: Page, number: int) -> None:
    page.keyboard.press("Escape")
    page.keyboard.press(str(number))
    page.wait_for_selector(f"[role=tab][aria-selected=true]:nth-child({number})")


def press_by_keyboard(page: Page, key: str) -> None:
    """Move the focus to a button with the Tab key and press Enter."""
    for _ in range(80):
        page.keyboard.press("Tab")
        if page.evaluate("document.activeElement.dataset.key") == key:
            page.keyboard.press("Enter")
            return
    raise AssertionError(f"the keyboard does not reach {key}")


def models(page: Page) -> list[dict[str, float | None]]:
    """RMS of the fit and held-out RMS of each listed model."""
    texts = page.locator("#models [data-key^=model-] small").all_inner_texts()
    result = []
    for text in texts:
        rms, held_out_rms = map(float, re.findall(r"RMS ([\d.]+)", text))
        result.append({"rms": rms, "held_out": held_out_rms})
    return result


def await_models(page: Page, count: int) -> None:
    page.wait_for_function(
        "n => document.querySelectorAll('#models [data-key^=model-]').length === n"
        " && !document.querySelector('[data-key=cancel]')",
        arg=count,
    )


def assert_page_fits_the_window(page: Page) -> None:
    assert page.evaluate("document.documentElement.scrollWidth") <= 1280


@pytest.mark.extended
def test_demo_can_be_fitted_diagnosed_saved_and_resumed_in_the_browser(tmp_path: Path) -> None:
    with served(tmp_path) as address, examine_runs(address) as (page, messages):
        click(page, "sample-bearing")
        page.wait_for_selector("#runs [data-key^=run-]")
        page.wait_for_selector("[data-drawn] canvas")
        assert_page_fits_the_window(page)

        open_tab(page, 2)
        page.wait_for_selector("#banner >> text=No model yet")
        open_tab(page, 3)
        press_by_keyboard(page, "fit-law")
        await_models(page, 1)

        open_tab(page, 2)
        page.wait_for_selector('[data-key="fail-0"]')
        press_by_keyboard(page, "fail-0")
        page.wait_for_selector("text=/^Marked: .*RMS/")
        # Select the run in the list of runs as well.
        assert page.locator("#runs >> text=/[0-9]+ selected/").count() > 1
        assert_page_fits_the_window(page)

        open_tab(page, 3)
        # The first candidate of the ranking.
        leader = page.locator("[data-key^=add-]").first
        name = str(leader.get_attribute("data-key")).removeprefix("add-")
        click(page, f"sketch-{name}")
        page.wait_for_selector(f"text=/^{name} on .* times its typical strength/")
        leader.click()
        await_models(page, 2)
        before, after = models(page)
        assert after["rms"] < 0.7 * before["rms"]
        assert after["held_out"] < 0.7 * before["held_out"]
        assert page.locator("svg[aria-label='error of each model'] rect.bar").count() == 4
        assert page.locator(f"svg text >> text='+ {name}'").count() == 1

        click(page, "undo")
        page.wait_for_selector("#models .item.now >> text=/^journal/")
        click(page, "diagnose")
        await_models(page, 3)
        verdict = page.inner_text("#section .verdict")
        assert "Missing: sensor_lag and coulomb_drag." in verdict
        # The banner states the verdict on the model, which contains both.
        banner = page.inner_text("#banner")
        assert "Missing" not in banner
        assert "sensor_lag contributes" in banner
        assert_page_fits_the_window(page)

        open_tab(page, 4)
        for what in ("session", "model", "report", "rust", "c"):
            click(page, f"keep-{what}")
            page.wait_for_selector("text=/^Written: /")
            page.wait_for_timeout(300)
        assert messages.complaints == messages.outside == []

        saved = models(page)
        page.reload()
        await_models(page, 3)
        assert models(page) == saved

    model = jbf.Model.load(tmp_path / "model.toml")
    assert set(model.effects) == {"sensor_lag", "coulomb_drag"}
    with served(tmp_path) as address, examine_runs(address) as (page, messages):
        await_models(page, 3)
        assert models(page) == saved
        assert messages.complaints == []


FOCUSABLE = """() => [...document.querySelectorAll(
  "button:enabled, select:enabled, input:enabled, textarea:enabled, summary, [tabindex='0']")]
  .filter((e) => e.checkVisibility({ visibilityProperty: true }) && e.type !== "radio")
  .map((e) => e.dataset.key ?? e.ariaLabel ?? e.textContent)"""
FOCUSED = """() => {
  const e = document.activeElement, style = getComputedStyle(e);
  return [e.dataset.key ?? e.ariaLabel ?? e.textContent, e === document.body,
    style.outlineStyle !== "none" && parseFloat(style.outlineWidth) >= 2];
}"""


@pytest.mark.extended
def test_keyboard_reaches_every_control_visibly_and_selects_samples(tmp_path: Path) -> None:
    with served(tmp_path, "--demo") as address, examine_runs(address) as (page, messages):
        page.wait_for_selector("[data-drawn] canvas")
        for number in (1, 2, 3, 4):
            open_tab(page, number)
            page.wait_for_timeout(1500)
            wanted = set(page.evaluate(FOCUSABLE))
            reached: set[str] = set()
            page.evaluate("document.activeElement.blur()")
            for _ in range(3 * len(wanted)):
                page.keyboard.press("Tab")
                name, on_page, outlined = page.evaluate(FOCUSED)
                if not on_page:
                    reached.add(name)
                    assert outlined, name
                elif reached:
                    break  # the focus has left the page again
            assert wanted <= reached, (number, wanted - reached)
        # Select a box in the plane of speed and force by keys.
        open_tab(page, 2)
        page.wait_for_timeout(1500)
        page.focus("[data-key=plane]")
        for _ in range(3):
            page.keyboard.press("Shift+ArrowRight")
        page.keyboard.press("Shift+ArrowDown")
        page.keyboard.press("Enter")
        page.wait_for_selector("text=/^Selected: [1-9][0-9]* samples/")
        page.keyboard.press("Escape")
        page.wait_for_selector("text=/^Drag in any plot/")
        assert messages.complaints == []


SLOW_FILES = """() => {
  const plain = window.fetch;
  window.fetch = async (...request) => {
    const found = await plain(...request);
    if (String(request[0]).includes("/api/files")) {
      await new Promise((done) => setTimeout(done, 1000));
      setTimeout(() => { document.body.dataset.filesCame = ""; }, 300);
    }
    return found;
  };
}"""


def test_browser_imports_trims_and_fits_uploaded_recordings(tmp_path: Path) -> None:
    """Two records of a slide with 12 N of Coulomb friction and a mass, in ms and mm."""
    folder = tmp_path / "bench"
    folder.mkdir()
    t = np.arange(0.0, 15.0, 0.02)
    for number, (stroke_m, period_s) in enumerate(((0.06, 8.0), (0.03, 3.0))):
        w = 2.0 * np.pi / period_s
        x, v = stroke_m * np.sin(w * t), stroke_m * w * np.cos(w * t)
        noise = 0.3 * np.random.default_rng(number).standard_normal(len(t))
        force = 12.0 * np.sign(v) + 40.0 * v - 3.0 * w**2 * x + noise
        (tmp_path / f"log{number}.csv").write_text(slide_log(t, x, force))

    with served(folder) as address, examine_runs(address) as (page, messages):
        logs = [str(path) for path in sorted(tmp_path.glob("*.csv"))]
        page.set_input_files("input[type=file]", logs)
        page.wait_for_selector("text=log1: 750 samples")
        click(page, "columns")
        # A different unit changes the numbers and can be undone.
        force = page.locator("tr:has([data-key='is-Force [N]']) td.n")
        right = force.inner_text()
        for unit in ("kN", "N"):
            page.fill("[data-key='unit-Force [N]']", unit)
            page.keyboard.press("Tab")
            page.wait_for_function(
                "([at, was, same]) => (document.querySelector(at).innerText === was) === same",
                arg=["tr:has([data-key='is-Force [N]']) td.n", right, unit == "N"],
            )
        page.evaluate(SLOW_FILES)
        press_by_keyboard(page, "import")
        page.wait_for_selector("text=log0/rig.toml is open, with 2 runs")
        # Move a handle by keys: a tenth of the run is trimmed.
        page.wait_for_selector("[data-drawn] [data-key=trim-0]")
        page.focus("[data-key=trim-0]")
        # A delayed list of files leaves the focus unchanged.
        page.wait_for_selector("body[data-files-came]")
        assert page.evaluate("() => document.activeElement.dataset.key") == "trim-0"
        for _ in range(2):
            page.keyboard.press("Shift+ArrowRight")
        # An update during the movement does not reset the handle.
        used = page.locator("#runs input[type=checkbox]").nth(1)
        used.click()
        page.wait_for_selector("#runs >> text=trimmed")
        page.wait_for_function(
            "() => Math.abs(document.querySelector('[data-key=trim-n-0]').value - 1.5) < 0.01",
            timeout=10_000,
        )
        used.click()
        click(page, "untrim")
        page.wait_for_selector("#runs >> text=trimmed", state="detached")
        open_tab(page, 3)
        page.select_option("[data-key=law]", "coulomb")
        page.wait_for_selector("[data-key=fit-law]:enabled")
        click(page, "fit-law")
        await_models(page, 1)
        first = page.locator("[data-key^=add-]").first
        assert first.get_attribute("data-key") == "add-inertia"
        click(page, "add-inertia")
        await_models(page, 2)
        assert models(page)[1]["held_out"] < 0.33
        open_tab(page, 4)
        click(page, "keep-model")
        page.wait_for_selector("text=/^Written: model.toml/")
        assert messages.complaints == messages.outside == []
    model = jbf.Model.load(folder / "model.toml")
    assert model.parameters["F_c"].value == pytest.approx(12.0, abs=0.2)
    assert model.parameters["inertia.m_e"].value == pytest.approx(3.0, abs=0.3)
