"""Power as plain text: the smallest strength at which each effect is detected."""

from __future__ import annotations

from collections.abc import Iterable
from textwrap import wrap

from jbf.diagnosis.decoys import rate_below
from jbf.diagnosis.level import Level
from jbf.diagnosis.plan import Plan
from jbf.diagnosis.planned import PlannedPower
from jbf.diagnosis.power import Power
from jbf.models.model import Model
from jbf.records.counts import count_of
from jbf.reporting.paragraphs import columns, hanging
from jbf.reporting.tables import power_rows
from jbf.reporting.words import law_words, number

WIDEST = 100
"""Maximum width of a table line in characters."""


def power_lines(power: Iterable[Power], model: Model) -> list[str]:
    """Format one line per effect, under a header."""
    head = ("effect", "found from", "of friction", "alone from", "else it could be")
    rows = power_rows(power, model.law, model.rig.quantities)
    lines = columns([head, *rows], "<<>><", 4)
    # Further names are aligned below the first.
    below = " " * lines[0].index(head[-1])
    return [part for line in lines for part in wrap(line, WIDEST, subsequent_indent=below)]


def level_words(level: Level) -> str:
    """Describe the false-alarm rate and the log-likelihood gain that a detection requires."""
    said = (
        f"false-alarm rate: at most {100.0 * level.false_alarm_rate:.3g} %; of "
        f"{count_of(level.candidates, 'candidate')} one must gain {number(level.critical)} in "
        "twice the log likelihood"
    )
    if level.blocks:
        said += f", by the residual itself, {level.blocks} blocks of it turned at random"
    allowed = level.white_noise_threshold + level.artefact_margin
    if level.artefact_margin:
        said += f"; with what recordings do to a record at least {number(allowed)}"
    if level.min_gain > max(level.critical, allowed):
        said += f"; to be worth a name it must gain {number(level.min_gain)}"
    if level.decoys:
        below = 100.0 * rate_below(level.decoys_named, level.decoys)
        told = f"{below:.2g}" if below < 99.5 else "100"
        said += (
            f"; of {level.decoys} campaigns of decoys, candidates in the wrong place along these "
            f"runs, {level.decoys_named} would have made a name (false names below {told} %)"
        )
    return said


def planned_report(planned: PlannedPower) -> str:
    """Report the power of planned runs."""
    model = planned.model
    unit = model.rig.quantities.force
    beside = " + ".join([law_words(model, ", "), *model.effects])
    lines = [
        f"{count_of(len(planned.runs), 'run')} beside {beside}, noise of "
        f"{number(planned.noise_rms)} {unit}",
        "",
        "What such runs show, in 80 of 100 campaigns",
        *power_lines(planned.power, model),
        *hanging("    ", f"({level_words(planned.level)})", 0),
    ]
    if planned.not_tried:
        lines += ["", "Not asked for: these runs cannot show"]
        for name, reason in planned.not_tried.items():
            lines += hanging(f"    {name}: ", reason, 0)
    return "\n".join(lines)


def plan_report(plan: Plan) -> str:
    """List the runs to record, followed by their power."""
    rows = [("run", "motion")]
    rows += [(run.name, words) for run, words in zip(plan.runs, plan.words, strict=True)]
    lines = ["Record, those that tell most first", ""]
    return "\n".join([*lines, *columns(rows, "<<", 4), "", planned_report(plan.planned)])


def short_plan(plan: Plan) -> str:
    """Summarize the plan in one line."""
    return f"Plan: {count_of(len(plan.runs), 'run')}; {short_power(plan.planned)}"


def short_power(planned: PlannedPower) -> str:
    """Summarize the power of planned runs in one line."""
    found = sum(p.detectable_80 is not None for p in planned.power)
    return (
        f"PlannedPower: {count_of(len(planned.runs), 'run')} show {found} of "
        f"{count_of(len(planned.power), 'effect')}, each from a strength of its own"
    )
