"""Complete report of a diagnosis as plain text."""

from __future__ import annotations

from jbf.diagnosis.result import Diagnosis
from jbf.records.counts import count_of
from jbf.reporting.diagnosis_summary import diagnosis_summary, verdict_line
from jbf.reporting.effect_words import effect_lines
from jbf.reporting.fit_text import lines_of_parameters
from jbf.reporting.paragraphs import columns, hanging
from jbf.reporting.power_text import DETECTION_LIMITS, level_words, power_lines
from jbf.reporting.tables import LEDGER_HEAD, law_rows, ledger_rows, trial_rows
from jbf.reporting.text_parts import finding_lines, recorded, where_lines
from jbf.reporting.words import (
    BASE_LAW,
    against_noise,
    extrapolation_sentences,
    law_words,
    noise_words,
    not_tested_rows,
    number,
    step_name,
    verdict_sentence,
)


def _trial_lines(diagnosis: Diagnosis) -> list[str]:
    unit = diagnosis.model.rig.quantities.force
    lines: list[str] = []
    for step in diagnosis.steps:
        if not step.trials:
            continue
        lines += ["", f"Candidates added to the {' + '.join([BASE_LAW, *step.effects])}"]
        rows = trial_rows(step)
        head, *table = columns(
            [("effect", f"RMS ({unit})", "evidence", "outcome"), *(row[:4] for row in rows)],
            "<>><",
            4,
        )
        lead = max(map(len, [head, *table])) + 2
        lines.append(f"{head:<{lead}}reason")
        for line, row in zip(table, rows, strict=True):
            lines += hanging(f"{line:<{lead}}", row[4], 0)
    if diagnosis.not_tried:
        lines += ["", "Not tested"]
        for names, reason in not_tested_rows(diagnosis.not_tried):
            lines += hanging("    ", f"{names}: {reason}", 0)
    if diagnosis.negligible:
        lines += ["", "Significant, but below the minimum effect size"]
        lines += hanging("    ", ", ".join(diagnosis.negligible), 0)
    if diagnosis.not_detectable:
        lines += ["", "Not detectable in these runs at a usual strength"]
        lines += hanging("    ", ", ".join(diagnosis.not_detectable), 0)
    if diagnosis.limitations:
        lines += ["", "Conclusions that these runs do not support"]
        for sentence in diagnosis.limitations:
            lines += hanging("    ", sentence)
    return lines


def _power_lines(diagnosis: Diagnosis) -> list[str]:
    if not diagnosis.power:
        return []
    model = diagnosis.model
    return [
        "",
        DETECTION_LIMITS,
        *power_lines(diagnosis.power, model),
        *hanging("    ", f"({level_words(diagnosis.level)})", 0),
    ]


def diagnosis_text(diagnosis: Diagnosis, full: bool = False) -> str:
    """Summary of a diagnosis as plain text, or its complete report (`full`)."""
    return diagnosis_report(diagnosis) if full else diagnosis_summary(diagnosis)


def diagnosis_report(diagnosis: Diagnosis) -> str:
    """Complete report of a diagnosis as plain text.

    The sections are verdict, measurement, misfit of the base law, candidates, error per step, and
    parameters.
    """
    campaign, base_step = diagnosis.before.campaign, diagnosis.steps[0]
    samples = diagnosis.before.samples.count
    model = diagnosis.model
    unit = model.rig.quantities.force
    lines = [verdict_line(diagnosis), *hanging("", verdict_sentence(diagnosis))]
    if diagnosis.next_experiment:
        lines += hanging("Next experiment: ", diagnosis.next_experiment)
    if diagnosis.laws:
        lines += ["", "Law selection (each law with its own offset, mass and weight)"]
        names = ("law", "parameters", f"held out ({unit})", "")
        lines += columns([names, *law_rows(diagnosis)], "<>><", 4)
    lines += [
        "",
        "Measurement",
        f"    {recorded([p.run for p in campaign.prepared])}, "
        f"{count_of(samples, 'sample')} "
        "with a known direction of motion",
        f"    noise floor {noise_words(base_step.noise_rms, unit)}"
        + (", estimated from the records" if base_step.noise_rms > 0.0 else ""),
        "",
        f"The {step_name(diagnosis, 0)} ({law_words(model, ', ')})",
        f"    RMS error {number(base_step.rms)} {unit}, "
        f"{against_noise(base_step.rms, base_step.noise_rms)}"
        + ("; lack of fit (share of the mean square residual):" if diagnosis.failures else ""),
    ]
    lines += where_lines(diagnosis.failures) or ["    no lack of fit along any axis"]
    lines += _trial_lines(diagnosis)
    lines += _power_lines(diagnosis)
    lines += ["", f"Error by step ({unit})"]
    head = LEDGER_HEAD
    lines += columns([head, *ledger_rows(diagnosis)], "<>>>>", 4)
    for sentence in extrapolation_sentences(diagnosis):
        lines += hanging("    ", sentence)
    lines += finding_lines(diagnosis.findings)
    lines += ["", "Residual structure"]
    lines += where_lines([r for r in diagnosis.residual_structure if not r.unfinished]) or [
        "    none above the noise"
    ]
    lines += ["", "Parameters of the final model"]
    lines += lines_of_parameters(diagnosis.fit)
    return "\n".join([*lines, *effect_lines(model)])
