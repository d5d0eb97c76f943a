"""Numbers as pages and tables tell them, each against one that is worked out here."""

from __future__ import annotations

import re
import warnings
from collections.abc import Callable
from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from jbf.control import TASKS, THESIS_BENCH, run, thesis_model
from jbf.control.robustness import Outcome
from jbf.control.run import _mend
from jbf.control.thesis_tables import Cell, Tables
from jbf.diagnosis.late_channels import _finding
from jbf.diagnosis.level import Level
from jbf.diagnosis.policy import DEFAULT
from jbf.diagnosis.result import Diagnosis
from jbf.plot.style import axes_or_new
from jbf.records.motion.compared import compared
from jbf.reporting.control_run_plot import plot_runs
from jbf.reporting.control_run_text import robustness_text
from jbf.reporting.control_tables_text import (
    assumptions_text,
    score_text,
    tables_report,
    tables_text,
)
from jbf.reporting.cut_plot import _shade
from jbf.reporting.gallery import _sentence, _shares
from jbf.reporting.page import pattern_rows
from jbf.reporting.power_text import level_words


@pytest.mark.parametrize(("share", "said"), [(0.5, "50 %"), (0.99, "99 %"), (0.004, "0 %")])
def test_a_share_in_percent(share: float, said: str) -> None:
    pattern = SimpleNamespace(axis="angle", share=share, where="once a turn")
    assert pattern_rows([cast(Any, pattern)]) == [("angle", said, "once a turn")]


@pytest.mark.parametrize(("named", "said"), [(0, "3 %"), (4, "8.9 %"), (61, "69 %"), (99, "100 %")])
def test_false_names_of_a_hundred_decoys_in_percent(named: int, said: str) -> None:
    """Clopper and Pearson's upper limit of so many of a hundred, 95 %."""
    level = Level.shared(DEFAULT, 20, 1000.0, 1.0)
    words = level_words(replace(level, decoys=100, decoys_named=named))
    # No residual has been asked yet.
    assert level.blocks == 0
    assert "by the residual itself" not in words
    assert f"{named} would have made a name (false names below {said})" in words


def tables_of(rms: float, printed: float) -> Tables:
    """Tables whose every cell is so much, beside so much in print."""
    cells = {
        (row, column): Cell(row, column, rms, 2.0 * rms, printed, 3.0 * printed, rms)
        for row in TASKS
        for column in ("none", "learning", "coulomb", "observed")
    }
    return Tables(cells, thesis_model(), THESIS_BENCH)


def test_every_cell_stands_beside_the_one_in_print() -> None:
    said = [re.split("  +", line.strip()) for line in tables_text(tables_of(0.3, 0.2)).splitlines()]
    for row in TASKS:
        rms, peak = (cells[1:] for cells in said if cells[0] == row)
        assert rms == ["0.300 / 0.200 = 1.50"] * 3 + ["0.300"]
        assert peak == ["0.600 / 0.600"] * 3 + ["0.600"]


def test_how_many_cells_are_near_the_thesis() -> None:
    assert "worst 50 % off" in score_text(tables_of(0.3, 0.2))
    (line,) = (x for x in assumptions_text([("as it is", tables_of(0.3, 0.2))]).splitlines()[3:])
    assert line.split()[3:] == ["1.50"] * 14 + ["14", "14"]


def test_the_friction_scale_is_in_volts_under_the_rigs_load() -> None:
    found = re.search(r"friction scale +(\S+) V", tables_report(tables_of(0.3, 0.2), []))
    assert found is not None
    # 28.26 mV a newton, 104 N.
    assert float(found[1]) == pytest.approx(2.939, abs=1e-3)


