"""Rows of cells that both the text and the page show: parameters, correlations, the ledger."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

import numpy as np

from jbf.models.parameter_units import shown
from jbf.records.counts import count_of
from jbf.records.quantities import OF_BEARING, Quantities
from jbf.reporting.words import UNKNOWN, number, percent, step_name, value_and_error

if TYPE_CHECKING:
    from jbf.comparison.comparison import Comparison
    from jbf.diagnosis.ledger import Step
    from jbf.diagnosis.power import Power
    from jbf.diagnosis.result import Diagnosis
    from jbf.estimation.fit import Fit
    from jbf.models.parameter_value import ParameterValue
    from jbf.records.findings.finding import Finding

MOST_RUNS_NAMED = 3
"""Runs named of each kind of finding."""
LEAST_CORRELATION = 0.3
"""Weaker correlations are not worth a line."""


def parameter_rows(
    law: str,
    effects: tuple[str, ...],
    parameters: Mapping[str, ParameterValue],
    quantities: Quantities = OF_BEARING,
) -> list[tuple[str, str, str, str, str, str]]:
    """Name, value, error, percent, unit and note of each parameter, as text."""
    names = shown(law, effects, quantities)
    rows = []
    for name, p in parameters.items():
        value, error = value_and_error(p)
        note = p.note or ("" if error else "no error known")
        called, unit = names.get(name, (name, ""))
        rows.append((called, value, error, percent(p), unit, note))
    return rows


def shown_names(fit: Fit) -> dict[str, str]:
    """Full names of a fit's parameters to those that are shown."""
    model = fit.model
    names = shown(model.law, model.effects, model.rig.quantities)
    return {name: names[name][0] if name in names else name for name in fit.parameters}


def correlation_pairs(fit: Fit) -> list[tuple[str, str, float]]:
    """Pairs of parameters correlated above 0.3, strongest first."""
    names = [name for name, p in fit.parameters.items() if not p.held]
    called = shown_names(fit)
    found = [
        (called[names[i]], called[names[j]], float(fit.correlations[i, j]))
        for i in range(len(names))
        for j in range(i + 1, len(names))
        if np.isfinite(fit.correlations[i, j]) and abs(fit.correlations[i, j]) > LEAST_CORRELATION
    ]
    return sorted(found, key=lambda pair: -abs(pair[2]))


def ratio(error_n: float, noise_n: float) -> str:
    """An error over the noise to two decimals; empty where there is no noise."""
    return f"{error_n / noise_n:.2f}" if noise_n > 0.0 else ""


def ledger_rows(diagnosis: Diagnosis) -> list[tuple[str, str, str, str, str]]:
    """What each step brought, its fit and held-out RMS, the noise (N), and their ratio."""
    return [
        (
            step_name(diagnosis, i),
            number(s.rms_n),
            number(s.holdout_rms_n),
            number(s.noise_n) if s.noise_n > 0.0 else UNKNOWN,
            ratio(s.holdout_rms_n, s.noise_n),
        )
        for i, s in enumerate(diagnosis.steps)
    ]


def trial_rows(step: Step) -> list[tuple[str, str, str, str, str]]:
    """Each candidate's effect, RMS (N), evidence, outcome and reason."""
    return [
        (t.effect, number(t.rms_n), f"{t.evidence:+.0f}", t.outcome, t.reason) for t in step.trials
    ]


def run_rows(comparison: Comparison) -> list[tuple[str, str, str, str]]:
    """Each run's name, samples that count, RMS (N), and RMS over the noise."""
    return [
        (r.name, str(r.samples), number(r.rms_n), ratio(r.rms_n, comparison.noise_n))
        for r in comparison.runs
    ]


def finding_rows(findings: Iterable[Finding]) -> list[tuple[str, str]]:
    """Each kind of finding, and what it did to which runs; the first few runs are named."""
    kinds: dict[str, list[Finding]] = {}
    for finding in findings:
        kinds.setdefault(finding.kind, []).append(finding)
    rows = []
    for kind, found in kinds.items():
        runs: dict[str, list[str]] = {}
        for f in found:
            runs.setdefault(f.words, []).append(f.run)
        said = [f"{words}, in {_named(those)}" for words, those in runs.items()]
        rest = sum(map(len, list(runs.values())[MOST_RUNS_NAMED:]))
        if rest:
            said = [*said[:MOST_RUNS_NAMED], f"and in {count_of(rest, 'run')} more"]
        rows.append((kind.replace("_", " "), f"{'; '.join(said)} ({found[0].done})"))
    return rows


def power_rows(
    power: Iterable[Power], law: str, said: Quantities
) -> list[tuple[str, str, str, str, str]]:
    """Effect, the strength from which it would have been found, that as a share of the friction,
    the strength from which it would have been named alone, and what could stand in its place."""
    rows = []
    for p in power:
        full = f"{p.effect}.{p.parameter}"
        name, unit = shown(law, (p.effect,), said)[full]
        name = name.removeprefix(f"{p.effect}.")
        share = "" if p.share_80 is None or p.always else f"{100.0 * p.share_80:.2g} %"
        found = "never" if p.found_80 is None else f"{name} {number(p.found_80)} {unit}".strip()
        found = "any" if p.always else found
        alone = "" if p.found_80 is None else "never" if p.alone_80 is None else number(p.alone_80)
        if p.found_80 is not None and alone == number(p.found_80):
            alone = "same"
        rows.append((p.effect, found, share, alone, ", ".join(p.like[:MOST_RUNS_NAMED])))
    return rows


def law_rows(diagnosis: Diagnosis) -> list[tuple[str, str, str, str]]:
    """Law, number of parameters, left-out error (N), and how it compares."""
    return [
        (
            tried.law,
            str(tried.parameters),
            number(tried.left_out_rms_n),
            "taken" if i == 0 else "predicts as well" if tried.tied else "predicts worse",
        )
        for i, tried in enumerate(diagnosis.laws)
    ]


def _named(runs: list[str]) -> str:
    """Runs by name; the first few of many."""
    if len(runs) <= MOST_RUNS_NAMED:
        return ", ".join(runs)
    more = count_of(len(runs) - MOST_RUNS_NAMED, "run")
    return f"{', '.join(runs[:MOST_RUNS_NAMED])} and {more} more"
