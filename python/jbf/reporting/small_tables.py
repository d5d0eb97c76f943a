"""Results as small HTML tables for notebooks (`_repr_html_`)."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape

import numpy as np

from jbf.comparison.comparison import Comparison
from jbf.comparison.model_comparison import ModelComparison
from jbf.control.run import Result as LoopRun
from jbf.diagnosis.check import Check
from jbf.diagnosis.experiment_design.plan import Plan
from jbf.diagnosis.power.planned_runs import PlannedPower
from jbf.diagnosis.result import Diagnosis
from jbf.estimation.bootstrap import Bootstrap
from jbf.estimation.fit import Fit
from jbf.estimation.trajectory_fit import TrajectoryFit
from jbf.importing.result import Import
from jbf.models.model import Model
from jbf.records.counts import count_of
from jbf.records.run import Run
from jbf.reporting.check_text import check_report
from jbf.reporting.comparison_text import model_comparison_sentence, model_head
from jbf.reporting.control_run_text import status_words
from jbf.reporting.power_text import short_plan, short_power
from jbf.reporting.tables import ledger_rows, model_rows, parameter_rows, power_rows, run_rows
from jbf.reporting.words import (
    comparison_sentence,
    law_and_effects,
    listed,
    number,
    verdict_sentence,
)

POWER_HEAD = ("effect", "detectable from", "of friction", "distinct from", "confounded with")
PARAMETER_HEAD = ("parameter", "value", "standard error", "", "unit", "note")


def table(title: str, head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """HTML table with a title; every cell is escaped because names come from users."""

    def line(cells: Iterable[str], tag: str) -> str:
        return "<tr>" + "".join(f"<{tag}>{escape(cell)}</{tag}>" for cell in cells) + "</tr>"

    body = "".join(line(row, "td") for row in rows)
    return f"<p>{escape(title)}</p><table>{line(head, 'th')}{body}</table>"


def fit_table(fit: Fit) -> str:
    """HTML table of the parameters of a fit with standard errors."""
    quantities = fit.model.rig.quantities
    search = "" if fit.converged else ", not converged"
    title = f"Fit: {law_and_effects(fit.model)}; RMS {number(fit.rms)} {quantities.force}{search}"
    rows = parameter_rows(fit.model.law, fit.model.effects, fit.parameters, quantities)
    return table(title, PARAMETER_HEAD, rows)


def bootstrap_table(bootstrap: Bootstrap) -> str:
    """HTML table of parameters with bootstrap standard errors."""
    model = bootstrap.fit.model
    rows = parameter_rows(model.law, model.effects, bootstrap.fit.parameters, model.rig.quantities)
    return table("Errors from fits of simulated records", PARAMETER_HEAD, rows)


def trajectory_table(fit: TrajectoryFit) -> str:
    """HTML table of the parameters of a trajectory fit with standard errors."""
    rows = parameter_rows("journal", (), fit.parameters)
    return table(f"Fit of trajectories: {fit.nobs} samples", PARAMETER_HEAD, rows)


def loop_table(run: LoopRun) -> str:
    """HTML table of the errors of a control-loop run."""
    unit = run.task.unit
    head = ("scheme", f"RMS ({unit})", f"peak ({unit})", f"true RMS ({unit})", "status")
    row = (run.scheme, number(run.rms), number(run.peak), number(run.true_rms), status_words(run))
    return table(f"{run.task.control} control, {run.task.wave}", head, [row])


def comparison_table(comparison: Comparison) -> str:
    """HTML table of the error of a model in each run."""
    where = listed(f.axis for f in comparison.failures)
    title = comparison_sentence(comparison) + (f"; fails along {where}" if where else "")
    unit = comparison.model.rig.quantities.force
    return table(title, ("run", "samples", f"RMS ({unit})", "RMS / noise"), run_rows(comparison))


def model_comparison_table(compared: ModelComparison) -> str:
    """HTML table of the error of each model and its difference to the best."""
    sentence = model_comparison_sentence(compared)
    return table(sentence, model_head(compared), model_rows(compared))


def diagnosis_table(diagnosis: Diagnosis) -> str:
    """HTML table of the ledger of a diagnosis, titled with the verdict."""
    title = f"Verdict: {diagnosis.verdict}. {verdict_sentence(diagnosis, place='')}"
    unit = diagnosis.model.rig.quantities.force
    head = ("step", f"fit ({unit})", f"held out ({unit})", f"noise ({unit})", "held out / noise")
    return table(title, head, ledger_rows(diagnosis))


def model_table(model: Model) -> str:
    """HTML table of the parameters of a model, titled with the law and the effects."""
    quantities = model.rig.quantities
    rows = parameter_rows(model.law, model.effects, model.parameters, quantities)
    return table(f"Model: {law_and_effects(model)}", PARAMETER_HEAD, rows)


def run_table(run: Run) -> str:
    """HTML table of the columns of a run with their smallest and largest values."""
    rows = [
        (name, number(float(np.min(values))), number(float(np.max(values))))
        for name, values in run.columns().items()
        if len(values) and np.issubdtype(values.dtype, np.number)
    ]
    title = f"Run {run.name}: {count_of(len(run), 'sample')}, {run.duration_s:.4g} s"
    return table(title, ("column", "from", "to"), rows)


def planned_table(planned: PlannedPower) -> str:
    """HTML table of the detection limits of planned runs."""
    rows = power_rows(planned.power, planned.model.law, planned.model.rig.quantities)
    return table(short_power(planned), POWER_HEAD, rows)


def plan_table(plan: Plan) -> str:
    """HTML table of the runs of a plan."""
    rows = [(run.name, words) for run, words in zip(plan.runs, plan.words, strict=True)]
    return table(short_plan(plan), ("run", "motion"), rows)


def check_table(result: Check) -> str:
    """HTML table of the simulated success rates of a diagnosis."""
    lines = [(line.strip(),) for line in check_report(result).splitlines() if line.strip()]
    return table(lines[0][0] if lines else "Check", ("",), lines[1:])


def import_table(campaign: Import) -> str:
    """HTML table of the runs of an import and the excluded pieces."""
    rows = [
        (p.name or f"left out: {p.why}", p.file, f"{p.from_s:.3f}", f"{p.to_s:.3f}")
        for p in campaign.pieces
    ]
    return table(f"Import: {campaign.folder}", ("run", "file", "from (s)", "to (s)"), rows)
