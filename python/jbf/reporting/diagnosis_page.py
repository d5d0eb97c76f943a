"""Report of a diagnosis as one self-contained HTML page with embedded figures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from markupsafe import Markup
from matplotlib.axes import Axes

from jbf.comparison.parts import non_friction_effects
from jbf.diagnosis.budget import POWER
from jbf.diagnosis.result import Diagnosis
from jbf.diagnosis.selection import CHANCE
from jbf.errors import InputError
from jbf.models.catalogue import Effect, find_effect
from jbf.plot.ledger import ledger
from jbf.plot.loops import draw_model, loops
from jbf.plot.maps import friction_map, residual_map
from jbf.plot.power import power
from jbf.plot.ranking import ranking, ranking_height
from jbf.plot.residuals import means_along, residual_along, residual_in_time
from jbf.plot.runs import largest_error_run
from jbf.plot.stribeck import stribeck
from jbf.plot.style import BEFORE, MODEL, axes_or_new, one_axes
from jbf.reporting.diagnosis_plot import before_and_after
from jbf.reporting.effect_words import known_mass, limits_of, summary_of
from jbf.reporting.gallery import failure_cards, remainder_cards
from jbf.reporting.page import import_rows, measurement, page
from jbf.reporting.power_text import level_words
from jbf.reporting.provenance import file_rows, fingerprint
from jbf.reporting.svg import svg
from jbf.reporting.tables import (
    correlation_pairs,
    finding_rows,
    law_rows,
    ledger_rows,
    parameter_rows,
    power_rows,
    ratio,
    run_rows,
    trial_rows,
)
from jbf.reporting.words import (
    BASE_LAW,
    extrapolation_sentences,
    headline_and_rest,
    held_out_sentence,
    listed,
    not_tested_rows,
    number,
)

WIDTH = 10.0
"""Width of a full-width figure, inches; the font size of the figure is then that of the page.
"""


def diagnosis_page(diagnosis: Diagnosis, command: str = "") -> str:
    """HTML report of a diagnosis.

    Parameters
    ----------
    command
        Command that produced the report, printed in the page footer.
    """
    before, after = diagnosis.before, diagnosis.after
    quantities = diagnosis.model.rig.quantities
    head, runs = _run_table(diagnosis)
    pairs = correlation_pairs(diagnosis.fit)[:5]
    headline, rest = headline_and_rest(diagnosis)
    recorded = [p.run for p in before.campaign.prepared]
    values = diagnosis.fit.parameters
    return page(
        "diagnosis.html.j2",
        f"Diagnosis: {diagnosis.verdict}",
        command=command,
        verdict=diagnosis.verdict,
        headline=headline,
        rest=rest,
        next_experiment=diagnosis.next_experiment,
        ledger_picture=_ledger(diagnosis),
        before_picture=_plot_before_and_after(diagnosis),
        measurement=measurement(before, diagnosis.steps[0].noise_rms),
        held_out=held_out_sentence(diagnosis),
        extrapolations=extrapolation_sentences(diagnosis),
        findings=finding_rows(diagnosis.findings),
        failures=failure_cards(diagnosis),
        residual_structure=remainder_cards(diagnosis),
        residual_picture=svg([residual_map(after)], "Residual of the final model in all runs"),
        last_picture=_plot_final_residual(diagnosis),
        taken_out=listed(non_friction_effects(after)),
        friction_picture=_friction(diagnosis),
        map_picture=svg(
            [friction_map(after, ax=_full_width_axes(4.2))],
            "Samples of all runs over speed and friction",
        ),
        ledger=ledger_rows(diagnosis),
        laws=law_rows(diagnosis),
        unit=quantities.force,
        effects=[_effect(diagnosis, name) for name in diagnosis.effects],
        parameters=parameter_rows(
            diagnosis.model.law, diagnosis.model.effects, diagnosis.fit.parameters, quantities
        ),
        held=[i for i, p in enumerate(values.values()) if p.held],
        correlations="; ".join(f"{a} with {b} {c:+.2f}" for a, b, c in pairs),
        power=power_rows(diagnosis.power, diagnosis.model.law, quantities),
        power_picture=_power(diagnosis),
        level=level_words(diagnosis.level),
        rounds=_rounds(diagnosis),
        remains=bool(diagnosis.residual_structure),
        no_power=diagnosis.not_tried.get(POWER, ""),
        not_tried=not_tested_rows(diagnosis.not_tried),
        not_detectable=listed(diagnosis.not_detectable),
        negligible=listed(diagnosis.negligible),
        limitations=diagnosis.limitations,
        run_head=head,
        runs=runs,
        imported=import_rows(before),
        files=file_rows(recorded),
        fingerprint=fingerprint(recorded),
    )


def _effect(diagnosis: Diagnosis, name: str) -> Effect:
    """Catalogue entry of an effect, worded for the kind of rig."""
    page, quantities = find_effect(name), diagnosis.model.rig.quantities
    summary = summary_of(page, quantities) + known_mass(diagnosis.model, name)
    return replace(page, summary=summary, limits=limits_of(page, quantities))


def _run_table(diagnosis: Diagnosis) -> tuple[tuple[str, ...], Sequence[tuple[str, ...]]]:
    """Header and rows of a table of errors per run, before and after effects were added."""
    before, after = diagnosis.before, diagnosis.after
    unit = diagnosis.model.rig.quantities.force
    if not diagnosis.effects:
        return ("run", "samples", f"RMS ({unit})", "RMS / noise"), run_rows(before)
    head = ("run", "samples", f"base law ({unit})", f"final model ({unit})", "final / noise")
    return head, [
        (
            x.name,
            str(x.samples),
            number(x.rms),
            number(y.rms),
            ratio(y.rms, after.noise_rms),
        )
        for x, y in zip(before.runs, after.runs, strict=True)
    ]


@dataclass(frozen=True)
class Round:
    """Candidates tested in one step of the selection, for a section of the page.

    Attributes
    ----------
    beside
        Model to which the candidates were added.
    picture
        Ranking of the candidates; empty if none has evidence.
    rows
        One row per candidate, without those that have no significant gain.
    nothing
        Names of the candidates that have no significant gain.
    """

    beside: str
    picture: Markup | str
    rows: list[tuple[str, ...]]
    nothing: str


def _rounds(diagnosis: Diagnosis) -> list[Round]:
    rounds = []
    for i, step in enumerate(diagnosis.steps):
        if not step.trials:
            continue
        rows = zip(step.trials, trial_rows(step), strict=True)
        named = any(t.evidence > 0.0 for t in step.trials)
        ax = _full_width_axes(ranking_height(step)) if named else None
        rounds.append(
            Round(
                " + ".join([BASE_LAW, *step.effects]),
                svg([ranking(diagnosis, i, ax=ax)], "Evidence of each candidate") if named else "",
                [row for trial, row in rows if trial.reason != CHANCE],
                listed(t.effect for t in step.trials if t.reason == CHANCE),
            )
        )
    return rounds


def _full_width_axes(height: float) -> Axes:
    """Create axes of a figure with the width of the page."""
    return one_axes(None, (WIDTH, height))


def _ledger(diagnosis: Diagnosis) -> Markup:
    ax = _full_width_axes(1.25 + 0.3 * len(diagnosis.steps))
    return svg([ledger(diagnosis, ax=ax)], "Error of each step, fit and held out, and the noise")


def _plot_before_and_after(diagnosis: Diagnosis) -> Markup | str:
    """Plot the friction and the residual of base law and final model; empty if they are equal.

    The left axes shows the run in which both differ most, the right one the residual along the axis
    of the worst failure.
    """
    before, after = diagnosis.before, diagnosis.after
    if not diagnosis.model.effects:
        return ""
    left, right = axes_or_new(None, 1, 2, (WIDTH, 3.3))
    index = largest_error_run(before, after)
    loops(before, index, ax=left, colour=BEFORE, title=f"Run {before.runs[index].name}")
    draw_model(left, after, index, colour=MODEL, label="final")
    handles, labels = left.get_legend_handles_labels()
    labels[labels.index("model")] = "base law"
    left.legend(handles, labels, frameon=False, fontsize="small")
    before_and_after(diagnosis, means_along(before, None), right)
    return svg([left, right], "Base law and final model, in one run and along the worst axis")


def _plot_final_residual(diagnosis: Diagnosis) -> Markup:
    """Plot the residual of the final model in time and along its worst axis.

    The time plot shows the run with the largest error.
    """
    after = diagnosis.after
    left, right = axes_or_new(None, 1, 2, (WIDTH, 3.6))
    residual_in_time(after, largest_error_run(after), ax=left)
    title = left.get_title(loc="left")
    left.set_title(f"Final model: {title[0].lower()}{title[1:]}", loc="left", fontsize="medium")
    residual_along(after, ax=right)
    return svg([left, right], "Residual of the final model in time, and along its worst axis")


def _friction(diagnosis: Diagnosis) -> Markup:
    """Plot the friction loops of one run, and the mean friction of all runs.

    The selected run is that in which the base law and the final model differ most.
    """
    left, right = axes_or_new(None, 1, 2, (WIDTH, 4.0))
    index = largest_error_run(diagnosis.before, diagnosis.after)
    loops(diagnosis.after, index, alone=True, ax=left)
    stribeck(diagnosis.after, ax=right)
    return svg([left, right], "Friction against speed in one run, and means over all runs")


def _power(diagnosis: Diagnosis) -> Markup | str:
    try:
        return svg(
            [power(diagnosis, ax=_full_width_axes(3.6))],
            "Detection probability over the strength of each effect",
        )
    except InputError:
        return ""
