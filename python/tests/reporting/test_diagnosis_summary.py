"""Summary of a diagnosis: at most 30 lines, with the most important numbers."""

import re
from dataclasses import replace

import numpy as np
import pytest
from by_hand import diagnosis_by_hand, fit_by_hand
from golden import golden
from jbf import Diagnosis, Model, ParameterValue, Rig
from jbf.diagnosis import Step
from jbf.records.findings.finding import Finding


def lines_of(diagnosis: Diagnosis) -> list[str]:
    """Lines of the summary, after a check of their number and length."""
    lines = diagnosis.summary().splitlines()
    assert len(lines) <= 30
    assert max(map(len, lines)) <= 100
    return lines


def cells(lines: list[str], name: str) -> list[str]:
    """Cells of the table row with this name."""
    line = next(line for line in lines if line.strip().startswith(f"{name}  "))
    return re.split(r"  +", line.strip())


@pytest.mark.parametrize(
    "name", ["bearing_two_effects", "bearing_one_direction", "bearing_hum", "joint_gravity"]
)
def test_summary_of_a_computed_diagnosis_has_verdict_errors_and_estimates(name: str) -> None:
    diagnosis = golden(name)
    lines = lines_of(diagnosis)
    assert lines[0].startswith(f"Verdict: {diagnosis.verdict}")
    assert all(effect in lines[0] for effect in diagnosis.effects)
    last = diagnosis.steps[-1]
    errors = [
        float(x) for x in cells(lines, f"+ {last.effects[-1]}" if last.effects else "base law")[1:]
    ]
    expected = [last.rms, last.held_out_rms, last.noise_rms, last.held_out_rms / last.noise_rms]
    assert errors == pytest.approx(expected, rel=6e-3)


def test_summary_separates_estimates_from_parameters_that_are_not_determined() -> None:
    lines = lines_of(diagnosis_by_hand("missing"))
    assert cells(lines, "F_c") == ["F_c", "4.988", "0.012", "0.25 %", "N"]
    (line,) = [line for line in lines if "F_s" in line]
    assert line.split() == ["not", "determined:", "F_s"]


def test_summary_recommends_an_experiment_or_names_undetectable_effects() -> None:
    assert any("record a rest" in line for line in lines_of(diagnosis_by_hand("ambiguous")))
    assert any("backlash" in line for line in lines_of(diagnosis_by_hand("adequate")))


def test_summary_of_a_large_diagnosis_is_truncated_to_30_lines() -> None:
    diagnosis = diagnosis_by_hand("unexplained")
    names = [f"effect_with_a_long_name_{i}" for i in range(12)]
    steps = tuple(Step(tuple(names[:i]), 2.5 - 0.1 * i, 2.6 - 0.1 * i, 0.5) for i in range(13))
    parameters = {f"F_{i}": ParameterValue(1.0 + i, 0.1, held=False) for i in range(20)}
    words = "a long description of this property of the recording " * 4
    findings = tuple(Finding(f"kind_{i}", "f", f"run_{i}", i, "s", "none", words) for i in range(9))
    fit = replace(fit_by_hand(), parameters=parameters, correlations=np.eye(20))
    large = replace(
        diagnosis,
        effects=tuple(names),
        steps=steps,
        fit=fit,
        findings=findings,
        next_experiment=words * 3,
        limitations=(words, words),
        not_detectable=tuple(names),
    )
    lines = lines_of(large)
    assert any("other kinds" in line for line in lines)
    assert any("F_0" in line and "F_1" in line for line in lines)
    assert sum(line.startswith("  F_") for line in lines) >= 4
    assert any("more steps" in line for line in lines)


def test_summary_lists_parameters_of_the_machine_before_those_of_the_law() -> None:
    parameters = {
        "F_c": ParameterValue(5.0, 0.1),
        "inertia.m_e": ParameterValue(2.0, 0.1),
    }
    model = Model(Rig(), "coulomb", ["inertia"], parameters)
    fit = replace(fit_by_hand(), model=model, parameters=parameters)
    diagnosis = replace(diagnosis_by_hand("adequate"), machine=("inertia",), fit=fit)
    text = diagnosis.summary()
    assert text.index("m_e") < text.index("F_c")
