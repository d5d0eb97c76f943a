"""Import of recordings in a real browser: questions, samples, one click to a verdict."""

from __future__ import annotations

from importlib import resources
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("starlette", reason="the workbench's server is an extra")

from workbench_walk import accessibility_faults, axe_source, examine_runs, served, why_not

pytestmark = pytest.mark.skipif(why_not() is not None, reason=str(why_not()))


@pytest.mark.extended
def test_ros_joint_log_leads_to_a_verdict_with_one_click(tmp_path: Path) -> None:
    """A joint with 0.42 kg m^2 and gravity, stamps in ns with jitter, no units in the header."""
    folder, log = tmp_path / "empty", tmp_path / "joint_states.csv"
    folder.mkdir()
    random, t = np.random.default_rng(5), np.arange(0.0, 60.0, 0.008)
    waves = ((1.1, 0.7, 0.0), (0.4, 1.9, 0.3))
    q = sum(a * np.sin(w * t + p) for a, w, p in waves)
    speed = sum(a * w * np.cos(w * t + p) for a, w, p in waves)
    acceleration = -sum(a * w**2 * np.sin(w * t + p) for a, w, p in waves)
    effort = 1.8 * np.tanh(speed / 0.01) + 0.9 * speed + 0.42 * acceleration + 6.5 * np.sin(q)
    effort += 0.08 * random.standard_normal(len(t))
    stamps = (1763390000 * 10**9 + 1e9 * (t + 2e-4 * random.standard_normal(len(t)))).astype(int)
    lines = [
        f"{ns},{a:.5f},{b:.5f},{c:.4f}"
        for ns, a, b, c in zip(stamps, q, speed, effort, strict=True)
    ]
    log.write_text("\n".join(["header.stamp,position,velocity,effort", *lines, ""]))
    with served(folder) as address, examine_runs(address) as (page, messages):
        page.wait_for_selector("[data-listed]")
        page.set_input_files("input[type=file]", str(log))
        page.wait_for_selector("[data-key=import-diagnose]:enabled")
        assert page.locator("[data-point]").count() == 0
        page.click("[data-key=import-diagnose]")
        page.wait_for_selector("[data-key=times-noise]")
        assert float(page.inner_text("[data-key=times-noise]").split()[1]) < 1.5
        assert page.locator("#banner[data-kind]").count() == 1
        assert messages.complaints == messages.outside == []


def write_log_without_units(path: Path) -> None:
    """A log whose units and friction column are not evident."""
    t = np.arange(0.0, 8.0, 0.01)
    rows = np.column_stack([1000 * t, 40 * np.sin(2 * t), 0.3 * np.sign(np.cos(2 * t)), 0 * t])
    path.write_text("t;pos;torque;force\n")
    with path.open("a") as file:
        np.savetxt(file, rows, "%.4f", ";")


@pytest.mark.extended
def test_questions_of_an_import_are_answered_by_clicks(tmp_path: Path) -> None:
    write_log_without_units(tmp_path / "odd.csv")
    with served(tmp_path) as address, examine_runs(address) as (page, messages):
        page.click("[data-key='pick-odd.csv']")
        page.click("[data-key=import-chosen]")
        page.wait_for_selector("[data-point]")
        page.click("[data-key=answer-time_s-ms]")
        page.click("[data-key=answer-angle_rad-deg]")
        page.click("[data-key=answer-torque_n_m-torque]")
        # A column without a unit leads to the question of its unit.
        page.click("[data-key='answer-torque_n_m-N m']")
        page.wait_for_selector("#section [data-drawn] canvas")
        assert page.locator("[data-point]").count() == 0
        page.click("[data-key=import]")
        page.wait_for_selector("#runs [data-key=run-odd]")
        assert messages.complaints == messages.outside == []


