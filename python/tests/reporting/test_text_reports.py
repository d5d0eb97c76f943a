"""Reports as plain text: sections, and the numbers in the table of each."""

import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from by_hand import comparison_by_hand, diagnosis_by_hand, fit_by_hand
from golden import golden
from jbf import Bootstrap, Model, ParameterValue, Rig, TrajectoryFit
from jbf.diagnosis.check import Answer, Check
from jbf.diagnosis.directions import rate_below
from jbf.diagnosis.experiment_design.plan import Plan
from jbf.diagnosis.level import Level
from jbf.diagnosis.power import Power
from jbf.diagnosis.power.planned_runs import PlannedPower
from jbf.diagnosis.which_law import LawTried
from jbf.estimation.noise import Noise
from jbf.records.findings.finding import Finding
from jbf.reporting.fit_text import noise_words
from jbf.reporting.power_text import level_words

GAP = Finding("gaps", "time_s", "there", 0.1, "s", "bridged", "3 rows are missing")


def section(text: str, heading: str) -> list[list[str]]:
    """Cells of the indented lines below the line that starts with `heading`."""
    lines = text.splitlines()
    start = next(i for i, line in enumerate(lines) if line.startswith(heading)) + 1
    rows = []
    for line in lines[start:]:
        if not line.startswith("    "):
            break
        rows.append(re.split(r"  +", line.strip()))
    return rows


def has_section(text: str, heading: str) -> bool:
    return any(line.startswith(heading) for line in text.splitlines())


def test_fit_report_has_statistics_parameters_and_correlations() -> None:
    report = fit_by_hand(["sensor_offset"]).summary()
    statistics = {row[0]: row[1] for row in section(report, "[[Fit]]")}
    expected = {"law": "coulomb", "effects": "sensor_offset", "runs": "2", "samples": "1001"}
    expected |= {"RMS of the residual": "0.525 N", "search": "converged"}
    expected["noise of the records"] = "0.500 N (the residual is 1.05 times the noise)"
    expected["noise in the residual"] = "coloured, share 0.25, memory 0.15 s"
    assert statistics == {name: f"= {value}" for name, value in expected.items()}
    assert section(report, "[[Parameters]]") == [
        ["F_c", "4.988", "+/- 0.012", "(0.25 %)", "N"],
        ["F_s", "held at 6.0000", "N", "(held fixed)"],
        ["F_v", "20.44", "+/- 0.52", "(2.5 %)", "N s/m"],
        ["sensor_offset.b", "-0.250", "+/- 0.025", "(10 %)", "N"],
    ]
    strong, weak = section(report, "[[Correlations]]")
    assert strong == ["C(F_c, F_v)", "= -0.900"]
    assert weak == ["C(F_c, sensor_offset.b)", "= +0.450"]


@pytest.mark.parametrize(
    ("noise_rms", "words", "note"),
    [
        (0.5, "= 0.500 N (the residual is 1.05 times the noise)", None),
        (0.105, "= 0.105 N (the residual is 5.00 times the noise)", "exceeds"),
        (0.6, "= 0.600 N (the residual is 0.875 times the noise)", "is below"),
        (None, "= unknown", None),
    ],
)
def test_fit_report_compares_the_residual_with_the_noise_of_the_records(
    noise_rms: float | None, words: str, note: str | None
) -> None:
    report = replace(fit_by_hand(), noise_floor=noise_rms).summary()
    statistics = {row[0]: row[1] for row in section(report, "[[Fit]]")}
    assert statistics["noise of the records"] == words
    text = " ".join(report.split())
    for relation in ("exceeds", "is below"):
        assert (f"{relation} the noise of the records" in text) == (relation == note)


def test_fit_report_names_doubtful_errors_and_a_failed_search() -> None:
    doubtful = fit_by_hand(doubtful=("F_c",)).summary()
    assert re.search(r"note: .*F_c", doubtful)
    failed = replace(fit_by_hand(), converged=False, message="too many steps")
    assert "not converged: too many steps" in failed.summary()
    assert ["effects", "= none"] in section(failed.summary(), "[[Fit]]")


def test_noise_is_described_as_white_or_as_coloured_with_share_and_memory() -> None:
    assert noise_words(Noise()) == "white"
    assert noise_words(Noise(0.5, 0.3)) == "coloured, share 0.30, memory 0.50 s"


def test_bootstrap_report_has_the_number_of_fits_and_the_fit_report() -> None:
    fit = fit_by_hand()
    found = Bootstrap(fit, {n: np.arange(7.0) for n in fit.parameters})
    first, _, rest = found.summary().partition("\n")
    assert "7 fits" in first
    assert rest == fit.summary()


