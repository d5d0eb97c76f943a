"""Runs of the loop, robustness and the thesis's tables as text: whole lines, to the letter."""

from __future__ import annotations

import re
from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from jbf.control import TASKS, THESIS_BENCH, thesis_model
from jbf.control.constants import FALLBACK, FROZEN, JUMPED, NOT_FINITE, SATURATED
from jbf.control.robustness import Outcome
from jbf.control.task import Task
from jbf.control.thesis_tables import Cell, Tables
from jbf.reporting.control_json import robustness_dict, tables_dict
from jbf.reporting.control_run_text import robustness_text, runs_text, status_words
from jbf.reporting.control_tables_text import (
    assumptions_text,
    better_text,
    friction_lines,
    score_text,
    tables_report,
    tables_text,
)

SINE = Task("velocity", "sine", -1.04, 1.04, 0.25, 52.0, 2.0)


def result_of(scheme: str, rms: float, status: list[int], task: Task = SINE) -> Any:
    """A run of the loop, as far as a text tells it."""
    flags = np.array(status, dtype=np.uint8)
    return SimpleNamespace(
        scheme=scheme, task=task, rms=rms, peak=2.0 * rms, true_rms=3.0 * rms, status=flags
    )


def tables_of(*cells: Cell) -> Tables:
    return Tables({(c.row, c.column): c for c in cells}, thesis_model(), THESIS_BENCH)


def cell(row: str, column: str, rms: float, printed: float | None) -> Cell:
    """A cell whose peak is four and whose true error is half of its RMS."""
    peak = None if printed is None else 2.0 * printed
    return Cell(row, column, rms, 4.0 * rms, printed, peak, 0.5 * rms)


SMALL = tables_of(
    cell("position sine", "none", 0.44, 0.4),
    cell("position sine", "learning", 0.2, 0.1),
    cell("position sine", "coulomb", 0.3, None),
    cell("position sine", "observed", 0.05, None),
    cell("velocity sine", "none", 0.3, 0.5),
    cell("velocity sine", "learning", 0.04, 0.1),
    cell("velocity sine", "coulomb", 0.63, 0.3),
    cell("velocity sine", "observed", 0.08, None),
)


@pytest.mark.parametrize(
    ("status", "said"),
    [
        ([0, 0, 0, 0], "ok"),
        ([SATURATED, 0, 0, 0], "saturated 25 %"),
        ([FROZEN | FALLBACK, FALLBACK, 0, 0], "encoder frozen 25 %, control law alone 50 %"),
        ([JUMPED, NOT_FINITE, SATURATED, SATURATED],
         "saturated 50 %, encoder jumped 25 %, reference not finite 25 %"),
        ([FALLBACK] * 3, "control law alone 1e+02 %"),
        ([JUMPED, *[0] * 15], "encoder jumped 6.2 %"),
    ],
)  # fmt: skip
def test_a_status_is_told_with_the_share_of_the_run_that_it_lasted(
    status: list[int], said: str
) -> None:
    """Each flag by its word, in percent of the samples that have it."""
    assert status_words(result_of("none", 1.0, status)) == said


def test_runs_stand_below_their_task() -> None:
    """Task, frequency, length and what is left out; below it a line a scheme."""
    found = [result_of("none", 0.468, [0]), result_of("coulomb", 0.0386, [SATURATED, 0])]
    assert runs_text(found).splitlines() == [
        "velocity control, sine -1.04 to 1.04 rad/s at 0.25 rad/s, 52 s, the first 2 s left out",
        "",
        "  scheme   RMS, rad/s    peak  true RMS  status",
        "  none          0.468   0.936      1.40  ok",
        "  coulomb      0.0386  0.0772     0.116  saturated 50 %",
    ]