@pytest.mark.extended
def test_table_of_columns_with_long_names_fits_the_window(tmp_path: Path) -> None:
    t = np.arange(0.0, 8.0, 0.01)
    names = ("controller_timestamp_seconds[s]", "/slide/measuring_system/actual_position[mm]",
             "/slide/load_cell/friction_force_of_the_guide[N]")  # fmt: skip
    rows = np.column_stack([1.7e9 + t, 4e2 * np.sin(2 * t), 0.3 * np.sign(np.cos(2 * t))])
    np.savetxt(tmp_path / "long.csv", rows, "%.12f", ",", header=",".join(names), comments="")
    with served(tmp_path) as address, examine_runs(address) as (page, _):
        # The list of the open runs takes a part of the width.
        page.click("[data-key=sample-axis]")
        page.wait_for_selector("#runs [data-key=run-run_1]")
        page.click("[data-key='pick-long.csv']")
        page.click("[data-key=import-chosen]")
        page.wait_for_selector("[data-key=import-diagnose]:enabled")
        page.click("[data-key=columns]")
        widths = (
            "[...document.querySelectorAll('.scroll')].map((e) => [e.scrollWidth, e.clientWidth])"
        )
        ((wide, shown),) = page.evaluate(widths)
        assert wide <= shown


def test_dropped_files_are_opened_and_replace_none(tmp_path: Path) -> None:
    folder, elsewhere = tmp_path / "folder", tmp_path / "elsewhere"
    folder.mkdir()
    elsewhere.mkdir()
    write_log_without_units(folder / "odd.csv")
    write_log_without_units(elsewhere / "odd.csv")
    (elsewhere / "photo.png").write_bytes(b"")
    with served(folder) as address, examine_runs(address) as (page, _):
        # The same file again.
        page.wait_for_selector("[data-listed]")
        page.set_input_files("input[type=file]", str(elsewhere / "odd.csv"))
        page.wait_for_selector("h2 >> text=Import odd.csv")
        assert page.locator("[data-key=note]").count() == 0
        page.reload()
        # Other content, after a file of an unknown kind.
        with (elsewhere / "odd.csv").open("a") as file:
            file.write("8000;1;1;0\n")
        page.wait_for_selector("[data-listed]")
        dropped = [str(elsewhere / name) for name in ("photo.png", "odd.csv")]
        page.set_input_files("input[type=file]", dropped)
        page.wait_for_selector("h2 >> text=Import odd_2.csv")
        page.wait_for_selector("[data-key=note] >> text=odd_2.csv")
        assert "photo.png" in page.inner_text("[data-key=note]")
        page.reload()
        # A rig with runs.
        sample = resources.files("jbf") / "data" / "samples" / "axis"
        page.wait_for_selector("[data-listed]")
        dropped = [str(sample / name) for name in ("run_1.csv", "run_2.csv", "rig.toml")]
        page.set_input_files("input[type=file]", dropped)
        page.wait_for_selector("#runs [data-key=run-run_2]")


@pytest.mark.extended
def test_sample_opens_by_one_click_on_the_empty_page(tmp_path: Path) -> None:
    with served(tmp_path) as address, examine_runs(address) as (page, messages):
        page.wait_for_selector(".drop.large")
        page.click("[data-key=sample-axis]")
        page.wait_for_selector("#runs [data-key=run-run_1]")
        page.wait_for_selector("#banner [data-key=next-diagnose]")
        assert messages.complaints == messages.outside == []


@pytest.mark.extended
def test_empty_page_and_questions_of_an_import_have_no_accessibility_faults(
    tmp_path: Path,
) -> None:
    source = axe_source()
    if source is None:
        pytest.skip("this test needs: pip install axe-playwright-python")
    folder, log = tmp_path / "empty", tmp_path / "odd.csv"
    folder.mkdir()
    write_log_without_units(log)
    with served(folder) as address, examine_runs(address) as (page, messages):
        page.wait_for_selector(".drop.large")
        assert accessibility_faults(page, source) == []
        page.set_input_files("input[type=file]", str(log))
        page.wait_for_selector("[data-point]")
        assert accessibility_faults(page, source) == []
        assert messages.complaints == messages.outside == []
