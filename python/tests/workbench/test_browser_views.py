"""Views of the workbench in a real browser: errors, layout, plots, comparison, accessibility."""

from __future__ import annotations

import csv
import re
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

pytest.importorskip("starlette", reason="the workbench's server is an extra")

from workbench_walk import (
    Messages,
    accessibility_faults,
    axe_source,
    examine_runs,
    served,
    why_not,
)

if TYPE_CHECKING:
    from playwright.sync_api import Page

pytestmark = pytest.mark.skipif(why_not() is not None, reason=str(why_not()))

DRIVE = '[drive]\nmotion = "linear"\nfriction = "force"\n'
VIEWS = (1, 2, 3, 4)
OTHER_PLOTS = ("plane", "stribeck", "runs_by_speed", "residual")


def write_campaign(folder: Path, names: tuple[str, ...]) -> None:
    """Write a slide of 3 kg with 12 N of Coulomb friction, one run per name."""
    folder.mkdir()
    (folder / "rig.toml").write_text(DRIVE)
    t = np.arange(0.0, 20.0, 0.02)
    for number, name in enumerate(names):
        w = 1.0 + number
        x, v = 0.06 * np.sin(w * t), 0.06 * w * np.cos(w * t)
        noise = 0.3 * np.random.default_rng(number).standard_normal(len(t))
        force = 12.0 * np.sign(v) + 40.0 * v - 3.0 * w**2 * x + noise
        rows = np.column_stack([t, x, force])
        np.savetxt(
            folder / f"{name}.csv", rows, "%.5f", ",", header="time_s,position_m,friction_n",
            comments="",
        )  # fmt: skip


@pytest.fixture(scope="module")
def opened(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Page, Messages]]:
    """A page with an open campaign whose law was fitted, next to a second campaign."""
    folder = tmp_path_factory.mktemp("slides")
    write_campaign(folder / "first", ("slow", "fast"))
    write_campaign(folder / "second", ("other",))
    with served(folder) as address, examine_runs(address) as (page, messages):
        page.click("[data-key='open-first/rig.toml']")
        page.wait_for_selector("#runs [data-key=run-fast]")
        page.keyboard.press("3")
        page.click("[data-key=fit-law]")
        page.wait_for_selector("[data-key=model-1]")
        page.wait_for_selector("[data-key=cancel]", state="detached")
        yield page, messages


def enter(page: Page, number: int) -> None:
    page.keyboard.press(str(number))
    page.wait_for_selector(f"[role=tab][aria-selected=true]:nth-child({number})")
    page.wait_for_timeout(400)


def test_banner_states_the_error_as_a_multiple_of_the_noise(
    opened: tuple[Page, Messages],
) -> None:
    page, _ = opened
    number = page.inner_text("#banner [data-key=times-noise]").split()[1]
    assert float(number) > 1.5
    assert page.locator("#banner [data-key=next-add]").count() == 1


def test_laws_that_need_a_bearing_are_last_and_disabled_for_a_slide(
    opened: tuple[Page, Messages],
) -> None:
    page, _ = opened
    enter(page, 3)
    laws: list[Any] = page.eval_on_selector_all(
        "[data-key=law] option", "all => all.map((o) => [o.value, o.disabled])"
    )
    names = [name for name, _ in laws]
    assert names[:3] == ["auto", "coulomb", "stribeck"]
    assert dict(laws)["journal"]
    assert names.index("journal") > names.index("rate_and_state")
    assert page.inner_text("[data-key=fit-law]") == "Fit coulomb without effects"


def test_bars_of_the_error_are_proportional_to_the_error(opened: tuple[Page, Messages]) -> None:
    page, _ = opened
    enter(page, 3)
    bars = "svg[aria-label='error of each model']"
    fit, held_out = page.eval_on_selector_all(
        f"{bars} rect", "all => all.map((r) => r.width.baseVal.value)"
    )
    noise = page.eval_on_selector(f"{bars} line", "l => l.x1.baseVal.value - 150")
    words = page.inner_text("[data-key=model-1]").split("\n")[1]
    rms, held_out_rms = map(float, re.findall(r"RMS ([\d.]+)", words))
    assert fit / held_out == pytest.approx(rms / held_out_rms, rel=0.02)
    times = float(page.inner_text("#banner [data-key=times-noise]").split()[1])
    assert held_out / noise == pytest.approx(times, abs=0.06)


