"""Simulated success rates of a diagnosis (`jbf check`) as plain text."""

from __future__ import annotations

from jbf.diagnosis.check import Check
from jbf.reporting.paragraphs import columns
from jbf.reporting.words import law_and_effects


def check_report(check: Check) -> str:
    """Format the simulated success rates of a diagnosis, one per line with its 95 % interval."""
    rows = [("simulated campaigns", "count", "share", "95 % interval")]
    for rate in check.rates:
        share = 100.0 * rate.count / rate.campaigns
        rows.append(
            (
                rate.what,
                f"{rate.count} of {rate.campaigns}",
                f"{share:.3g} %",
                f"{100.0 * rate.low:.3g} to {100.0 * rate.high:.3g} %",
            )
        )
    return "\n".join(
        [f"Campaigns simulated with {law_and_effects(check.model)}", "", *columns(rows, "<>>>", 0)]
    )


def short_check(check: Check) -> str:
    """Summarize the simulated success rates of a diagnosis in one line."""
    right = sum(a.right for a in check.answers)
    return f"Check: {right} of {len(check.answers)} campaigns diagnosed correctly"
