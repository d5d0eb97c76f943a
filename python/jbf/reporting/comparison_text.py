"""Comparison as plain text, 80 to 100 columns wide."""

from __future__ import annotations

from jbf.comparison.comparison import Comparison
from jbf.comparison.model_comparison import ModelComparison
from jbf.records.counts import count_of
from jbf.reporting.paragraphs import columns
from jbf.reporting.tables import model_rows, run_rows
from jbf.reporting.text_parts import finding_lines, where_lines
from jbf.reporting.words import comparison_sentence


def _run_lines(comparison: Comparison) -> list[str]:
    unit = comparison.model.rig.quantities.force
    rows = [("run", "samples", f"RMS ({unit})", "RMS / noise")]
    return columns([*rows, *run_rows(comparison)], "<>>>", 4)


def comparison_report(comparison: Comparison) -> str:
    """Report the overall error of a model, its residual patterns, and its error in each run."""
    lines = [comparison_sentence(comparison)]
    if comparison.failures:
        lines += [
            "",
            "Lack of fit (share of the mean square residual)",
            *where_lines(comparison.failures),
        ]
    else:
        lines[0] += "; no lack of fit along any axis"
    lines += ["", "Runs", *_run_lines(comparison)]
    return "\n".join([*lines, *finding_lines(comparison.findings)])


MODEL_HEAD = ("model", "RMS ({unit})", "difference", "standard error")


def model_head(compared: ModelComparison) -> list[str]:
    """Header of the table of compared models, with the unit of the errors."""
    return [cell.format(unit=compared.force_unit) for cell in MODEL_HEAD]


def model_comparison_sentence(compared: ModelComparison) -> str:
    """State the numbers of samples and of independent units of a comparison of models."""
    return (
        f"{count_of(len(compared.models), 'model')} on {count_of(compared.nobs, 'sample')}; "
        f"standard errors over {count_of(compared.units, compared.unit)}"
    )


def model_comparison_report(compared: ModelComparison) -> str:
    """Report a comparison of models: one row per model, the best first."""
    rows = [model_head(compared), *model_rows(compared)]
    return "\n".join([model_comparison_sentence(compared), "", *columns(rows, "<>>>", 0)])
