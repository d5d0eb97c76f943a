"""Text lines shared by several plain-text reports: parameters, failures, findings."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from jbf.comparison.patterns import Failure
from jbf.diagnosis.ledger import Remainder
from jbf.models.parameter_value import ParameterValue
from jbf.records.counts import count_of
from jbf.records.findings.finding import Finding
from jbf.records.quantities import BEARING, Quantities
from jbf.records.run import Run
from jbf.reporting.paragraphs import columns, hanging
from jbf.reporting.tables import finding_rows, parameter_rows


def parameter_lines(
    law: str,
    effects: tuple[str, ...],
    parameters: Mapping[str, ParameterValue],
    quantities: Quantities = BEARING,
) -> list[str]:
    """Format one line per parameter: value, standard error, percentage, unit, note."""
    rows = [
        (
            name,
            value,
            f"+/- {error}" if error else "",
            f"({share})" if share else "",
            unit,
            f"({note})" if note else "",
        )
        for name, value, error, share, unit, note in parameter_rows(
            law, effects, parameters, quantities
        )
    ]
    return columns(rows, "<>>><<", 4)


def where_lines(patterns: Iterable[Failure | Remainder]) -> list[str]:
    """Format one hanging paragraph per axis: axis, share of the mean square, description."""
    patterns = list(patterns)
    widest = max((len(p.axis) for p in patterns), default=0)
    lines = []
    for p in patterns:
        lines += hanging(f"{p.axis:<{widest}}  {100 * p.share:3.0f} %  ", p.where, 4)
    return lines


def finding_lines(findings: Iterable[Finding]) -> list[str]:
    """List the data-quality findings and how each was treated; empty without findings."""
    rows = finding_rows(findings)
    lines = ["", "Data quality"] if rows else []
    for head, words in rows:
        lines += hanging(f"{head}: ", words, 4)
    return lines


def recorded(runs: Sequence[Run]) -> str:
    """Describe the number and total duration of the runs."""
    count = count_of(len(runs), "run")
    if any(run.steady for run in runs):
        return f"{count} of steady states"
    return f"{count}, {sum(run.duration_s for run in runs):.0f} s in total"
