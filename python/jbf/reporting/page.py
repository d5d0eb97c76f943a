"""A comparison or a diagnosis as one self-contained HTML page, pictures included."""

from __future__ import annotations

import base64
import io
import platform
from datetime import datetime, timezone
from functools import cache
from importlib.metadata import version
from typing import TYPE_CHECKING, Any, cast

import jinja2
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from jbf import _core
from jbf.models.catalogue import find_effect
from jbf.reporting.plots import plot_comparison, plot_diagnosis, plot_run
from jbf.reporting.tables import (
    correlation_pairs,
    ledger_rows,
    parameter_rows,
    ratio,
    run_rows,
    trial_rows,
)
from jbf.reporting.words import (
    BARE,
    comparison_sentence,
    law_words,
    listed,
    number,
    verdict_sentence,
)
from jbf.text_files import write_text

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from jbf.comparison.comparison import Comparison, Failure
    from jbf.diagnosis.ledger import Remainder
    from jbf.diagnosis.result import Diagnosis
    from jbf.models.model import Model
    from jbf.records.run import PathLike

PIXELS_PER_INCH = 130
PACKAGES = ("numpy", "scipy", "matplotlib")


@cache
def _environment() -> jinja2.Environment:
    # Names of runs and files come from the user: everything is escaped.
    return jinja2.Environment(
        loader=jinja2.PackageLoader("jbf.reporting", "templates"),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
    )


def _page(template: str, title: str, **content: Any) -> str:
    return (
        _environment()
        .get_template(template)
        .render(
            title=title,
            version=_core.__version__,
            date=datetime.now(timezone.utc).strftime("%Y-%m-%d %H:%M UTC"),
            python=platform.python_version(),
            packages=", ".join(f"{name} {version(name)}" for name in PACKAGES),
            **content,
        )
    )


def _picture(axes: Sequence[Axes]) -> str:
    """The figure of some axes as a data URL."""
    buffer = io.BytesIO()
    cast(Figure, axes[0].figure).savefig(buffer, format="png", dpi=PIXELS_PER_INCH)
    return "data:image/png;base64," + base64.b64encode(buffer.getvalue()).decode("ascii")


def _patterns(patterns: Iterable[Failure | Remainder]) -> list[tuple[str, str, str]]:
    return [(p.axis, f"{100 * p.share:.0f} %", p.where) for p in patterns]


def _measurement(comparison: Comparison, noise_n: float) -> str:
    runs = comparison.campaign.prepared
    duration = sum(p.run.duration_s for p in runs)
    return (
        f"{len(runs)} runs of {duration:.0f} s in all, {comparison.samples.count} samples "
        f"where the sign of the motion is known, noise floor {number(noise_n)} N"
    )


def _law(model: Model) -> str:
    return " + ".join([f"law {law_words(model)}", *model.effects])


def comparison_page(comparison: Comparison) -> str:
    """The HTML text of a comparison's report."""
    model = comparison.model
    return _page(
        "comparison.html.j2",
        "Model against measurement",
        sentence=comparison_sentence(comparison),
        axes=listed(f.axis for f in comparison.failures),
        law=_law(model),
        measurement=_measurement(comparison, comparison.noise_n),
        failures=_patterns(comparison.failures),
        picture=_picture(plot_comparison(comparison)),
        run_picture=_picture(plot_run(comparison)),
        runs=run_rows(comparison),
        parameters=parameter_rows(model, cast(Any, model.parameters)),
    )


def diagnosis_page(diagnosis: Diagnosis) -> str:
    """The HTML text of a diagnosis's report."""
    before, after = diagnosis.before, diagnosis.after
    bare = diagnosis.steps[0]
    trials = [
        (" + ".join([BARE, *step.effects]), trial_rows(diagnosis, step))
        for step in diagnosis.steps
        if step.trials
    ]
    head: tuple[str, ...]
    runs: Sequence[tuple[str, ...]]
    if diagnosis.effects:
        head = ("run", "samples", "bare law (N)", "final model (N)", "final / noise")
        runs = [
            (
                x.name,
                str(x.samples),
                number(x.rms_n),
                number(y.rms_n),
                ratio(y.rms_n, after.noise_n),
            )
            for x, y in zip(before.runs, after.runs, strict=True)
        ]
    else:
        head, runs = ("run", "samples", "RMS (N)", "RMS / noise"), run_rows(before)
    pairs = correlation_pairs(diagnosis.fit)[:5]
    return _page(
        "diagnosis.html.j2",
        f"Diagnosis: {diagnosis.verdict}",
        verdict=diagnosis.verdict,
        sentence=verdict_sentence(diagnosis),
        next_experiment=diagnosis.next_experiment,
        measurement=_measurement(before, bare.noise_n),
        ledger=ledger_rows(diagnosis),
        picture=_picture(plot_diagnosis(diagnosis)),
        before_picture=_picture(plot_run(before)) if diagnosis.failures else "",
        failures=_patterns(diagnosis.failures),
        trials=trials,
        effects=[find_effect(name) for name in diagnosis.effects],
        unexplained=_patterns(diagnosis.unexplained),
        parameters=parameter_rows(diagnosis.model, diagnosis.fit.parameters),
        correlations="; ".join(f"{a} with {b} {c:+.2f}" for a, b, c in pairs),
        run_head=head,
        runs=runs,
    )


def write_comparison(comparison: Comparison, path: PathLike) -> None:
    """Write a comparison as one HTML file, whole or not at all.

    Raises
    ------
    InputError
        The file cannot be written.
    """
    write_text(path, comparison_page(comparison))


def write_diagnosis(diagnosis: Diagnosis, path: PathLike) -> None:
    """Write a diagnosis as one HTML file, whole or not at all.

    Raises
    ------
    InputError
        The file cannot be written.
    """
    write_text(path, diagnosis_page(diagnosis))