def test_candidates_have_a_sentence_a_shape_and_a_description(
    opened: tuple[Page, Messages],
) -> None:
    page, _ = opened
    enter(page, 3)
    card = page.locator("[data-effect=inertia]")
    # The sentence is worded for a drive.
    assert "Mass that the drive accelerates" in card.inner_text()
    assert "× the noise" in card.inner_text()
    assert card.locator("svg polyline").count() == 2
    page.click("[data-key=about-inertia]")
    assert "equation" in page.inner_text("dialog")
    page.click("[data-key=close-about]")
    page.wait_for_selector("dialog", state="detached")


def test_candidate_to_add_is_listed_before_one_with_more_evidence(
    opened: tuple[Page, Messages],
) -> None:
    page, _ = opened
    trials = [
        {"effect": "backlash", "outcome": "rejected", "evidence": 90.0},
        {"effect": "cogging", "outcome": "no gain", "evidence": -5.0},
        {"effect": "inertia", "outcome": "added", "evidence": 60.0},
    ]
    order = "async (trials) => (await import('/static/candidates.js')).ranked(trials)"
    names = [trial["effect"] for trial in page.evaluate(order, trials)]
    assert names == ["inertia", "backlash", "cogging"]


def test_page_laws_and_effects_link_to_their_documentation(
    opened: tuple[Page, Messages],
) -> None:
    page, messages = opened
    enter(page, 3)
    page.select_option("[data-key=law]", "stribeck")
    page.wait_for_selector("[data-key=docs-law][href$=stribeck]")
    for key, file in (
        ("docs", "workbench.md"),
        ("docs-inertia", "effects/inertia.md"),
        ("docs-law", "laws.md#stribeck"),
    ):
        address = page.get_attribute(f"[data-key={key}]", "href")
        assert address == f"https://github.com/jbf-friction/jbf/blob/main/docs/{file}"
    page.select_option("[data-key=law]", "auto")
    page.wait_for_selector("[data-key=docs-law][href$='laws.md']")
    assert messages.outside == []


@pytest.mark.parametrize("width", [390, pytest.param(800, marks=pytest.mark.extended)])
def test_no_view_scrolls_sideways_on_a_narrow_screen(
    opened: tuple[Page, Messages], width: int
) -> None:
    page, _ = opened
    page.set_viewport_size({"width": width, "height": 840})
    try:
        for number in VIEWS:
            enter(page, number)
            assert page.evaluate("document.documentElement.scrollWidth") <= width, number
            section = page.locator("#section").bounding_box()
            assert section is not None
            assert section["width"] > 0.9 * width - 30
    finally:
        page.set_viewport_size({"width": 1280, "height": 900})


def test_unused_samples_and_any_channel_can_be_shown(opened: tuple[Page, Messages]) -> None:
    page, _ = opened
    enter(page, 2)
    assert page.locator(".u-legend >> text=measured, not used by the fit").count() == 1
    page.select_option("[data-key=axis]", "position")
    page.wait_for_selector("[data-drawn]")
    page.click("[data-key=any-channel]")
    page.wait_for_selector("[data-drawn='residual_n spectrum']")
    page.select_option("[data-key=channel]", "friction_n")
    page.select_option("[data-key=transform]", "derivative")
    page.wait_for_selector("[data-drawn='friction_n derivative']")


@pytest.mark.parametrize(
    "plot",
    ["force", *(pytest.param(p, marks=pytest.mark.extended) for p in OTHER_PLOTS)],
)
def test_picture_and_data_of_a_plot_can_be_saved(
    opened: tuple[Page, Messages], plot: str, tmp_path: Path
) -> None:
    page, _ = opened
    enter(page, 2)
    for kind, start in (("png", b"\x89PNG"), ("csv", b"")):
        with page.expect_download() as download:
            page.click(f"[data-key={kind}-{plot}]")
        path = tmp_path / download.value.suggested_filename
        download.value.save_as(path)
        assert path.read_bytes().startswith(start)
    header, *rows = csv.reader(path.read_text().splitlines())
    assert len(rows) > 10
    assert {len(row) for row in rows} == {len(header)}


@pytest.mark.parametrize("theme", ["light", pytest.param("dark", marks=pytest.mark.extended)])
def test_views_have_no_accessibility_faults(opened: tuple[Page, Messages], theme: str) -> None:
    source = axe_source()
    if source is None:
        pytest.skip("this test needs: pip install axe-playwright-python")
    page, _ = opened
    if page.evaluate("document.documentElement.dataset.theme") != theme:
        page.click("[data-key=theme]")
    for number in VIEWS:
        enter(page, number)
        assert accessibility_faults(page, source) == [], number


