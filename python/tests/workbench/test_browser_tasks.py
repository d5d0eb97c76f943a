"""Tasks of an engineer in a real browser, found by the visible labels alone."""

from __future__ import annotations

from pathlib import Path

import jbf
import pytest

pytest.importorskip("starlette", reason="the workbench's server is an extra")

from workbench_walk import examine_runs, served, why_not

pytestmark = pytest.mark.skipif(why_not() is not None, reason=str(why_not()))


@pytest.mark.extended
def test_engineer_completes_all_tasks_by_visible_labels(tmp_path: Path) -> None:
    with served(tmp_path) as address, examine_runs(address) as (page, messages):

        def press(name: str) -> None:
            page.get_by_role("button", name=name, exact=True).first.click()

        def finished(model: str) -> None:
            page.locator("#models").get_by_role("button", name=model).wait_for()
            page.get_by_role("button", name="Cancel", exact=True).wait_for(state="detached")

        # Open.
        page.locator(".card", has_text="Linear axis").get_by_role("button").click()
        page.locator("#runs").get_by_text("run_1").wait_for()
        # Understand the verdict.
        press("Diagnose")
        finished("diagnosed")
        banner = page.get_by_role("region", name="Verdict")
        assert "cogging" in banner.inner_text()
        assert "the noise" in banner.inner_text()
        # Add an effect.
        page.get_by_role("tab", name="3 Model").click()
        page.get_by_label("Law").select_option("coulomb")
        press("Data only")
        press("Fit coulomb without effects")
        finished("coulomb (")
        press("add inertia")
        finished("coulomb + inertia (")
        # Compare two models.
        page.get_by_label("compare with coulomb", exact=True).check()
        table = page.locator("section, div", has_text="Models side by side").last
        table.wait_for()
        page.get_by_role("columnheader", name="coulomb + inertia").wait_for()
        press("Plot the compared models")
        page.locator(".u-legend", has_text="coulomb").first.wait_for()
        page.get_by_role("tab", name="3 Model").click()
        # Fix a parameter.
        page.get_by_label("value of F_c").fill("8")
        page.get_by_label("fix F_c").check()
        press("Fit with these settings")
        finished("coulomb + inertia, F_c fixed")
        # Export.
        page.get_by_role("tab", name="4 Export").click()
        with page.expect_download() as download:
            press("download Model (model.toml)")
        download.value.save_as(tmp_path / "mine.toml")
        assert messages.complaints == messages.outside == []
    model = jbf.Model.load(tmp_path / "mine.toml")
    assert model.parameters["F_c"].value == 8.0
    assert model.effects == ("inertia",)
