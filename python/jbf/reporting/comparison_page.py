"""A comparison as one self-contained HTML page, pictures included."""

from __future__ import annotations

from jbf.comparison.comparison import Comparison
from jbf.reporting.comparison_plots import plot_comparison, plot_run
from jbf.reporting.page import import_rows, measurement, page, pattern_rows, picture
from jbf.reporting.tables import finding_rows, parameter_rows, run_rows
from jbf.reporting.words import comparison_sentence, law_and_effects, listed


def comparison_page(comparison: Comparison) -> str:
    """The HTML text of a comparison's report."""
    model = comparison.model
    return page(
        "comparison.html.j2",
        "Model against measurement",
        sentence=comparison_sentence(comparison),
        axes=listed(f.axis for f in comparison.failures),
        law=f"law {law_and_effects(model)}",
        measurement=measurement(comparison, comparison.noise_n),
        failures=pattern_rows(comparison.failures),
        picture=picture(plot_comparison(comparison)),
        run_picture=picture(plot_run(comparison)),
        unit=model.rig.quantities.force,
        runs=run_rows(comparison),
        findings=finding_rows(comparison.findings),
        imported=import_rows(comparison),
        parameters=parameter_rows(model.law, model.effects, model.parameters, model.rig.quantities),
    )
