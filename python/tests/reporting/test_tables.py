"""Rows of cells for texts and pages: parameters, steps, runs, findings, power, laws."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from by_hand import diagnosis_by_hand, fit_by_hand
from jbf import ParameterValue
from jbf.diagnosis import Step
from jbf.diagnosis.power import Power
from jbf.diagnosis.which_law import LawTried
from jbf.records.findings.finding import Finding
from jbf.records.quantities import LINEAR, ROTARY
from jbf.reporting import tables
from jbf.reporting.text_parts import finding_lines, parameter_lines
from jbf.reporting.words import step_name

VALUES = {
    "F_c": ParameterValue(4.9876, 0.0123),
    "F_v": ParameterValue(20.0),
    "own": ParameterValue(0.0, 0.5, "at its bound"),
}


def test_parameter_row_has_value_error_share_unit_and_note() -> None:
    assert tables.parameter_rows("coulomb", (), VALUES) == [
        ("F_c", "4.988", "0.012", "0.25 %", "N", ""),
        ("F_v", "20.000", "", "", "N s/m", "no error known"),
        ("own", "0.00", "0.50", "", "", "at its bound"),
    ]


def test_parameter_rows_of_a_rotary_drive_have_its_units_but_not_in_the_name() -> None:
    rows = tables.parameter_rows("coulomb", (), VALUES, ROTARY)
    assert [(row[0], row[4]) for row in rows] == [("F_c", "N m"), ("F_v", "N m s/rad"), ("own", "")]


def test_parameter_lines_are_aligned_and_omit_missing_parts() -> None:
    assert parameter_lines("coulomb", (), VALUES) == [
        "    F_c   4.988  +/- 0.012  (0.25 %)  N",
        "    F_v  20.000                       N s/m  (no error known)",
        "    own    0.00   +/- 0.50                   (at its bound)",
    ]


def test_correlations_above_three_tenths_are_listed_strongest_first() -> None:
    """The table of correlations excludes held parameters."""
    fit = fit_by_hand(["sensor_offset"])
    strongest, weakest = tables.correlation_pairs(fit)
    assert strongest == ("F_c", "F_v", -0.9)
    assert weakest == ("F_c", "sensor_offset.b", 0.45)
    table = np.array([[1.0, 0.3, np.nan], [0.3, 1.0, -0.301], [np.nan, -0.301, 1.0]])
    weak = replace(fit, correlations=table)
    assert tables.correlation_pairs(weak) == [("F_v", "sensor_offset.b", -0.301)]


def test_ratio_to_the_noise_is_an_empty_text_if_the_noise_is_zero() -> None:
    assert [tables.ratio(1.0, noise) for noise in (0.3, 0.0)] == ["3.33", ""]


def test_law_rows_mark_the_chosen_law_and_those_that_predict_as_well_or_worse() -> None:
    laws = (LawTried("a", 2, 0.5, True), LawTried("b", 4, 0.51, True), LawTried("c", 6, 1, False))
    assert tables.law_rows(replace(diagnosis_by_hand("missing"), laws=laws)) == [
        ("a", "2", "0.500", "selected"),
        ("b", "4", "0.510", "equally good"),
        ("c", "6", "1.00", "worse"),
    ]


def test_name_of_a_step_lists_the_effects_that_it_added_and_removed() -> None:
    effects = [(), ("a",), ("a", "b", "c"), ("b", "c"), ("b", "c"), ("b", "d")]
    steps = tuple(Step(names, 1.0, 1.0, 1.0) for names in effects)
    diagnosis = replace(diagnosis_by_hand("missing"), steps=steps)
    names = [step_name(diagnosis, i) for i in range(len(steps))]
    assert names == ["base law", "+ a", "+ b, + c", "- a", "refitted", "+ d, - c"]
    assert step_name(replace(diagnosis, steps=steps[2:]), 0) == "base law + a, b, c"


def findings_of(*cases: tuple[str, str]) -> list[Finding]:
    """Findings of one kind, each with its run and its text."""
    return [Finding("slow_channel", "c", run, 1.0, "s", "left", words) for run, words in cases]


@pytest.mark.parametrize(
    ("texts", "expected"),
    [
        ("xxx", "x, in a, b, c (left)"),
        ("xyxxx", "x, in a, c, d and 1 run more; y, in b (left)"),
        ("xyzwvv", "x, in a; y, in b; z, in c; and in 3 other runs (left)"),
    ],
)
def test_finding_row_lists_up_to_three_runs_and_three_texts(texts: str, expected: str) -> None:
    cases = zip("abcdef", texts, strict=False)
    assert tables.finding_rows(findings_of(*cases)) == [("slow channel", expected)]


def test_findings_have_one_row_for_each_kind_and_an_empty_list_has_no_heading() -> None:
    other = Finding("glitches", "angle_rad", "a", 2.0, "rad", "weighed", "one jump")
    assert tables.finding_rows([*findings_of(("a", "x")), other]) == [
        ("slow channel", "x, in a (left)"),
        ("glitches", "one jump, in a (weighed)"),
    ]
    assert tables.finding_rows([]) == []
    assert finding_lines([]) == []
    assert finding_lines(findings_of(("a", "x")))[2:] == ["    slow channel: x, in a (left)"]


def power_of(**changes: Any) -> Power:
    """An offset that is detectable from 2 N and distinguishable from 3 N on."""
    return replace(Power("sensor_offset", "b", "N", 2.0, 3.0, False, 0.0123, 3.0, ()), **changes)


@pytest.mark.parametrize(
    ("changes", "cells"),
    [
        ({}, ("b 2.00 N", "1.2 %", "3.00", "")),
        ({"distinguishable_80": 2.0004}, ("b 2.00 N", "1.2 %", "same", "")),
        ({"distinguishable_80": None}, ("b 2.00 N", "1.2 %", "never", "")),
        (
            {"detectable_80": None, "share_80": None, "distinguishable_80": None},
            ("never", "", "", ""),
        ),
        ({"always": True}, ("any size", "", "3.00", "")),
        ({"confounded_with": ("a", "b", "c", "d")}, ("b 2.00 N", "1.2 %", "3.00", "a, b, c")),
    ],
)
def test_power_row_has_detectable_and_distinguishable_size(changes: Any, cells: Any) -> None:
    (row,) = tables.power_rows([power_of(**changes)], "coulomb", LINEAR)
    assert row == ("sensor_offset", *cells)


def test_power_rows_of_a_rotary_drive_have_the_units_of_the_drive() -> None:
    share = power_of(effect="position_ripple", parameter="a", unit="-")
    rows = tables.power_rows([power_of(), share], "coulomb", ROTARY)
    assert [row[1] for row in rows] == ["b 2.00 N m", "a 2.00"]