def test_robustness_names_its_columns_by_a_letter() -> None:
    names = ("position sine", "velocity triangle")
    outcomes = [Outcome("nothing", dict(zip(names, (0.5, 1.2), strict=True)))]
    head, row = robustness_text(outcomes).splitlines()[3:5]
    assert head.split() == ["plant", "p", "sine", "v", "triangle", "worst"]
    assert row.split() == ["nothing", "0.500", "1.200", "1.200", outcomes[0].verdict]


@pytest.mark.parametrize(
    ("names", "said"), [(["slow_1"], ["slow_1"]), (["slow_1", "slow_2"], ["1", "2"])]
)
def test_a_run_that_is_alone_has_its_whole_name(names: list[str], said: list[str]) -> None:
    pieces = [
        SimpleNamespace(file="a.csv", keep=True, segment=0, from_s=k, to_s=k + 1.0, name=name)
        for k, name in enumerate(names)
    ]
    view = SimpleNamespace(file="a.csv", starts_s=[0.0])
    (ax,) = axes_or_new(None, 1, 1, (4.0, 3.0))
    _shade(ax, cast(Any, SimpleNamespace(pieces=pieces)), cast(Any, view))
    assert [text.get_text() for text in ax.texts] == said


def test_what_makes_half_of_a_pattern_has_half_of_it(
    make_diagnosis: Callable[[str], Diagnosis],
) -> None:
    before = make_diagnosis("missing").before
    failure = before.failures[0]
    half = [0.5 * r for r in before.residuals]
    shares = _shares(before, failure, {"half": half, "nothing": [0.0 * r for r in half]})
    assert shares == {"half": pytest.approx(0.5)}


def test_of_a_pattern_that_no_axis_shows_no_effect_makes_a_part(
    make_diagnosis: Callable[[str], Diagnosis],
) -> None:
    """Along the model's force, which an effect moves itself; of no means at all; in other bins."""
    before = make_diagnosis("missing").before
    failure = before.failures[0]
    made = {"all of it": before.residuals}
    assert _shares(before, failure, made)
    for other in (
        replace(failure, axis="force"),
        replace(failure, means_n=0.0 * failure.means_n),
        replace(failure, bins=failure.bins[1:]),
    ):
        assert _shares(before, other, made) == {}


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("sensor_lag and another fit as well", "sensor_lag and another fit as well."),
        ("check the zero, and sensor_drift.", "Check the zero, and sensor_drift."),
        ("wear", "Wear."),
    ],
)
def test_a_sentence_has_a_capital_and_an_effect_keeps_its_name(words: str, said: str) -> None:
    assert _sentence(words) == said


def test_the_rows_of_a_picture_of_loops_are_named_once() -> None:
    task = replace(TASKS["velocity sine"], seconds=6.0)
    results = [run(None, scheme, task) for scheme in ("none", "coulomb")]
    axes = np.array(plot_runs(results).axes).reshape(-1, 2)
    named = [[ax.get_ylabel() for ax in column if ax.get_ylabel()] for column in axes.T]
    assert len(named[0]) >= 4
    assert named[1] == []


@pytest.mark.parametrize(("drift", "way"), [(2e-5, "slower"), (-2e-5, "faster")])
def test_a_clock_that_drifts_is_slower_or_faster(drift: float, way: str) -> None:
    words = _finding("run1", 1e-3, drift).words
    assert f"runs {way} than the motion's by 20 parts in a million: +1 ms" in words


@pytest.mark.parametrize(
    ("problem", "mend"), [("top_speed_rad_s is 9", "lower counts"), ("dt_s is 0", "correct it")]
)
def test_what_to_do_about_a_loop_that_is_refused(problem: str, mend: str) -> None:
    assert _mend(problem).startswith(mend)


@pytest.mark.parametrize(("samples", "widths"), [(30, 0), (67, 0), (68, 1), (76, 2), (92, 3)])
def test_a_short_path_is_compared_over_few_widths(samples: int, widths: int) -> None:
    time = 0.01 * np.arange(samples)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert len(list(compared(time, 0.1 * time, np.full(samples, 0.1)))) == widths
