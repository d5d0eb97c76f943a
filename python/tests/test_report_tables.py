"""Rows of cells and lines of text that reports share: parameters, findings, power, laws."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from by_hand import comparison_by_hand, diagnosis_by_hand, fit_by_hand
from jbf import ParameterValue, Rig
from jbf.diagnosis import Remainder
from jbf.diagnosis.power import Power
from jbf.diagnosis.which_law import LawTried
from jbf.records.drive import Drive
from jbf.records.findings.finding import Finding
from jbf.records.quantities import LINEAR, ROTARY
from jbf.reporting.fit_text import fit_report, lines_of_parameters, trajectory_report
from jbf.reporting.tables import (
    correlation_pairs,
    finding_rows,
    law_rows,
    ledger_rows,
    parameter_rows,
    power_rows,
    ratio,
    run_rows,
    shown_names,
    trial_rows,
)
from jbf.reporting.text_parts import finding_lines, parameter_lines, where_lines

VALUES = {
    "F_c_n": ParameterValue(4.9876, 0.0123),
    "F_v_n_s_m": ParameterValue(20.0),
    "own": ParameterValue(0.0, 0.5, "at its bound"),
}


def test_parameters_have_name_value_error_share_unit_and_note() -> None:
    """One without an error says so, unless it has a note; one that no page knows has no unit."""
    assert parameter_rows("coulomb", (), VALUES) == [
        ("F_c_n", "4.988", "0.012", "0.25 %", "N", ""),
        ("F_v_n_s_m", "20.000", "", "", "N s/m", "no error known"),
        ("own", "0.00", "0.50", "", "", "at its bound"),
    ]
    rotary = parameter_rows("coulomb", (), VALUES, ROTARY)
    assert [(row[0], row[4]) for row in rotary] == [
        ("F_c", "N m"), ("F_v", "N m s/rad"), ("own", "")
    ]  # fmt: skip


def test_lines_of_parameters_leave_out_what_is_not_there() -> None:
    """Signs and brackets only around something."""
    assert parameter_lines("coulomb", (), VALUES) == [
        "    F_c_n       4.988  +/- 0.012  (0.25 %)  N",
        "    F_v_n_s_m  20.000                       N s/m  (no error known)",
        "    own          0.00   +/- 0.50                   (at its bound)",
    ]
    assert lines_of_parameters(fit_by_hand()) == [
        "    F_c_n               4.988  +/- 0.012  (0.25 %)  N",
        "    F_s_n      held at 6.0000                       N      (held fixed)",
        "    F_v_n_s_m           20.44   +/- 0.52   (2.5 %)  N s/m",
    ]


def test_correlations_above_three_tenths_the_strongest_first() -> None:
    """Of each pair once, under the names that are shown; what is no number is none."""
    fit = fit_by_hand(["sensor_offset"])
    assert correlation_pairs(fit) == [
        ("F_c_n", "F_v_n_s_m", -0.9),
        ("F_c_n", "sensor_offset.b_n", 0.45),
    ]
    table = np.array([[1.0, 0.3, np.nan], [0.3, 1.0, -0.301], [np.nan, -0.301, 1.0]])
    weak = replace(fit, correlations=table)
    assert correlation_pairs(weak) == [("F_v_n_s_m", "sensor_offset.b_n", -0.301)]
    joint = Rig(drive=Drive("rotary", "current", torque_constant_n_m_a=0.5))
    rotary = replace(fit, model=replace(fit.model, rig=joint))
    assert correlation_pairs(rotary)[0] == ("F_c", "F_v", -0.9)
    assert shown_names(rotary) == {
        "F_c_n": "F_c", "F_s_n": "F_s", "F_v_n_s_m": "F_v", "sensor_offset.b_n": "sensor_offset.b"
    }  # fmt: skip


def test_an_error_over_no_noise_has_no_ratio() -> None:
    """Two decimals where there is a noise."""
    assert [ratio(1.0, noise) for noise in (0.3, 0.0)] == ["3.33", ""]


def test_ledger_trials_runs_and_laws() -> None:
    """Every cell in its place."""
    d = diagnosis_by_hand("missing")
    assert ledger_rows(d) == [
        ("bare law", "2.50", "2.75", "0.500", "5.50"),
        ("+ sensor_offset", "0.525", "0.550", "0.500", "1.10"),
    ]
    assert trial_rows(d.steps[0])[2:] == [
        ("inertia_leak", "2.00", "+7", "rejected", "sensor_offset leads by 805"),
        ("sensor_lag", "2.50", "-26", "no gain", "gains no more than chance would"),
    ]
    assert run_rows(comparison_by_hand(1.25, (1.0, 1.5))) == [
        ("there", "501", "1.00", "2.00"),
        ("back", "500", "1.50", "3.00"),
    ]
    tried = (LawTried("a", 2, 0.5, True), LawTried("b", 4, 0.51, True), LawTried("c", 6, 1, False))
    assert law_rows(replace(d, laws=tried)) == [
        ("a", "2", "0.500", "taken"),
        ("b", "4", "0.510", "predicts as well"),
        ("c", "6", "1.00", "predicts worse"),
    ]


def findings(*said: tuple[str, str]) -> list[Finding]:
    """Gaps, each in a run and in its words."""
    return [Finding("slow_channel", "c", run, 1.0, "s", "left", words) for run, words in said]


def test_findings_of_one_kind_stand_together_by_their_words() -> None:
    """Runs of the same words are named together, up to three of them."""
    rows = finding_rows(findings(("a", "x"), ("b", "y"), ("c", "x"), ("d", "x"), ("e", "x")))
    assert rows == [("slow channel", "x, in a, c, d and 1 run more; y, in b (left)")]
    assert finding_rows(findings(("a", "x"), ("b", "x"), ("c", "x"))) == [
        ("slow channel", "x, in a, b, c (left)")
    ]
    assert finding_rows([]) == []


@pytest.mark.parametrize(
    ("extra", "more"),
    [([], ""), ([("d", "w")], "; and in 1 run more"),
     ([("d", "w"), ("e", "v"), ("f", "v")], "; and in 3 runs more")],
)  # fmt: skip
def test_of_more_than_three_sets_of_words_the_others_runs_are_counted(
    extra: list[tuple[str, str]], more: str
) -> None:
    """Three stand in full."""
    rows = finding_rows(findings(("a", "x"), ("b", "y"), ("c", "z"), *extra))
    assert rows == [("slow channel", f"x, in a; y, in b; z, in c{more} (left)")]


def test_lines_of_findings_have_a_heading_where_there_is_one() -> None:
    """Kind and words, a hanging paragraph each."""
    assert finding_lines([]) == []
    assert finding_lines(findings(("a", "x"))) == [
        "", "What the recording did", "    slow channel: x, in a (left)"
    ]  # fmt: skip


def test_patterns_stand_below_each_other() -> None:
    """Axes as wide as the widest, shares in percent, words that hang."""
    left = [Remainder("time", "2 bursts", 0.049), Remainder("frequency", "a tone", 1.0)]
    assert where_lines(left) == [
        "    time         5 %  2 bursts",
        "    frequency  100 %  a tone",
    ]
    assert where_lines([]) == []


def power_of(**more: Any) -> Power:
    """One effect's power; found from 2 N, from 3 N alone."""
    known: dict[str, Any] = {
        "effect": "sensor_offset",
        "parameter": "b_n",
        "unit": "N",
        "found_80": 2.0,
        "found_95": 3.0,
        "always": False,
        "share_80": 0.0123,
        "alone_80": 3.0,
        "like": (),
    }
    return Power(**{**known, **more})


