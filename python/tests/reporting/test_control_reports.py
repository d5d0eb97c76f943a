"""Control loop runs, robustness and the tables of the thesis as text, data and plots."""

import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from jbf.control import TASKS, THESIS_BENCH, Result, run, thesis_model
from jbf.control.constants import FALLBACK, FROZEN, JUMPED, NOT_FINITE, SATURATED
from jbf.control.robustness import Outcome
from jbf.control.thesis_tables import Cell, Tables
from jbf.plot.style import BEFORE, MODEL
from jbf.reporting.control_json import robustness_dict, tables_dict
from jbf.reporting.control_plots import plot_robustness, plot_tables
from jbf.reporting.control_run_plot import plot_run_of_loop, plot_runs
from jbf.reporting.control_run_text import robustness_text, runs_text, status_words
from jbf.reporting.control_tables_text import friction_lines, score_text, tables_report, tables_text

THREE_FLAGS = "saturated 50 %, encoder jumped 25 %, reference not finite 25 %"
SHORT = replace(TASKS["velocity sine"], seconds=2.5)


@pytest.fixture(scope="module")
def loop() -> Result:
    return run(None, "coulomb", SHORT)


def rows_of(text: str) -> list[list[str]]:
    """Cells of each line, separated by two or more spaces."""
    return [re.split(r"  +", line.strip()) for line in text.splitlines()]


def test_loop_status_states_the_share_of_samples_with_each_flag(loop: Result) -> None:
    for flags, expected in (
        ([0, 0, 0, 0], "ok"),
        ([SATURATED, 0, 0, 0], "saturated 25 %"),
        ([FROZEN | FALLBACK, FALLBACK, 0, 0], "encoder frozen 25 %, control law only 50 %"),
        ([JUMPED, NOT_FINITE, SATURATED, SATURATED], THREE_FLAGS),
    ):
        assert status_words(replace(loop, status=np.array(flags, dtype=np.uint8))) == expected


def test_loop_runs_are_listed_with_their_errors_below_their_task(loop: Result) -> None:
    other = replace(loop, scheme="none", status=np.zeros(4, dtype=np.uint8))
    head, _, columns, *rows = runs_text([loop, other]).splitlines()
    assert "velocity control, sine -1.04 to 1.04 rad/s at 0.25 rad/s, 2.5 s" in head
    assert "first 2 s" in head
    assert rows_of(columns)[0] == ["scheme", "RMS, rad/s", "peak", "true RMS", "status"]
    assert [row.split()[0] for row in rows] == ["coulomb", "none"]
    values = [float(x) for x in rows[0].split()[1:4]]
    assert values == pytest.approx([loop.rms, loop.peak, loop.true_rms], rel=5e-3)


def test_loop_runs_are_drawn_in_columns_with_axis_labels_on_the_first_only(loop: Result) -> None:
    results = [run(None, "none", SHORT), loop]
    axes = np.array(plot_runs(results).axes).reshape(5, 2)
    for column, result in zip(axes.T, results, strict=True):
        assert column[0].get_title(loc="left") == result.scheme
        drawn = {line.get_label(): line.get_ydata() for line in column[0].lines}
        assert np.array_equal(drawn["reference"], result.reference)
        assert np.array_equal(drawn["response"], result.velocity_rad_s)
        friction = {line.get_label() for line in column[3].lines}
        assert ("estimated" in friction) == (result.scheme != "none")
    named = [[ax.get_ylabel() for ax in column if ax.get_ylabel()] for column in axes.T]
    assert named[0] == ["Speed (rad/s)", "Error (rad/s)", "Friction (V)", "Friction (V)"]
    assert named[1] == []
    assert [ax.get_ylabel() for ax in plot_run_of_loop(loop)[:4]] == named[0]


ROWS = ("position sine", "velocity triangle")
RATIOS = {"load doubled": (0.5, 0.25), "noise": (0.1234, 1.0), "belt": (1.5, 0.2)}
RATIOS["motor"] = (0.1, 0.2)
OUTCOMES = [Outcome(name, dict(zip(ROWS, x, strict=True))) for name, x in RATIOS.items()]


