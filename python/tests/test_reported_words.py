"""What reports say of numbers, and under which heading each effect stands."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest
from jbf import Model, Rig
from jbf.control import TASKS, THESIS_BENCH, run, thesis_model
from jbf.control.thesis_tables import Cell, Tables
from jbf.diagnosis.check import Check, Rate
from jbf.diagnosis.result import Diagnosis
from jbf.diagnosis.which_law import LawTried
from jbf.estimation.noise import Noise
from jbf.models import catalogue
from jbf.records.findings.finding import Finding
from jbf.reporting.catalogue_text import effects_page
from jbf.reporting.check_text import check_report
from jbf.reporting.control_run_plot import plot_runs
from jbf.reporting.control_tables_text import better_text
from jbf.reporting.fit_text import noise_words
from jbf.reporting.paragraphs import columns
from jbf.reporting.tables import finding_rows
from jbf.reporting.words import number, times, verdict_sentence


def test_an_error_in_multiples_of_the_noise() -> None:
    assert times(2.58, 2.0) == "1.29 times"
    assert times(0.1, 0.2) == "0.50 times"
    assert times(1.0, 0.0) == "above"


def test_each_effect_stands_under_its_own_stage_and_each_stage_once() -> None:
    pages = catalogue.effects()
    stage, headings, placed = "", [], {}
    for line in effects_page(pages.values()).splitlines():
        if line.startswith("["):
            stage = line.strip("[]")
            headings.append(stage)
        elif line[:3].strip() and line.split()[0] in pages:
            placed[line.split()[0]] = stage
    assert placed == {name: page.stage for name, page in pages.items()}
    assert len(headings) == len(set(headings)) > 2


@pytest.mark.parametrize("effects", [(), ("coulomb_drag",), ("coulomb_drag", "presliding")])
def test_what_remains_is_said_beside_what_is_missing(
    make_diagnosis: Callable[[str], Diagnosis], effects: tuple[str, ...]
) -> None:
    said = verdict_sentence(replace(make_diagnosis("unexplained"), effects=effects))
    assert "omething remains that no effect in the catalogue explains" in said
    assert said.startswith(f"Missing: {' and '.join(effects)}. With" if effects else "Something")
    assert ("With them, the held-out error falls" in said) == (len(effects) == 2)
    assert ("With it, the held-out error falls" in said) == (len(effects) == 1)


def test_another_law_is_said_beside_what_this_one_reaches(
    make_diagnosis: Callable[[str], Diagnosis],
) -> None:
    d = make_diagnosis("missing")
    first, last = d.steps[0].holdout_rms_n, d.steps[-1].holdout_rms_n
    assert number(first) != number(last)
    said = verdict_sentence(replace(d, simpler_law=LawTried("stribeck", 4, 0.123, False)))
    assert f"stribeck, which needs no other friction beside it, predicts runs left out to within "\
        f"0.123 N, {d.model.law} with all of this to {number(last)} N;" in said  # fmt: skip


@pytest.mark.parametrize("tied", [True, False])
def test_a_law_that_the_data_chose_is_said_with_those_that_predict_alike(
    tied: bool, make_diagnosis: Callable[[str], Diagnosis]
) -> None:
    laws = (LawTried("coulomb", 2, 0.1, True), LawTried("stribeck", 4, 0.1, tied))
    said = verdict_sentence(replace(make_diagnosis("adequate"), laws=laws))
    if tied:
        assert "the law coulomb, the simplest of those that predict alike (stribeck too)." in said
    else:
        assert "The data chose the law coulomb." in said


def test_a_row_of_another_length_is_no_row_of_a_table() -> None:
    assert columns([("a", "bb"), ("cc", "d")], "<>", indent=1) == [" a   bb", " cc   d"]
    with pytest.raises(ValueError, match="zip"):
        columns([("a", "b"), ("a", "b", "c")], "<<")


def test_the_picture_of_loops_has_every_scheme_and_draws_its_numbers() -> None:
    task = replace(TASKS["velocity sine"], seconds=6.0)
    results = [run(None, scheme, task) for scheme in ("none", "observed")]
    axes = np.array(plot_runs(results).axes).reshape(5, 2)
    for column, result in enumerate(results):
        top = axes[0, column]
        assert top.get_title(loc="left") == result.scheme
        drawn = {line.get_label(): line.get_ydata() for line in top.lines}
        assert np.array_equal(drawn["reference"], result.reference)
        assert np.array_equal(drawn["response"], result.velocity_rad_s)
        friction = {line.get_label() for line in axes[3, column].lines}
        assert ("estimated" in friction) == (result.scheme != "none")


def test_the_words_of_a_noise() -> None:
    assert noise_words(Noise()) == "white"
    assert noise_words(Noise(0.5, 0.3)) == "coloured, share 0.30, memory 0.50 s"


def test_findings_of_a_kind_stand_in_one_row_and_name_three_runs() -> None:
    made = [
        Finding("held_samples", "friction_n", f"run {i}", 0.1, "s", "set aside", "held")
        for i in range(5)
    ]
    made.append(Finding("glitches", "angle_rad", "run 9", 2.0, "rad", "weighed", "one jump"))
    assert finding_rows(made) == [
        ("held samples", "held, in run 0, run 1, run 2 and 2 runs more (set aside)"),
        ("glitches", "one jump, in run 9 (weighed)"),
    ]


def test_a_rate_has_its_interval_in_percent() -> None:
    """Ten of ten: Clopper and Pearson's lower end is 0.025 ** (1 / 10)."""
    rate = Rate.of("hidden, and named", [True] * 10)
    told = SimpleNamespace(rates=(rate,), model=Model(Rig.thesis()))
    assert "10 of 10  100 %  69.2 to 100 %" in check_report(cast(Check, told))


def test_ours_is_better_in_as_many_rows_as_it_is() -> None:
    ours = dict(zip(TASKS, (0.5, 0.25, 2.0, 0.1, 4.0, 0.8, 0.05), strict=True))
    cells = {
        (row, column): Cell(row, column, 1.0, 1.0, None, None, size)
        for row in TASKS
        for column, size in (("learning", 1.0), ("coulomb", 2.0), ("observed", ours[row]))
    }
    said = better_text(Tables(cells, thesis_model(), THESIS_BENCH))
    assert "lower error in 5 of 7 rows, 2.0 times in the median" in said