def test_a_recorded_task_has_no_frequency_and_one_from_the_start_leaves_nothing_out() -> None:
    """What does not hold of a task is not said of it."""
    recorded = replace(SINE, control="position", wave="recorded", skip_s=0.0, low=-0.12345)
    (head, *_) = runs_text([result_of("none", 1.0, [0], recorded)]).splitlines()
    assert head == "position control, recorded -0.123 to 1.04 rad, 52 s"
    (head, *_) = runs_text([result_of("none", 1.0, [0], replace(SINE, skip_s=0.0))]).splitlines()
    assert head == "velocity control, sine -1.04 to 1.04 rad/s at 0.25 rad/s, 52 s"


def test_robustness_is_told_case_by_case_and_counted() -> None:
    """Ratios to three decimals, the worst, the verdict; how many help, do neither, harm."""
    rows = ("position sine", "velocity triangle")
    outcomes = [
        Outcome("load doubled", dict(zip(rows, (0.5, 0.25), strict=True))),
        Outcome("noise", dict(zip(rows, (0.1234, 1.0), strict=True))),
        Outcome("belt", dict(zip(rows, (1.5, 0.2), strict=True))),
        Outcome("motor", dict(zip(rows, (0.1, 0.2), strict=True))),
    ]
    assert robustness_text(outcomes).splitlines() == [
        "True RMS error with compensation over that without; the compensator carries the bare law.",
        "help: every row below 0.95; harm: a row above 1.02; p position, v velocity.",
        "",
        "  plant         p sine  v triangle  worst",
        "  load doubled   0.500       0.250  0.500  help",
        "  noise          0.123       1.000  1.000  neutral",
        "  belt           1.500       0.200  1.500  harm",
        "  motor          0.100       0.200  0.200  help",
        "",
        "help 2, neutral 1, harm 1",
    ]
    assert robustness_dict(outcomes)["cases"][2] == {
        "name": "belt",
        "ratios": {"position sine": 1.5, "velocity triangle": 0.2},
        "worst": 1.5,
        "verdict": "harm",
    }


def test_the_four_fitted_numbers() -> None:
    """Volts under the rig's load, then the law's own."""
    assert friction_lines(thesis_model(U_tr_m_s=0.05, K0=1.5e6, gamma=33.0), 0.03, 100.0) == [
        "  friction scale  3.000 V      for a coefficient of 1",
        "  U_tr            0.05000 m/s",
        "  K0              1.5e+06",
        "  gamma           33.00",
    ]


def test_cells_that_are_not_in_print_have_a_dash_and_ours_stands_last() -> None:
    """RMS with its ratio, peaks without; what the thesis has not stands in a column of its own."""
    lines = [re.split("  +", line) for line in tables_text(SMALL).splitlines()]
    head = ["", "no compensation", "dynamic model, learned", "Coulomb", "observed"]
    sine = ["0.440 / 0.400 = 1.10", "0.200 / 0.100 = 2.00", "0.300 / - = -", "0.0500"]
    fast = ["0.300 / 0.500 = 0.60", "0.0400 / 0.100 = 0.40", "0.630 / 0.300 = 2.10", "0.0800"]
    assert lines == [
        ["RMS error, rad or rad/s: bench / thesis = ratio"],
        [""],
        head,
        ["", "position sine", *sine],
        ["", "velocity sine", *fast],
        [""],
        ["Peak error, likewise: bench / thesis"],
        [""],
        head,
        ["", "position sine", "1.76 / 0.800", "0.800 / 0.200", "1.20 / -", "0.200"],
        ["", "velocity sine", "1.20 / 1.00", "0.160 / 0.200", "2.52 / 0.600", "0.320"],
    ]


def test_which_predicted_cells_are_near_and_which_are_far() -> None:
    """Worst of those that were fitted, either way; far is beyond a factor of two, either way."""
    assert score_text(SMALL).splitlines() == [
        "Fitted: the seven cells without compensation, worst 40 % off.",
        "Predicted: of 3 cells 1 within a factor of 2, 0 within 1.5.",
        "Further off: velocity sine, dynamic model, learned (0.40); velocity sine, Coulomb (2.10).",
    ]
    near = tables_of(cell("a", "none", 1.25, 1.0), cell("a", "learning", 1.0, 2.0),
                     cell("a", "coulomb", 1.4, 1.0))  # fmt: skip
    assert score_text(near).splitlines() == [
        "Fitted: the seven cells without compensation, worst 25 % off.",
        "Predicted: of 2 cells 2 within a factor of 2, 1 within 1.5.",
    ]


