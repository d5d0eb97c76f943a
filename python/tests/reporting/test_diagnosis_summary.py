"""Summary of a diagnosis: at most 30 lines, with the most important numbers."""

import re
from dataclasses import replace

import numpy as np
import pytest
from by_hand import diagnosis_by_hand, fit_by_hand
from golden import golden
from jbf import Diagnosis, Model, ParameterValue, Rig
from jbf.diagnosis import Step
from jbf.diagnosis.which_law import LawTried
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
    "name",
    [
        pytest.param("bearing_two_effects", marks=pytest.mark.extended),
        "bearing_one_direction",
        "bearing_hum",
        "joint_gravity",
    ],
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


def finding(kind: str, words: str, size: float = 1.0, done: str = "excluded") -> Finding:
    """A finding in the force of one run."""
    return Finding(kind, "friction_n", "slow", size, "N", done, words)


def test_summary_keeps_the_end_of_a_finding_and_of_a_conclusion_that_exceed_one_line() -> None:
    words = "the drive reports the torque in percent of its rated torque, and this column was"
    long = finding("converted", f"{words} converted to N m: 1 % is 0.0127 N m, from 1.27 N m")
    simpler = LawTried("dahl", 3, 0.5317, True)
    text = "\n".join(
        lines_of(replace(diagnosis_by_hand("unexplained"), findings=(long,), simpler_law=simpler))
    )
    assert all(number in text for number in ("0.0127 N m", "1.27 N m", "0.532 N", "2.75 N"))
    assert "..." not in text


def test_summary_lists_uncorrected_findings_first_and_recommends_to_correct_the_sign() -> None:
    findings = (
        finding("gaps", "the first gap", 9.0),
        finding("jitter", "jitter of the times", 1e-3, "none"),
        finding("sign", "the force drives the motion: negate friction_n", -3.0, "none"),
    )
    lines = lines_of(replace(diagnosis_by_hand("unexplained"), findings=findings))
    at = lines.index("Data quality")
    kinds = [line.split(":")[0].strip() for line in lines[at + 1 : at + 4]]
    assert kinds == ["sign", "jitter", "gaps"]
    actions = [line for line in lines if line.startswith("Next")]
    assert actions[0].startswith("Next: ")
    assert "negate friction_n" in actions[0]


@pytest.mark.parametrize(("held_out_rms", "recommended"), [(2.0, True), (3.0, False)])
def test_summary_recommends_law_selection_if_a_simpler_law_predicts_better_than_a_film(
    held_out_rms: float, recommended: bool
) -> None:
    model = Model(Rig.thesis(), "journal_full")
    values, correlations = model.parameters, np.eye(len(model.parameters))
    fit = replace(fit_by_hand(), model=model, parameters=values, correlations=correlations)
    simpler = LawTried("stribeck", 4, held_out_rms, True)
    diagnosis = replace(diagnosis_by_hand("unexplained"), fit=fit, simpler_law=simpler)
    (action,) = [line for line in lines_of(diagnosis) if line.startswith("Next")]
    assert ("jbf diagnose FOLDER --law auto" in action) == recommended