@pytest.mark.extended
def test_edited_parameter_is_drawn_fixed_fitted_and_compared(
    opened: tuple[Page, Messages],
) -> None:
    page, _ = opened
    enter(page, 3)
    page.fill("[data-key=value-F_c]", "9")
    page.wait_for_selector("""[data-drawn='{"F_c":9}'] canvas""")
    page.wait_for_selector("text=/with the edited values: RMS/")
    page.check("[data-key=fix-F_c]")
    page.fill("[data-key=upper-F_v]", "30")
    page.click("[data-key=refit]")
    page.wait_for_selector("[data-key=model-2]")
    page.wait_for_selector("[data-key=cancel]", state="detached")
    assert page.input_value("[data-key=value-F_c]") == "9"
    assert float(page.input_value("[data-key=value-F_v]")) <= 30.0
    # The next fit of this model keeps what was fixed and bounded.
    assert page.is_checked("[data-key=fix-F_c]")
    assert page.input_value("[data-key=upper-F_v]") == "30"
    # Both models in one table and in one plot; name, undo and redo.
    page.fill("[data-key=model-name]", "nine newtons")
    page.keyboard.press("Enter")
    page.wait_for_selector("[data-key=model-2] >> text=nine newtons")
    page.check("[data-key=beside-1]")
    page.wait_for_selector("[data-key=side-by-side] >> text=nine newtons")
    page.click("[data-key=plot-compared]")
    page.wait_for_selector(".u-legend >> text=coulomb")
    assert page.locator("[data-key=plot-compared]").count() == 0
    page.keyboard.press("z")
    page.wait_for_selector("[data-key=model-1][aria-pressed=true]")
    page.keyboard.press("y")
    page.wait_for_selector("[data-key=model-2][aria-pressed=true]")
    page.click("[data-key=model-1]")


SLOW = """() => {
  const plain = window.fetch;
  window.fetch = (address, options) => new Promise((done, failed) => {
    const stop = () => failed(new DOMException("aborted", "AbortError"));
    options?.signal?.addEventListener("abort", stop);
    const slow = String(address).includes("/api/text");
    setTimeout(() => plain(address, options).then(done, failed), slow ? 60000 : 0);
  });
}"""


def test_request_that_takes_long_shows_progress_and_can_be_cancelled(
    opened: tuple[Page, Messages],
) -> None:
    page, messages = opened
    enter(page, 4)
    page.evaluate(SLOW)
    page.click("[data-key=get-model]")
    page.wait_for_selector("#job progress")
    page.click("[data-key=cancel-requests]")
    page.wait_for_selector("#job progress", state="detached")
    assert page.inner_text("#message") == "Cancelled."
    assert messages.complaints == []


DELAYED = """() => {
  const plain = window.fetch;
  window.fetch = async (...request) => {
    const late = String(request[0]).includes("/api/series");
    if (late) await new Promise((done) => setTimeout(done, 1500));
    const answer = await plain(...request);
    if (late) document.body.dataset.late = "";
    return answer;
  };
}"""


def test_error_about_a_run_that_is_no_longer_open_is_not_shown(
    opened: tuple[Page, Messages],
) -> None:
    page, messages = opened
    enter(page, 1)
    page.evaluate(DELAYED)
    page.click("[data-key=run-slow]")
    page.click("[data-key='open-second/rig.toml']")
    page.wait_for_selector("#runs [data-key=run-other]")
    page.wait_for_selector("body[data-late]")
    page.wait_for_timeout(300)
    assert page.locator("#message.error").count() == 0
    # The browser itself logs the status of the late request.
    others = [words for words in messages.complaints if "422" not in words]
    assert others == messages.outside == []


def test_models_return_when_their_rig_is_opened_again(opened: tuple[Page, Messages]) -> None:
    page, _ = opened
    enter(page, 1)
    if page.locator("#runs [data-key=run-other]").count() == 0:
        page.click("[data-key='open-second/rig.toml']")
        page.wait_for_selector("#runs [data-key=run-other]")
    assert page.locator("[data-key=model-1]").count() == 0
    page.wait_for_selector("li >> text=/first.*models? kept/")
    page.click("[data-key='open-first/rig.toml']")
    page.wait_for_selector("[data-key=model-1]")