def test_trajectory_report_has_statistics_and_parameters() -> None:
    values = {"f_m": ParameterValue(0.25, 0.0012), "U_tr_m_s": ParameterValue(0.05)}
    found = TrajectoryFit(values, 4e-4, 100, 7, True, "")
    statistics = {row[0]: row[1] for row in section(found.summary(), "[[Fit]]")}
    assert (statistics["samples"], statistics["simulations"]) == ("= 100", "= 7")
    assert statistics["sum of squares"].startswith("= 0.000400")
    assert statistics["search"] == "= converged"
    f_m, u_tr = section(found.summary(), "[[Parameters]]")
    assert f_m == ["f_m", "0.2500", "+/- 0.0012", "(0.48 %)"]
    assert u_tr == ["U_tr_m_s", "0.050000", "m/s", "(no error known)"]
    assert "not converged: lost" in replace(found, converged=False, message="lost").summary()


def test_comparison_report_lists_failures_and_runs() -> None:
    report = comparison_by_hand(1.25, (1.0, 1.5)).summary()
    assert section(report, "Lack of fit") == [["direction", "60 %", "record above the model"]]
    assert section(report, "Runs") == [
        ["run", "samples", "RMS (N)", "RMS / noise"],
        ["there", "501", "1.00", "2.00"],
        ["back", "500", "1.50", "3.00"],
    ]
    assert not has_section(report, "Data quality")


def test_comparison_report_without_failures_lists_findings_only() -> None:
    found = comparison_by_hand(1.25, (1.0, 1.5))
    campaign = replace(found.campaign, more_findings=(GAP,))
    report = replace(found, failures=(), campaign=campaign).summary()
    assert "no lack of fit" in report.splitlines()[0]
    assert not has_section(report, "Lack of fit")
    findings = section(report, "Data quality")
    assert findings == [["gaps: 3 rows are missing, in there (bridged)"]]


def test_diagnosis_report_has_measurement_candidates_steps_and_parameters() -> None:
    report = diagnosis_by_hand("missing").summary(full=True)
    assert report.startswith("Verdict: missing (sensor_offset)\n")
    measurement = section(report, "Measurement")
    assert measurement[0][0].startswith("2 runs, 20 s in total, 1002 samples")
    assert "noise floor 0.500 N" in measurement[1][0]
    bare = section(report, "The base law (coulomb)")
    assert "2.50 N, 5.00 times the noise" in bare[0][0]
    assert bare[1] == ["direction", "60 %", "record above the model"]
    candidates = section(report, "Candidates added to the base law")
    assert candidates[0] == ["effect", "RMS (N)", "evidence", "outcome", "reason"]
    assert candidates[1] == ["sensor_offset", "0.525", "+812", "added", "largest evidence"]
    assert len(candidates) == 5
    assert section(report, "Not tested")[0][0].startswith("position_ripple: ")
    assert section(report, "Error by step (N)") == [
        ["step", "fit RMS", "held-out RMS", "noise", "held-out / noise"],
        ["base law", "2.50", "2.75", "0.500", "5.50"],
        ["+ sensor_offset", "0.525", "0.550", "0.500", "1.10"],
    ]
    parameters = section(report, "Parameters of the final model")
    assert parameters[3][:2] == ["sensor_offset.b", "-0.250"]


def test_optional_sections_of_a_diagnosis_report_appear_only_with_content() -> None:
    power = (Power("sensor_lag", "tau_s", "s", 0.01, 0.02, False, 0.1, 0.02, ()),)
    laws = (LawTried("coulomb", 2, 0.55, True), LawTried("stribeck", 4, 0.551, True))
    plain = replace(diagnosis_by_hand("missing"), not_tried={})
    full = replace(plain, power=power, laws=laws, findings=(GAP,)).summary(full=True)
    assert section(full, "Law selection")[2] == ["stribeck", "4", "0.551", "equally good"]
    shown = section(full, "Detection limits")[1]
    assert shown == ["sensor_lag", "tau_s 0.0100 s", "10 %", "0.0200"]
    assert has_section(full, "Data quality")
    for heading in ("Law selection", "Detection limits", "Data quality", "Not tested"):
        assert not has_section(plain.summary(full=True), heading)


