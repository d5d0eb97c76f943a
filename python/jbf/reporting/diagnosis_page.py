"""A diagnosis as one self-contained HTML page, pictures included."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from jbf.diagnosis.result import Diagnosis
from jbf.models.catalogue import Effect, find_effect
from jbf.reporting.comparison_plots import plot_run
from jbf.reporting.diagnosis_plot import plot_diagnosis
from jbf.reporting.effect_words import known_mass, limits_of, summary_of
from jbf.reporting.page import import_rows, measurement, page, pattern_rows, picture
from jbf.reporting.power_text import level_words
from jbf.reporting.tables import (
    correlation_pairs,
    finding_rows,
    law_rows,
    ledger_rows,
    parameter_rows,
    power_rows,
    ratio,
    run_rows,
    trial_rows,
)
from jbf.reporting.words import BARE, number, verdict_sentence


def _effect(diagnosis: Diagnosis, name: str) -> Effect:
    """An effect's page in the words of the rig."""
    page, said = find_effect(name), diagnosis.model.rig.quantities
    summary = summary_of(page, said) + known_mass(diagnosis.model, name)
    return replace(page, summary=summary, limits=limits_of(page, said))


def diagnosis_page(diagnosis: Diagnosis) -> str:
    """The HTML text of a diagnosis's report."""
    before, after = diagnosis.before, diagnosis.after
    bare = diagnosis.steps[0]
    said = diagnosis.model.rig.quantities
    trials = [
        (" + ".join([BARE, *step.effects]), trial_rows(diagnosis, step))
        for step in diagnosis.steps
        if step.trials
    ]
    head: tuple[str, ...]
    runs: Sequence[tuple[str, ...]]
    if diagnosis.effects:
        head = (
            "run",
            "samples",
            f"bare law ({said.force})",
            f"final model ({said.force})",
            "final / noise",
        )
        runs = [
            (
                x.name,
                str(x.samples),
                number(x.rms_n),
                number(y.rms_n),
                ratio(y.rms_n, after.noise_n),
            )
            for x, y in zip(before.runs, after.runs, strict=True)
        ]
    else:
        head, runs = ("run", "samples", f"RMS ({said.force})", "RMS / noise"), run_rows(before)
    pairs = correlation_pairs(diagnosis.fit)[:5]
    return page(
        "diagnosis.html.j2",
        f"Diagnosis: {diagnosis.verdict}",
        verdict=diagnosis.verdict,
        sentence=verdict_sentence(diagnosis),
        next_experiment=diagnosis.next_experiment,
        laws=law_rows(diagnosis),
        measurement=measurement(before, bare.noise_n),
        ledger=ledger_rows(diagnosis),
        picture=picture(plot_diagnosis(diagnosis)),
        before_picture=picture(plot_run(before)) if diagnosis.failures else "",
        failures=pattern_rows(diagnosis.failures),
        trials=trials,
        level=level_words(diagnosis.level),
        power=power_rows(diagnosis.power, diagnosis.model.law, said),
        unit=said.force,
        effects=[_effect(diagnosis, name) for name in diagnosis.effects],
        unexplained=pattern_rows(diagnosis.unexplained),
        findings=finding_rows(diagnosis.findings),
        imported=import_rows(before),
        parameters=parameter_rows(
            diagnosis.model.law, diagnosis.model.effects, diagnosis.fit.parameters, said
        ),
        correlations="; ".join(f"{a} with {b} {c:+.2f}" for a, b, c in pairs),
        run_head=head,
        runs=runs,
    )