@pytest.mark.parametrize(
    ("more", "cells"),
    [
        ({}, ("b_n 2.00 N", "1.2 %", "3.00", "")),
        ({"alone_80": 2.0004}, ("b_n 2.00 N", "1.2 %", "same", "")),
        ({"alone_80": None}, ("b_n 2.00 N", "1.2 %", "never", "")),
        ({"found_80": None, "share_80": None, "alone_80": None}, ("never", "", "", "")),
        ({"always": True}, ("any", "", "3.00", "")),
        ({"like": ("a", "b", "c", "d")}, ("b_n 2.00 N", "1.2 %", "3.00", "a, b, c")),
    ],
)
def test_power_says_from_where_an_effect_is_found_and_from_where_it_is_alone(
    more: dict[str, Any], cells: tuple[str, ...]
) -> None:
    """Never, any, the same; up to three that could stand in its place."""
    assert power_rows([power_of(**more)], "coulomb", LINEAR) == [("sensor_offset", *cells)]


def test_power_of_a_drive_has_its_units_and_of_a_number_none() -> None:
    """Names without the unit that they no longer have."""
    number = power_of(effect="position_ripple", parameter="a", unit="-")
    rows = power_rows([power_of(), number], "coulomb", ROTARY)
    assert [row[1] for row in rows] == ["b 2.00 N m", "a 2.00"]


def test_a_search_that_failed_says_why() -> None:
    """In the place of `converged`; no effects are `none`."""
    lost = replace(fit_by_hand(), converged=False, message="too many steps", doubtful=())
    lines = fit_report(lost).splitlines()
    assert "    search                 = not converged: too many steps" in lines
    assert "    effects                = none" in lines
    told = cast(Any, SimpleNamespace(samples=3, sum_of_squares=0.0, evaluations=2, converged=False,
                                     message="lost", parameters={}))  # fmt: skip
    told.parameters = {"f_m": ParameterValue(0.25)}
    assert "    search          = not converged: lost" in trajectory_report(told).splitlines()


@pytest.mark.parametrize(("count", "more"), [(5, False), (6, True)])
def test_ten_correlations_are_shown_and_the_others_counted(count: int, more: bool) -> None:
    """Ten pairs of five parameters; fifteen of six."""
    table = np.full((count, count), 0.5) + 0.5 * np.eye(count)
    parameters = {f"own_{i}": ParameterValue(1.0, 0.1) for i in range(count)}
    fit = fit_by_hand()
    report = fit_report(replace(fit, parameters=parameters, correlations=table)).splitlines()
    assert sum(line.startswith("    C(") for line in report) == 10
    assert ("    and 5 weaker ones" in report) == more
    assert any("weaker" in line for line in report) == more
