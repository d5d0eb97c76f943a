"""Reports as text: what they say, and that they fit a terminal."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from jbf import Fit, Rig, Run, compare, fit
from jbf.diagnosis.result import Diagnosis
from jbf.models.catalogue import effects, find_effect
from jbf.models.parameter_value import ParameterValue
from jbf.reporting.catalogue_text import effect_page, effects_page
from jbf.reporting.comparison_text import comparison_report
from jbf.reporting.diagnosis_text import diagnosis_report
from jbf.reporting.fit_text import fit_report
from jbf.reporting.words import listed, measured, number, percent, verdict_sentence

VERDICTS = ("adequate", "missing", "ambiguous", "unexplained")


@pytest.mark.parametrize(
    ("value", "stderr", "shown"),
    [
        (0.25996, 0.00071, ("0.25996", "0.00071")),
        (649312.7, 7346.0, ("649300", "7300")),
        (33.29, 1.66, ("33.3", "1.7")),
        (0.0, 0.5, ("0.00", "0.50")),
        (1.5, None, ("1.5000", "")),
        (1.5, float("nan"), ("1.5000", "")),
        (float("inf"), 0.1, ("inf", "")),
        (3.0e9, 2.0e6, ("3.0000e+09", "2.0e+06")),
    ],
)
def test_a_value_is_shown_to_its_errors_second_digit(
    value: float, stderr: float | None, shown: tuple[str, str]
) -> None:
    assert measured(value, stderr) == shown


def test_small_words() -> None:
    assert [listed("abc"[:i]) for i in range(4)] == ["", "a", "a and b", "a, b and c"]
    assert [number(x) for x in (0.0, 0.28571, 12345.6, 1e-9)] == ["0", "0.286", "12346", "1.00e-09"]
    assert percent(ParameterValue(-2.0, 0.01)) == "0.50 %"
    assert percent(ParameterValue(0.0, 0.01)) == percent(ParameterValue(1.0)) == ""


def test_fit_report(full_fit: Fit) -> None:
    report = fit_report(full_fit)
    assert report == full_fit.report()
    assert "effects                = coulomb_drag" in report
    row = next(line for line in report.splitlines() if "coulomb_drag.F_d_n " in line)
    assert "+/-" in row
    assert "%" in row
    pairs = [line for line in report.splitlines() if line.lstrip().startswith("C(")]
    sizes = [abs(float(line.rpartition("=")[2])) for line in pairs]
    assert sizes == sorted(sizes, reverse=True)
    assert min(sizes) > 0.3


def test_fit_report_says_why_there_is_no_error(rig: Rig, runs: list[Run]) -> None:
    report = fit(rig, runs, fixed={"f_m": 0.26}).report()
    assert "(held fixed)" in report
    assert "C(U_tr_m_s, K0)" in report


def test_comparison_report(bare_fit: Fit, full_fit: Fit, runs: list[Run]) -> None:
    bad = comparison_report(compare(bare_fit.model, runs))
    assert "against a noise floor of" in bad
    assert "Where it fails" in bad
    assert all(run.name in bad for run in runs)
    good = comparison_report(compare(full_fit.model, runs))
    assert "no pattern along any axis" in good


@pytest.mark.parametrize("verdict", VERDICTS)
def test_diagnosis_report(verdict: str, make_diagnosis: Callable[[str], Diagnosis]) -> None:
    diagnosis = make_diagnosis(verdict)
    report = diagnosis_report(diagnosis)
    assert report == diagnosis.summary()
    assert report.startswith(f"Verdict: {verdict}\n")
    assert max(map(len, report.splitlines())) <= 100
    sections = ("Measurement", "The bare law", "The error falling", "What remains", "Parameters")
    places = [report.index(f"\n{section}") for section in sections]
    assert places == sorted(places)


def test_verdict_sentences(make_diagnosis: Callable[[str], Diagnosis]) -> None:
    said = {verdict: verdict_sentence(make_diagnosis(verdict)) for verdict in VERDICTS}
    assert said["adequate"].startswith("Nothing is missing")
    assert said["missing"].startswith("Missing: coulomb_drag. With it, the held-out error falls")
    assert "cannot tell which: coulomb_drag or presliding" in said["ambiguous"]
    assert "no effect in the catalogue explains" in said["unexplained"]
    assert "after a reversal, v > 0" in said["unexplained"]
    assert "(and 1 more below)" in said["unexplained"]
    assert "Next experiment: record a run" in diagnosis_report(make_diagnosis("ambiguous"))


def test_the_catalogue_lists_every_effect() -> None:
    page = effects_page(effects().values())
    assert all(f"  {name} " in page for name in effects())
    assert max(map(len, page.splitlines())) <= 100


@pytest.mark.parametrize("name", list(effects()))
def test_every_effect_has_a_whole_page(name: str) -> None:
    effect = find_effect(name)
    page = effect_page(effect)
    assert "equation" in page
    assert "source" in page
    for p in effect.parameters:
        assert p.name in page
        assert p.unit in page
        assert f"{p.lower:g}" in page
        if p.null is not None and np.isinf(p.null):
            assert "inf" in page
