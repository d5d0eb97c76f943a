"""Table rows shared by the text and HTML reports: parameters, correlations, ledger, power."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from math import isfinite
from typing import TYPE_CHECKING

import numpy as np

from jbf.models.parameter_units import units_of
from jbf.records.counts import count_of
from jbf.records.quantities import BEARING, Quantities
from jbf.reporting.words import UNKNOWN, number, percent, step_name, value_and_error

if TYPE_CHECKING:
    from jbf.comparison.comparison import Comparison
    from jbf.comparison.model_comparison import ModelComparison
    from jbf.diagnosis.ledger import Step
    from jbf.diagnosis.power import Power
    from jbf.diagnosis.result import Diagnosis
    from jbf.estimation.fit import Fit
    from jbf.models.parameter_value import ParameterValue
    from jbf.records.findings.finding import Finding

LEDGER_HEAD = ("step", "fit RMS", "held-out RMS", "noise", "held-out / noise")
"""Header of the table of errors by step of a ledger."""
MOST_RUNS_NAMED = 3
"""Maximum number of runs named per kind of finding."""
LEAST_CORRELATION = 0.3
"""Smallest correlation that is reported, in absolute value."""


def parameter_rows(
    law: str,
    effects: tuple[str, ...],
    parameters: Mapping[str, ParameterValue],
    quantities: Quantities = BEARING,
) -> list[tuple[str, str, str, str, str, str]]:
    """Name, value, standard error, percentage, unit and note of each parameter, as text."""
    units = units_of(law, effects, quantities)
    rows = []
    for name, p in parameters.items():
        value, error = value_and_error(p)
        note = p.note or ("" if error else "no error known")
        # A ratio to the value is meaningless for an angle, whose zero is arbitrary.
        share = "" if name.endswith("_rad") else percent(p)
        rows.append((name, value, error, share, units.get(name, ""), note))
    return rows


def correlation_pairs(fit: Fit) -> list[tuple[str, str, float]]:
    """Pairs of parameters with a correlation above 0.3 in magnitude, strongest first."""
    names = [name for name, p in fit.parameters.items() if not p.held]
    pairs = [
        (names[i], names[j], float(fit.correlations[i, j]))
        for i in range(len(names))
        for j in range(i + 1, len(names))
        if np.isfinite(fit.correlations[i, j]) and abs(fit.correlations[i, j]) > LEAST_CORRELATION
    ]
    return sorted(pairs, key=lambda pair: -abs(pair[2]))


def ratio(error_n: float, noise_rms: float) -> str:
    """Format the ratio of error to noise with two decimals; empty if the noise is zero."""
    return f"{error_n / noise_rms:.2f}" if noise_rms > 0.0 else ""


def ledger_rows(diagnosis: Diagnosis) -> list[tuple[str, str, str, str, str]]:
    """Step name, fit RMS, held-out RMS, noise (N), and ratio of the last two, for each step."""
    return [
        (
            step_name(diagnosis, i),
            number(s.rms),
            number(s.held_out_rms),
            number(s.noise_rms) if s.noise_rms > 0.0 else UNKNOWN,
            ratio(s.held_out_rms, s.noise_rms),
        )
        for i, s in enumerate(diagnosis.steps)
    ]


def trial_rows(step: Step) -> list[tuple[str, str, str, str, str]]:
    """Effect, RMS (N), evidence, outcome and reason of each candidate of a step."""
    return [
        (t.effect, number(t.rms), f"{t.evidence:+.0f}", t.outcome, t.reason) for t in step.trials
    ]


def run_rows(comparison: Comparison) -> list[tuple[str, str, str, str]]:
    """Name, number of included samples, RMS (N), and RMS over noise of each run."""
    return [
        (r.name, str(r.samples), number(r.rms), ratio(r.rms, comparison.noise_rms))
        for r in comparison.runs
    ]


def model_rows(compared: ModelComparison) -> list[tuple[str, str, str, str]]:
    """Name, RMS, difference to the best, and its standard error of each model."""
    return [
        (
            m.name,
            number(m.rms),
            number(m.difference) if i else "",
            number(m.stderr) if isfinite(m.stderr) else "",
        )
        for i, m in enumerate(compared.models)
    ]


def finding_rows(findings: Iterable[Finding]) -> list[tuple[str, str]]:
    """Kind of each finding, with its description and runs; a long list of runs is truncated."""
    kinds: dict[str, list[Finding]] = {}
    for finding in findings:
        kinds.setdefault(finding.kind, []).append(finding)
    rows = []
    for kind, of_kind in kinds.items():
        runs: dict[str, list[str]] = {}
        for f in of_kind:
            runs.setdefault(f.words, []).append(f.run)
        descriptions = [f"{words}, in {_listed_runs(those)}" for words, those in runs.items()]
        rest = sum(map(len, list(runs.values())[MOST_RUNS_NAMED:]))
        if rest:
            descriptions = [
                *descriptions[:MOST_RUNS_NAMED],
                f"and in {count_of(rest, 'other run')}",
            ]
        rows.append((kind.replace("_", " "), f"{'; '.join(descriptions)} ({of_kind[0].done})"))
    return rows


def power_rows(
    power: Iterable[Power], law: str, quantities: Quantities
) -> list[tuple[str, str, str, str, str]]:
    """Detection limits of each effect, as rows of text.

    The columns are the effect, the smallest strength at which it is detected, and this strength as
    a share of the friction. Further columns are the smallest strength at which the effect is
    identified uniquely, and the effects confounded with it.
    """
    rows = []
    for p in power:
        unit = units_of(law, (p.effect,), quantities)[f"{p.effect}.{p.parameter}"]
        share = "" if p.share_80 is None or p.always else f"{100.0 * p.share_80:.2g} %"
        detectable = (
            "never"
            if p.detectable_80 is None
            else f"{p.parameter} {number(p.detectable_80)} {unit}".strip()
        )
        detectable = "any size" if p.always else detectable
        distinguishable = (
            ""
            if p.detectable_80 is None
            else "never"
            if p.distinguishable_80 is None
            else number(p.distinguishable_80)
        )
        if p.detectable_80 is not None and distinguishable == number(p.detectable_80):
            distinguishable = "same"
        rows.append(
            (
                p.effect,
                detectable,
                share,
                distinguishable,
                ", ".join(p.confounded_with[:MOST_RUNS_NAMED]),
            )
        )
    return rows


def law_rows(diagnosis: Diagnosis) -> list[tuple[str, str, str, str]]:
    """Law, number of parameters, held-out RMS (N), and outcome of the comparison, for each law."""
    return [
        (
            comparison.law,
            str(comparison.parameters),
            number(comparison.held_out_rms),
            "selected" if i == 0 else "equally good" if comparison.tied else "worse",
        )
        for i, comparison in enumerate(diagnosis.laws)
    ]


def _listed_runs(runs: list[str]) -> str:
    """List runs by name; of a long list only the first few."""
    if len(runs) <= MOST_RUNS_NAMED:
        return ", ".join(runs)
    further = count_of(len(runs) - MOST_RUNS_NAMED, "run")
    return f"{', '.join(runs[:MOST_RUNS_NAMED])} and {further} more"