def test_robustness_text_and_json_have_ratios_and_verdict_of_each_case() -> None:
    rows = rows_of(robustness_text(OUTCOMES))
    start = rows.index(["plant", "p sine", "v triangle", "worst"])
    assert rows[start + 1 : start + 5] == [
        ["load doubled", "0.500", "0.250", "0.500", "help"],
        ["noise", "0.123", "1.000", "1.000", "neutral"],
        ["belt", "1.500", "0.200", "1.500", "harm"],
        ["motor", "0.100", "0.200", "0.200", "help"],
    ]
    assert rows[-1] == ["help 2, neutral 1, harm 1"]
    ratios = {"position sine": 1.5, "velocity triangle": 0.2}
    belt = {"name": "belt", "ratios": ratios, "worst": 1.5, "verdict": "harm"}
    assert robustness_dict(OUTCOMES)["cases"][2] == belt


def test_robustness_plot_marks_the_worst_ratio_of_each_case() -> None:
    (ax,) = plot_robustness(OUTCOMES).axes
    place = {t.get_text(): y for t, y in zip(ax.get_yticklabels(), ax.get_yticks(), strict=True)}
    # The first case is at the top.
    assert place["load doubled"] > place["motor"]
    points: dict[str, set[tuple[float, float]]] = {"o": set(), "D": set()}
    for line in ax.lines:
        if line.get_marker() in points:
            points[str(line.get_marker())] |= {(float(x), float(y)) for x, y in line.get_xydata()}  # type: ignore[union-attr]
    assert points["D"] == {(o.worst, float(place[o.name])) for o in OUTCOMES}
    assert points["o"] == {(r, float(place[o.name])) for o in OUTCOMES for r in o.ratios.values()}
    assert {line.get_color() for line in ax.lines} >= {MODEL, BEFORE}


def cell(row: str, column: str, rms: float, printed: float | None) -> Cell:
    """A cell with a peak of four times its RMS and a true error of half of its RMS."""
    peak = None if printed is None else 2.0 * printed
    return Cell(row, column, rms, 4.0 * rms, printed, peak, 0.5 * rms)


def tables_of(*cells: Cell) -> Tables:
    return Tables({(c.row, c.column): c for c in cells}, thesis_model(), THESIS_BENCH)


SCHEMES = ("none", "learning", "coulomb", "observed")
POSITION = zip(SCHEMES, (0.44, 0.2, 0.3, 0.05), (0.4, 0.1, None, None), strict=True)
VELOCITY = zip(SCHEMES, (0.3, 0.04, 0.63, 0.08), (0.5, 0.1, 0.3, None), strict=True)
SMALL = tables_of(
    *(cell("position sine", *numbers) for numbers in POSITION),
    *(cell("velocity sine", *numbers) for numbers in VELOCITY),
)
GAINS = dict(zip(TASKS, (1.0, 2.0, 0.5, 4.0, 8.0, 1.5, 3.0), strict=True))


def tables_with_gains() -> Tables:
    """The error of the better of two schemes is that of the observed scheme times `GAINS`."""
    cells = []
    for i, (row, gain) in enumerate(GAINS.items()):
        better, worse = (0.6, 0.9) if i % 2 else (0.9, 0.6)
        cells.append(Cell(row, "none", 1.2, 1.0, 1.0, None, 1.0))
        for column, true in (("learning", better), ("coulomb", worse), ("observed", 0.6 / gain)):
            printed = 0.6 if column == "learning" and i < 3 else None
            cells.append(Cell(row, column, 1.0, 1.0, printed, None, true))
    return tables_of(*cells)


