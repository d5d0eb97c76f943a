"""Comparison as plain text, 80 to 100 columns wide."""

from __future__ import annotations

from jbf.comparison.comparison import Comparison
from jbf.reporting.paragraphs import columns
from jbf.reporting.tables import run_rows
from jbf.reporting.text_parts import finding_lines, where_lines
from jbf.reporting.words import comparison_sentence


def _run_lines(comparison: Comparison) -> list[str]:
    unit = comparison.model.rig.quantities.force
    rows = [("run", "samples", f"RMS ({unit})", "RMS / noise")]
    return columns([*rows, *run_rows(comparison)], "<>>>", 4)


def comparison_report(comparison: Comparison) -> str:
    """Format the overall error, the axes along which the model fails, and the error of each run."""
    lines = [comparison_sentence(comparison)]
    if comparison.failures:
        lines += [
            "",
            "Where it fails (share of the mean square)",
            *where_lines(comparison.failures),
        ]
    else:
        lines[0] += "; no pattern along any axis"
    lines += ["", "Runs", *_run_lines(comparison)]
    return "\n".join([*lines, *finding_lines(comparison.findings)])
