"""Common frame of all self-contained HTML pages, and content shared by several pages."""

from __future__ import annotations

import platform
from collections.abc import Iterable
from datetime import datetime, timezone
from functools import cache
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

import jinja2

from jbf import _core
from jbf.importing.ledger import ledgers_of_runs
from jbf.records.counts import count_of
from jbf.reporting.import_text import provenance_rows
from jbf.reporting.text_parts import recorded
from jbf.reporting.words import noise_words

if TYPE_CHECKING:
    from jbf.comparison.comparison import Comparison
    from jbf.comparison.patterns import Failure
    from jbf.diagnosis.ledger import Remainder

PACKAGES = ("numpy", "scipy", "matplotlib")


@cache
def _environment() -> jinja2.Environment:
    # The names of runs and files come from the user: escape everything.
    return jinja2.Environment(
        loader=jinja2.PackageLoader("jbf.reporting", "templates"),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
    )


def page(template: str, title: str, *, command: str = "", **content: Any) -> str:
    """Render a template as a self-contained page with a footer.

    The footer contains the versions, the date and the command.
    """
    return (
        _environment()
        .get_template(template)
        .render(
            title=title,
            command=command,
            version=_core.__version__,
            date=datetime.now(timezone.utc).strftime("%Y-%m-%d %H:%M UTC"),
            python=platform.python_version(),
            packages=", ".join(f"{name} {version(name)}" for name in PACKAGES),
            **content,
        )
    )


def pattern_rows(patterns: Iterable[Failure | Remainder]) -> list[tuple[str, str, str]]:
    """Axis, share and description of each residual pattern, as text."""
    return [(p.axis, f"{100 * p.share:.0f} %", p.where) for p in patterns]


def import_rows(comparison: Comparison) -> list[tuple[str, str, str]]:
    """Provenance of the runs of a comparison that were imported: file, hash, reading."""
    return provenance_rows(ledgers_of_runs(p.run.path for p in comparison.campaign.prepared))


def measurement(comparison: Comparison, noise_rms: float) -> str:
    """Describe the recorded runs in a phrase: count, duration, samples, noise floor."""
    runs = comparison.campaign.prepared
    unit = comparison.model.rig.quantities.force
    return (
        f"{recorded([p.run for p in runs])}, "
        f"{count_of(comparison.samples.count, 'sample')} "
        f"where the sign of the motion is known, "
        f"noise floor {noise_words(noise_rms, unit)}"
    )
