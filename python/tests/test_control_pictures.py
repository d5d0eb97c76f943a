"""Pictures of tables and robustness draw the numbers that they are given, where they belong."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from jbf.control import TASKS, THESIS_BENCH, run, thesis_model
from jbf.control.robustness import Outcome
from jbf.control.thesis_tables import Cell, Tables
from jbf.reporting.control_json import tables_dict
from jbf.reporting.control_plots import plot_robustness, plot_tables
from jbf.reporting.control_run_plot import plot_run_of_loop

PRINTED = {"none": 0.4, "learning": 0.08, "coulomb": None, "observed": None}


@pytest.mark.parametrize("columns", [tuple(PRINTED), ("none", "learning", "coulomb")])
def test_bars_stand_around_their_row_and_diamonds_on_what_is_printed(
    columns: tuple[str, ...],
) -> None:
    cells = {
        (row, column): Cell(row, column, 0.1 + i + 10 * j, 1.0, PRINTED[column], None, 0.5 + j)
        for i, row in enumerate(("position sine", "velocity sine"))
        for j, column in enumerate(columns)
    }
    figure = plot_tables(Tables(cells, thesis_model(), THESIS_BENCH))
    (ax,) = figure.axes
    heights = np.array([[bar.get_height() for bar in group] for group in ax.containers])
    centres = np.array(
        [[bar.get_x() + 0.5 * bar.get_width() for bar in group] for group in ax.containers]
    )
    for j, column in enumerate(columns):
        ours = column == "observed"
        wanted = [cells[row, column] for row in ("position sine", "velocity sine")]
        assert heights[j].tolist() == [c.true_rms if ours else c.rms for c in wanted]
    assert centres.mean(axis=0) == pytest.approx([0.0, 1.0])
    # No bar hides another, nor reaches the next row's.
    assert np.all(np.diff(centres, axis=0) >= ax.patches[0].get_width())
    assert centres[-1, 0] + 0.1 < centres[0, 1]
    diamonds = np.vstack([line.get_xydata() for line in ax.lines])
    assert diamonds[:, 1].tolist() == [0.4, 0.4, 0.08, 0.08]
    assert diamonds[:2, 0] == pytest.approx(centres[0])
    assert [label.get_text() for label in ax.get_xticklabels()] == [
        "position\nsine",
        "velocity\nsine",
    ]


def test_each_outcome_has_its_own_line_and_its_worst_a_mark() -> None:
    outcomes = [Outcome("first", {"a": 0.2, "b": 0.9}), Outcome("second", {"a": 1.1, "b": 0.3})]
    (ax,) = plot_robustness(outcomes).axes
    place = {t.get_text(): y for t, y in zip(ax.get_yticklabels(), ax.get_yticks(), strict=True)}
    # The first stands on top.
    assert place["first"] > place["second"]
    drawn = {
        (float(x), float(y))
        for line in ax.lines
        if line.get_marker() == "D"
        for x, y in line.get_xydata()
    }
    assert drawn == {(o.worst, float(place[o.name])) for o in outcomes}
    dots = {float(x) for line in ax.lines if line.get_marker() == "o" for x in line.get_xdata()}
    assert dots == {0.2, 0.9, 1.1, 0.3}


def test_one_run_alone_names_its_axes() -> None:
    axes = plot_run_of_loop(run(None, "observed", replace(TASKS["velocity sine"], seconds=4.0)))
    assert [ax.get_ylabel() for ax in axes[:4]] == [
        "Speed (rad/s)",
        "Error (rad/s)",
        "Friction (V)",
        "Friction (V)",
    ]


def test_json_counts_the_cells_within_a_factor() -> None:
    ratios = dict(zip(TASKS, (1.0, 1.4, 1.0 / 1.9, 2.1, 3.0, 0.2, 1.3), strict=True))
    cells = {
        (row, "learning"): Cell(row, "learning", 0.3 * ratio, 1.0, 0.3, None, 1.0)
        for row, ratio in ratios.items()
    }
    cells |= {(row, "coulomb"): Cell(row, "coulomb", 1.0, 1.0, None, None, 1.0) for row in ratios}
    cells |= {(row, "observed"): Cell(row, "observed", 1.0, 1.0, None, None, 0.5) for row in ratios}
    tables = Tables(cells, thesis_model(), THESIS_BENCH)
    told = tables_dict(tables, [("same", tables)])
    for part in (told, told["assumptions"][0]):
        assert (part["within_1.5"], part["within_2"]) == (3, 4)
    assert told["assumptions"][0]["ratios"] == pytest.approx(
        {f"{row}, learning": ratio for row, ratio in ratios.items()}
    )
    assert told["times_better"] == dict.fromkeys(ratios, 2.0)
