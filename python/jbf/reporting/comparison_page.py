"""Report of a comparison as one self-contained HTML page with embedded figures."""

from __future__ import annotations

from jbf.comparison.comparison import Comparison
from jbf.plot.maps import friction_map, residual_map
from jbf.reporting.comparison_plots import plot_comparison, plot_run
from jbf.reporting.page import import_rows, measurement, page, pattern_rows
from jbf.reporting.provenance import file_rows, fingerprint
from jbf.reporting.svg import svg
from jbf.reporting.tables import finding_rows, parameter_rows, run_rows
from jbf.reporting.words import comparison_sentence, law_and_effects, listed


def comparison_page(comparison: Comparison, command: str = "") -> str:
    """HTML report of a comparison; `command` is printed in its footer."""
    model = comparison.model
    return page(
        "comparison.html.j2",
        "Model against measurement",
        command=command,
        fingerprint=fingerprint([p.run for p in comparison.campaign.prepared]),
        files=file_rows(p.run for p in comparison.campaign.prepared),
        sentence=comparison_sentence(comparison),
        axes=listed(f.axis for f in comparison.failures),
        law=f"law {law_and_effects(model)}",
        measurement=measurement(comparison, comparison.noise_rms),
        failures=pattern_rows(comparison.failures),
        picture=svg(
            plot_comparison(comparison),
            "Friction against speed in the worst run; residual along its worst axis",
        ),
        run_picture=svg(
            plot_run(comparison),
            "Friction of the worst run in time, measured and modelled, and the residual",
        ),
        map_picture=svg([friction_map(comparison)], "Samples of all runs over speed and friction"),
        residual_picture=svg([residual_map(comparison)], "Residual in all runs"),
        unit=model.rig.quantities.force,
        runs=run_rows(comparison),
        findings=finding_rows(comparison.findings),
        imported=import_rows(comparison),
        parameters=parameter_rows(model.law, model.effects, model.parameters, model.rig.quantities),
    )
