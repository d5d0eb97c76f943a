"""Export of a model as text: its ledger of losses."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from jbf.export.ledger import Ledger, Term
from jbf.export.target import Exported
from jbf.records.counts import count_of
from jbf.reporting.paragraphs import columns, hanging
from jbf.reporting.small_tables import table
from jbf.reporting.words import number

STATUS = {
    "exact": "exact",
    "approximate": "approximate",
    "none": "not carried",
    "external": "not included",
}
"""Words for the status of a term."""
MOST_RUNS = 8
TERM_HEAD = ("term", "status", "how")


def _described(term: Term) -> str:
    values = ", ".join(f"{name} {number(value)}" for name, value in term.values.items())
    return f"{term.how}: {values}" if values else term.how


def _percent(share: float) -> str:
    return f"{number(100.0 * share)} %"


def loss_words(ledger: Ledger) -> str:
    """State the error of an exported form, in the unit of the rig and as a share of friction."""
    return (
        f"{number(ledger.rms)} {ledger.unit} RMS, {_percent(ledger.share)} of the friction of "
        f"{number(ledger.friction_rms)} {ledger.unit}"
    )


def export_report(exported: Exported) -> str:
    """Report an export: loss, terms, errors by run, and notes."""
    ledger = exported.ledger
    lines = [f"Export to {exported.target}: loss {loss_words(ledger)}", "[[Terms]]"]
    width = max(len(term.name) for term in ledger.terms)
    longest = max(map(len, STATUS.values()))
    for term in ledger.terms:
        lead = f"{term.name:<{width}}  {STATUS[term.status]:<{longest}}  "
        lines += hanging(lead, _described(term), 4)
    rows = [("run", "RMS", "largest", "of friction")]
    shown = sorted(ledger.runs, key=lambda loss: -loss.rms)[:MOST_RUNS]
    rows += [(r.run, number(r.rms), number(r.largest), _percent(r.share)) for r in shown]
    lines += [f"[[Errors]] ({ledger.unit}, evaluated by {ledger.evaluated_by})"]
    lines += columns(rows, "<>>>", 4)
    if len(ledger.runs) > MOST_RUNS:
        lines.append(f"    and {count_of(len(ledger.runs) - MOST_RUNS, 'run')} with smaller errors")
    for note in ledger.notes:
        lines += hanging("note: ", f"{note}.", 4)
    return "\n".join(lines)


def short_export(exported: Exported) -> str:
    """Summarize an export in one line."""
    return f"Exported({exported.target}; loss {loss_words(exported.ledger)})"


def term_rows(ledger: Ledger) -> list[Sequence[str]]:
    """Rows of the table of terms."""
    return [(term.name, STATUS[term.status], _described(term)) for term in ledger.terms]


def export_table(exported: Exported) -> str:
    """HTML table of the terms of an export."""
    title = f"Export to {exported.target}: loss {loss_words(exported.ledger)}"
    return table(title, TERM_HEAD, term_rows(exported.ledger))


def export_columns(exported: Exported) -> dict[str, Any]:
    """Errors of an export by run, as columns."""
    runs = exported.ledger.runs
    return {
        "run": [loss.run for loss in runs],
        "rms": [loss.rms for loss in runs],
        "largest": [loss.largest for loss in runs],
        "friction_rms": [loss.friction_rms for loss in runs],
        "share": [loss.share for loss in runs],
    }