def test_thesis_tables_text_has_simulated_and_printed_errors_and_their_ratio() -> None:
    rows = rows_of(tables_text(SMALL))
    sine = ["0.440 / 0.400 = 1.10", "0.200 / 0.100 = 2.00", "0.300 / - = -", "0.0500"]
    fast = ["0.300 / 0.500 = 0.60", "0.0400 / 0.100 = 0.40", "0.630 / 0.300 = 2.10", "0.0800"]
    sine_peaks = ["1.76 / 0.800", "0.800 / 0.200", "1.20 / -", "0.200"]
    assert [row[1:] for row in rows if row[0] == "position sine"] == [sine, sine_peaks]
    assert next(row[1:] for row in rows if row[0] == "velocity sine") == fast


def test_thesis_score_counts_ratios_within_factors_and_lists_those_beyond_two() -> None:
    fitted, predicted, far = score_text(SMALL).splitlines()
    assert "40 %" in fitted
    assert re.findall(r"\d+(?= cells| within)", predicted) == ["3", "1", "0"]
    assert re.findall(r"\((\d\.\d\d)\)", far) == ["0.40", "2.10"]
    cells = (("none", 1.25, 1.0), ("learning", 1.0, 2.0), ("coulomb", 1.4, 1.0))
    near = tables_of(*(cell("a", *numbers) for numbers in cells))
    fitted, predicted = score_text(near).splitlines()
    assert "25 %" in fitted
    assert re.findall(r"\d+(?= cells| within)", predicted) == ["2", "2", "1"]


def test_fitted_friction_scale_is_printed_in_volts_at_the_load_of_the_rig() -> None:
    """The voltage is 28.26 mV/N times 104 N."""
    rows = rows_of(tables_report(tables_with_gains(), []))
    scale = next(row[1] for row in rows if row[0] == "friction scale")
    assert float(scale.split()[0]) == pytest.approx(2.939, abs=1e-3)
    lines = rows_of("\n".join(friction_lines(thesis_model(K0=1.5e6, gamma=33.0), 0.03, 100.0)))
    numbers = {row[0]: float(row[1].split()[0]) for row in lines}
    assert numbers["friction scale"] == 3.0
    assert (numbers["K0"], numbers["gamma"]) == (1.5e6, 33.0)


def test_thesis_tables_json_has_friction_ratios_gains_and_assumptions() -> None:
    found = tables_with_gains()
    content: dict[str, Any] = tables_dict(found, [("as it is", SMALL)])
    assert content["friction"]["volts_per_n"] == THESIS_BENCH.volts_per_n
    assert content["friction"]["K0"] == found.model.parameters["K0"].value
    assert content["times_better"] == pytest.approx(GAINS)
    assert {c["ratio"] for c in content["cells"] if c["column"] == "none"} == {1.2}
    # Three ratios of 1 / 0.6.
    assert (content["within_2"], content["within_1.5"]) == (3, 0)
    (other,) = content["assumptions"]
    assert (other["name"], other["within_2"], other["within_1.5"]) == ("as it is", 1, 0)
    ratios = {"position sine, learning": 2.0, "velocity sine, learning": 0.4}
    assert other["ratios"] == pytest.approx(ratios | {"velocity sine, coulomb": 2.1})


def test_thesis_tables_plot_has_a_bar_per_cell_and_a_diamond_per_printed_figure() -> None:
    (ax,) = plot_tables(SMALL).axes
    heights = np.array([[bar.get_height() for bar in group] for group in ax.containers])
    # The true error of the observed compensator is shown.
    assert heights.tolist() == [[0.44, 0.3], [0.2, 0.04], [0.3, 0.63], [0.025, 0.04]]
    groups = ax.containers
    centres = np.array([[b.get_x() + 0.5 * b.get_width() for b in group] for group in groups])
    assert centres.mean(axis=0) == pytest.approx([0.0, 1.0])
    assert np.all(np.diff(centres, axis=0) >= ax.patches[0].get_width())  # type: ignore[attr-defined]
    diamonds = np.concatenate([np.asarray(line.get_xydata()) for line in ax.lines])
    assert diamonds[:, 0] == pytest.approx([*centres[0], *centres[1], centres[2, 1]])
    assert diamonds[:, 1].tolist() == [0.4, 0.5, 0.1, 0.1, 0.3]
