"""Results as small HTML tables, for notebooks: `_repr_html_`."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape

from jbf.comparison.comparison import Comparison
from jbf.control.run import Result as LoopRun
from jbf.diagnosis.result import Diagnosis
from jbf.estimation.bootstrap import Bootstrap
from jbf.estimation.fit import Fit
from jbf.estimation.trajectory_fit import TrajectoryFit
from jbf.importing.result import Import
from jbf.reporting.control_run_text import status_words
from jbf.reporting.tables import ledger_rows, parameter_rows, run_rows
from jbf.reporting.words import (
    comparison_sentence,
    law_and_effects,
    listed,
    number,
    verdict_sentence,
)

PARAMETER_HEAD = ("parameter", "value", "standard error", "", "unit", "note")


def table(title: str, head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A titled table; names come from users, so every cell is escaped."""

    def line(cells: Iterable[str], tag: str) -> str:
        return "<tr>" + "".join(f"<{tag}>{escape(cell)}</{tag}>" for cell in cells) + "</tr>"

    body = "".join(line(row, "td") for row in rows)
    return f"<p>{escape(title)}</p><table>{line(head, 'th')}{body}</table>"


def fit_table(fit: Fit) -> str:
    """The parameters with errors."""
    said = fit.model.rig.quantities
    search = "" if fit.converged else ", not converged"
    title = f"Fit: {law_and_effects(fit.model)}; RMS {number(fit.rms_n)} {said.force}{search}"
    rows = parameter_rows(fit.model.law, fit.model.effects, fit.parameters, said)
    return table(title, PARAMETER_HEAD, rows)


def bootstrap_table(found: Bootstrap) -> str:
    """The parameters with errors from fits again."""
    model = found.fit.model
    rows = parameter_rows(model.law, model.effects, found.fit.parameters, model.rig.quantities)
    return table("Errors from fits of simulated records", PARAMETER_HEAD, rows)


def trajectory_table(fit: TrajectoryFit) -> str:
    """The parameters with errors."""
    rows = parameter_rows("journal", (), fit.parameters)
    return table(f"Fit of trajectories: {fit.samples} samples", PARAMETER_HEAD, rows)


def loop_table(run: LoopRun) -> str:
    """The errors of a run of the loop."""
    unit = run.task.unit
    head = ("scheme", f"RMS ({unit})", f"peak ({unit})", f"true RMS ({unit})", "status")
    row = (run.scheme, number(run.rms), number(run.peak), number(run.true_rms), status_words(run))
    return table(f"{run.task.control} control, {run.task.wave}", head, [row])


def comparison_table(comparison: Comparison) -> str:
    """How far each run is off."""
    where = listed(f.axis for f in comparison.failures)
    title = comparison_sentence(comparison) + (f"; fails along {where}" if where else "")
    unit = comparison.model.rig.quantities.force
    return table(title, ("run", "samples", f"RMS ({unit})", "RMS / noise"), run_rows(comparison))


def diagnosis_table(diagnosis: Diagnosis) -> str:
    """The ledger below the verdict."""
    title = f"Verdict: {diagnosis.verdict}. {verdict_sentence(diagnosis, place='')}"
    unit = diagnosis.model.rig.quantities.force
    head = ("step", f"fit ({unit})", f"held out ({unit})", f"noise ({unit})", "held out / noise")
    return table(title, head, ledger_rows(diagnosis))


def import_table(found: Import) -> str:
    """The runs, and what was left out."""
    rows = [
        (p.name or f"left out: {p.why}", p.file, f"{p.from_s:.3f}", f"{p.to_s:.3f}")
        for p in found.pieces
    ]
    return table(f"Import: {found.folder}", ("run", "file", "from (s)", "to (s)"), rows)
