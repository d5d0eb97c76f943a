"""Results in a line or two: each part where it holds, and nothing where it does not."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from by_hand import comparison_by_hand, diagnosis_by_hand, fit_by_hand
from jbf import Bootstrap, ParameterValue, Rig, TrajectoryFit
from jbf.reporting.check_text import short_check
from jbf.reporting.power_text import short_plan, short_power
from jbf.reporting.short import (
    LONGEST,
    first_of,
    short_bootstrap,
    short_comparison,
    short_diagnosis,
    short_fit,
    short_trajectory_fit,
)

VALUES = "F_c_n 4.988 +/- 0.012, F_s_n held at 6.0000, F_v_n_s_m 20.44 +/- 0.52"


def test_items_that_fit_stand_whole() -> None:
    """A hundred and twenty characters are not too long, one more is."""
    whole = ["a" * 59, "b" * 59]
    assert len(first_of(whole)) == LONGEST == 120
    assert first_of(whole) == ", ".join(whole)
    assert first_of([*whole[:1], whole[1] + "b"]) == f"{whole[0]}, ..."
    assert first_of([]) == ""


def test_of_items_that_would_be_too_long_the_last_go_first() -> None:
    """As many as there is room for beside the dots."""
    assert first_of(["a" * 57, "b" * 58, "c"], " + ") == f"{'a' * 57} + ..."
    assert first_of(["a" * 56, "b" * 56, "c" * 9], ", ") == f"{'a' * 56}, {'b' * 56}, ..."
    assert first_of(["a" * 121]) == "..."


def test_a_fit_in_two_lines() -> None:
    """Model, runs, samples, RMS, that the search failed if it did; below it the parameters."""
    fit = fit_by_hand()
    assert short_fit(fit) == f"Fit(coulomb; 2 runs, 1001 samples, RMS 0.525 N;\n    {VALUES})"
    lost = replace(fit, converged=False, samples=1, residuals=fit.residuals[:1])
    assert short_fit(lost) == (
        f"Fit(coulomb; 1 run, 1 sample, RMS 0.525 N, not converged;\n    {VALUES})"
    )
    offset = "sensor_offset.b_n -0.250 +/- 0.025"
    assert short_fit(fit_by_hand(["sensor_offset"])) == (
        f"Fit(coulomb + sensor_offset; 2 runs, 1001 samples, RMS 0.525 N;\n    {VALUES}, {offset})"
    )


@pytest.mark.parametrize(("repeats", "said"), [(1, "1 fit"), (20, "20 fits")])
def test_a_bootstrap_counts_its_answers(repeats: int, said: str) -> None:
    """Answers, not parameters; the fit's values with their errors."""
    fit = fit_by_hand()
    found = Bootstrap(fit, {name: np.arange(float(repeats)) for name in fit.parameters})
    assert short_bootstrap(found) == f"Bootstrap({said} again;\n    {VALUES})"


def test_a_fit_of_trajectories() -> None:
    """Samples, whether the search ended, and values; one without an error stands alone."""
    values = {"f_m": ParameterValue(0.25, 0.0012), "K0": ParameterValue(6.5e5)}
    found = TrajectoryFit(values, 4e-4, 1, 7, True, "")
    said = "f_m 0.2500 +/- 0.0012, K0 650000"
    assert short_trajectory_fit(found) == f"TrajectoryFit(1 sample;\n    {said})"
    lost = replace(found, samples=30, converged=False)
    assert short_trajectory_fit(lost) == f"TrajectoryFit(30 samples, not converged;\n    {said})"


def test_a_comparison_says_where_it_fails_or_that_it_does_not() -> None:
    """RMS beside the noise; the axes of its patterns."""
    found = comparison_by_hand(1.25, (1.0, 1.5))
    head = "Comparison(coulomb; 2 runs, RMS 1.25 N, 2.50 times the noise of 0.500 N;\n    "
    assert short_comparison(found) == f"{head}fails along direction)"
    assert short_comparison(replace(found, failures=())) == f"{head}no pattern along any axis)"
    (one,) = found.failures
    two = replace(found, failures=(one, replace(one, axis="time")), runs=found.runs[:1])
    assert short_comparison(two) == f"{head.replace('2 runs', '1 run')}fails along direction, time)"


def test_a_diagnosis_says_its_verdict_and_the_last_step() -> None:
    """Effects where there are any; the error on runs left out of the last step of the ledger."""
    assert short_diagnosis(diagnosis_by_hand("missing")) == (
        "Diagnosis(missing: sensor_offset;\n    held out 0.550 N, 1.10 times the noise of 0.500 N)"
    )
    assert short_diagnosis(diagnosis_by_hand("adequate")) == (
        "Diagnosis(adequate;\n    held out 2.75 N, 5.50 times the noise of 0.500 N)"
    )


def test_planned_runs_and_a_check_count_what_they_found() -> None:
    """Effects that would be found of those asked for; campaigns that were diagnosed right."""
    seen = [SimpleNamespace(found_80=x) for x in (0.0, 2.5, None)]
    planned = cast(Any, SimpleNamespace(runs=("a",), power=tuple(seen), model=Rig()))
    words = "PlannedPower: 1 run show 2 of 3 effects, each from a strength of its own"
    assert short_power(planned) == words
    plan = cast(Any, SimpleNamespace(runs=("a", "b"), planned=planned))
    assert short_plan(plan) == f"Plan: 2 runs; {words}"
    answers = [SimpleNamespace(right=right) for right in (True, False, True, True)]
    check = cast(Any, SimpleNamespace(answers=answers))
    assert short_check(check) == "Check: 3 of 4 campaigns diagnosed right"