def test_other_assumptions_stand_in_a_line_each() -> None:
    """Ratios row by row, and how many cells are near."""
    near = tables_of(cell("a", "learning", 1.0, 1.0), cell("a", "coulomb", 1.9, 1.0))
    assert assumptions_text([("as it is", SMALL), ("other", near)]).splitlines() == [
        "Other assumptions: ratios of the RMS, row by row, and cells within a factor",
        "",
        "            dynamic model, learned  Coulomb  in 2  in 1.5",
        "  as it is  2.00 0.40               - 2.10      1       0",
        "  other     1.00                    1.90        2       1",
    ]


GAINS = dict(zip(TASKS, (1.0, 2.0, 0.5, 4.0, 8.0, 1.5, 3.0), strict=True))


def better_tables() -> Tables:
    """Ours better by so much than the better of the thesis's two, which is now one, now other."""
    cells = {}
    for i, (row, gain) in enumerate(GAINS.items()):
        better, worse = (0.6, 0.9) if i % 2 else (0.9, 0.6)
        for column, true in (("learning", better), ("coulomb", worse), ("observed", 0.6 / gain)):
            cells[row, column] = Cell(row, column, 1.0, 1.0, None, None, true)
        cells[row, "none"] = Cell(row, "none", 1.2, 1.0, 1.0, None, 1.0)
    return Tables(cells, thesis_model(), THESIS_BENCH)


def test_ours_beside_the_better_of_the_thesiss_two() -> None:
    """True errors and by how much ours is lower; rows in which it is, and the median."""
    said = better_text(better_tables()).splitlines()
    assert said[0] == "True RMS error (of the shaft, not of the loop's estimate), rad or rad/s:"
    assert said[1] == ""
    assert said[2].split("  ")[-4:] == ["dynamic model", "Coulomb", "observed", "times better"]
    assert [line.split()[-1] for line in said[3:10]] == [f"{gain:.1f}" for gain in GAINS.values()]
    assert said[3].split() == ["position", "triangle", "0.900", "0.600", "0.600", "1.0"]
    assert said[10:] == [
        "",
        "The observed compensator has the lower error in 5 of 7 rows, 2.0 times in the median.",
    ]


def test_the_whole_report_has_its_parts_in_order() -> None:
    """Friction of the bench at the rig's load, tables, score, assumptions, gains, where to read."""
    found = better_tables()
    said = tables_report(found, [("as it is", found)])
    load = found.model.rig.load
    assert load is not None
    parts = [
        "Friction of the bench, fitted to the seven cells without compensation:\n",
        "\n".join(friction_lines(found.model, THESIS_BENCH.volts_per_n, load.normal_n)),
        tables_text(found),
        score_text(found),
        assumptions_text([("as it is", found)]),
        better_text(found),
        "docs/control.md says how scale, clock, start and missing effect were settled, and why the",
    ]
    assert said == "\n\n".join([parts[0].rstrip(), *parts[1:]]) + "\ncells that are off are off."


def test_tables_as_data_for_json() -> None:
    """Friction, cells with their ratio, how many are near, gains, and each assumption by name."""
    found = better_tables()
    told = tables_dict(found, [("as it is", SMALL)])
    assert told["friction"]["volts_per_n"] == THESIS_BENCH.volts_per_n
    assert told["friction"]["K0"] == found.model.parameters["K0"].value
    assert told["times_better"] == pytest.approx(GAINS)
    assert [c["ratio"] for c in cast(Any, told["cells"])[:4]] == [None, None, None, 1.2]
    (other,) = told["assumptions"]
    assert (other["name"], other["within_2"], other["within_1.5"]) == ("as it is", 1, 0)
    assert other["ratios"] == {
        "position sine, learning": 2.0,
        "velocity sine, learning": pytest.approx(0.4),
        "velocity sine, coulomb": pytest.approx(2.1),
    }
