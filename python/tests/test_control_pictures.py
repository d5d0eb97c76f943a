"""Pictures of tables and robustness draw the numbers that they are given, where they belong."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from jbf.control import TASKS, THESIS_BENCH, run, thesis_model
from jbf.control.robustness import Outcome
from jbf.control.thesis_tables import Cell, Tables
from jbf.plot.style import BEFORE, MEASURED, MODEL, NOISE
from jbf.reporting.control_json import tables_dict
from jbf.reporting.control_plots import plot_robustness, plot_tables
from jbf.reporting.control_run_plot import plot_run_of_loop, plot_runs
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

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


def test_each_column_has_its_colour_and_each_kind_of_mark_its_name() -> None:
    """The thesis's diamonds once, ours by its true error; on a logarithmic scale."""
    cells = {
        ("position sine", column): Cell("position sine", column, 0.1, 1.0, printed, None, 0.5)
        for column, printed in PRINTED.items()
    }
    figure = plot_tables(Tables(cells, thesis_model(), THESIS_BENCH))
    (ax,) = figure.axes
    colours = [to_hex(group[0].get_facecolor()) for group in ax.containers]
    assert colours == [MEASURED, MODEL, BEFORE, NOISE]
    (legend,) = figure.legends
    said = [text.get_text() for text in legend.get_texts()]
    names = ["none, bench", "thesis", "learning, bench", "coulomb, bench", "observed, true error"]
    assert sorted(said) == sorted(names)
    assert ax.get_yscale() == "log"
    assert ax.get_title(loc="left") == "RMS error: bench (bars) and thesis (diamonds)"
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("", "rad or rad/s")
    assert tuple(figure.get_size_inches()) == (10.0, 4.6)
    given = Figure()
    assert plot_tables(Tables(cells, thesis_model(), THESIS_BENCH), given) is given


def test_a_ratio_of_one_is_marked_between_what_helps_and_what_harms() -> None:
    """On a logarithmic scale; drawn on a figure that is given."""
    outcomes = [Outcome("first", {"a": 0.2, "b": 0.9})]
    figure = plot_robustness(outcomes)
    (ax,) = figure.axes
    (one,) = [line for line in ax.lines if line.get_marker() == "None"]
    assert np.asarray(one.get_xdata()).tolist() == [1.0, 1.0]
    assert ax.get_xscale() == "log"
    assert ax.get_title(loc="left") == (
        "Error with the observed compensator over that without; left of 1 it helps"
    )
    assert ax.get_xlabel() == "Ratio of true RMS errors, worst row marked"
    colours = {line.get_marker(): line.get_color() for line in ax.lines}
    assert (colours["o"], colours["D"]) == (MODEL, BEFORE)
    assert tuple(figure.get_size_inches()) == (8.0, 7.0)
    given = Figure()
    assert plot_robustness(outcomes, given) is given


def test_loops_stand_side_by_side_in_a_column_each() -> None:
    """As wide as there are; the first has the names of the axes."""
    loop = run(None, "none", replace(TASKS["velocity sine"], seconds=2.5))
    for count in (1, 2, 3):
        figure = plot_runs([loop] * count)
        assert tuple(figure.get_size_inches()) == pytest.approx((4.2 * count, 12.5))
        assert len(figure.axes) == 5 * count
        assert [bool(ax.get_ylabel()) for ax in figure.axes[:count]] == [
            i == 0 for i in range(count)
        ]
    given = Figure()
    assert plot_runs([loop], given) is given
    axes = plot_run_of_loop(loop)
    assert tuple(axes[0].figure.get_size_inches()) == (7.0, 12.5)  # type: ignore[union-attr]
    assert plot_run_of_loop(loop, axes) == axes


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