def test_diagnosis_report_has_structure_next_experiment_and_undetectable_effects() -> None:
    unexplained = diagnosis_by_hand("unexplained").summary(full=True)
    tone, bursts = section(unexplained, "Residual structure")
    assert tone == ["frequency", "12 %", "a 3.00 Hz tone"]
    assert bursts == ["time", "4 %", "2 bursts"]
    assert "Next experiment: record a rest" in diagnosis_by_hand("ambiguous").summary(full=True)
    adequate = diagnosis_by_hand("adequate").summary(full=True)
    assert section(adequate, "Not detectable")[0] == ["backlash"]
    assert "no lack of fit along any axis" in adequate


def test_diagnosis_report_has_all_steps_in_lines_of_up_to_100_characters() -> None:
    diagnosis = golden("bearing_coulomb_drag")
    report = diagnosis.summary(full=True)
    assert max(map(len, report.splitlines())) <= 100
    rows = section(report, "Error by step")[1:]
    steps = [(float(row[1]), float(row[2])) for row in rows]
    expected = [(step.rms, step.held_out_rms) for step in diagnosis.steps]
    assert steps == [pytest.approx(errors, rel=5e-3) for errors in expected]
    parameters = section(report, "Parameters of the final model")
    assert [row[0] for row in parameters] == list(diagnosis.model.parameters)


def test_check_report_has_counts_shares_and_exact_intervals() -> None:
    """Clopper and Pearson: the lower limit of ten of ten is 0.025^(1/10)."""
    right = [Answer((), k, "adequate", (), {}) for k in range(10)]
    wrong = [Answer(("running_in",), k, "adequate", (), {}) for k in range(4)]
    check = Check(Model(Rig.thesis()), (*right, *wrong))
    rows = [re.split(r"  +", line) for line in check.summary().splitlines()]
    adequate = next(row for row in rows if row[0] == "nothing hidden: adequate")
    assert adequate[1:] == ["10 of 10", "100 %", f"{100 * 0.025**0.1:.1f} to 100 %"]
    named = next(row for row in rows if row[0] == "running_in hidden: named")
    assert named[1:] == ["0 of 4", "0 %", f"0 to {100 * (1 - 0.025**0.25):.1f} %"]
    assert "10 of 14" in repr(check)


LEVEL = Level(0.025, 20, 0.00125, artefact_margin=0.0, min_gain=0.0)


def test_level_text_has_false_alarm_rate_candidates_and_threshold() -> None:
    words = level_words(LEVEL)
    assert "2.5 %" in words
    assert "20 candidates" in words
    # Quantile 1 - 0.00125 of chi-square with one degree of freedom.
    assert "10.4" in words


@pytest.mark.parametrize(
    ("changes", "fragment"),
    [
        ({"blocks": 40}, "40 blocks"),
        ({"artefact_margin": 100.0}, f"at least {LEVEL.white_noise_threshold + 100.0:.0f}"),
        ({"min_gain": 1234.0}, "1234"),
        ({"decoys": 50, "decoys_named": 3}, f"below {100.0 * rate_below(3, 50):.2g} %"),
        ({"decoys": 2, "decoys_named": 2}, "below 100 %"),
    ],
)
def test_level_text_has_further_thresholds_only_if_they_apply(changes: Any, fragment: str) -> None:
    assert fragment in level_words(replace(LEVEL, **changes))
    assert fragment not in level_words(LEVEL)


def planned_power() -> PlannedPower:
    power = (
        Power("sensor_offset", "b", "N", 2.0, 3.0, False, 0.0123, 2.0, ("running_in",)),
        Power("sensor_lag", "tau_s", "s", None, None, False, None, None, ()),
    )
    model = Model(Rig(), "coulomb", ["inertia"])
    return PlannedPower(model, 0.1, power, {"backlash": "no path"}, ("a", "b"), LEVEL)


def test_planned_power_report_lists_noise_detection_limits_and_untried_effects() -> None:
    planned = planned_power()
    report = planned.summary()
    assert all(x in report.partition("\n")[0] for x in ("2 runs", "coulomb + inertia", "0.100 N"))
    _, offset, lag = section(report, "Detection limits")[:3]
    assert offset == ["sensor_offset", "b 2.00 N", "1.2 %", "same", "running_in"]
    assert lag == ["sensor_lag", "never"]
    assert section(report, "Not tested")[0] == ["backlash: no path"]
    assert "2 runs, 1 of 2 effects" in repr(planned)


def test_plan_report_lists_the_runs_before_their_power() -> None:
    run = comparison_by_hand(1.0, (1.0, 1.0)).campaign.prepared[0].run
    plan = Plan((run,), ("a sine",), planned_power())
    rows = [re.split(r"  +", line.strip()) for line in plan.summary().splitlines()]
    assert rows.index(["there", "a sine"]) < rows.index(["sensor_lag", "never"])
    assert "1 run" in repr(plan)
