"""Detection limits as plain text: the smallest strength at which each effect is detected."""

from __future__ import annotations

from collections.abc import Iterable
from textwrap import wrap

from jbf.diagnosis.directions import rate_below
from jbf.diagnosis.experiment_design.plan import Plan
from jbf.diagnosis.level import Level
from jbf.diagnosis.power import Power
from jbf.diagnosis.power.planned_runs import PlannedPower
from jbf.models.model import Model
from jbf.records.counts import count_of
from jbf.reporting.paragraphs import columns, hanging
from jbf.reporting.tables import power_rows
from jbf.reporting.words import law_words, number

DETECTION_LIMITS = "Detection limits of these runs (80 % power)"
WIDEST = 100
"""Maximum width of a table line in characters."""


def power_lines(power: Iterable[Power], model: Model) -> list[str]:
    """Tabulate the detection limits, one line per effect below a header."""
    head = ("effect", "detectable from", "of friction", "distinct from", "confounded with")
    rows = power_rows(power, model.law, model.rig.quantities)
    lines = columns([head, *rows], "<<>><", 4)
    # Further names are aligned below the first.
    below = " " * lines[0].index(head[-1])
    return [
        part
        for line in lines
        for part in wrap(line, WIDEST, subsequent_indent=below, break_long_words=False)
    ]


def level_words(level: Level) -> str:
    """Describe the false-alarm rate, and the log-likelihood gain that a detection requires."""
    text = (
        f"false-alarm rate at most {100.0 * level.false_alarm_rate:.3g} %: each of "
        f"{count_of(level.candidates, 'candidate')} must gain {number(level.critical)} in twice "
        "the log likelihood"
    )
    if level.blocks:
        text += f" (wild bootstrap of {level.blocks} blocks of the residual)"
    allowed = level.white_noise_threshold + level.artefact_margin
    if level.artefact_margin:
        text += f"; at least {number(allowed)} with the margin for recording artefacts"
    if level.min_gain > max(level.critical, allowed):
        text += f"; the minimum effect size corresponds to a gain of {number(level.min_gain)}"
    if level.decoys:
        below = 100.0 * rate_below(level.decoys_named, level.decoys)
        rate = f"{below:.2g}" if below < 99.5 else "100"
        text += (
            f"; in {level.decoys} simulations with decoys (candidates displaced along these runs) "
            f"an effect was named {level.decoys_named} times (false-alarm rate below {rate} %)"
        )
    return text


def planned_report(planned: PlannedPower) -> str:
    """Report the detection limits of planned runs."""
    model = planned.model
    unit = model.rig.quantities.force
    law = " + ".join([law_words(model), *model.effects])
    lines = [
        *hanging(
            "",
            f"Power of {count_of(len(planned.runs), 'run')} for the model {law}, noise "
            f"{number(planned.noise_rms)} {unit}",
            0,
        ),
        "",
        DETECTION_LIMITS,
        *power_lines(planned.power, model),
        *hanging("    ", f"({level_words(planned.level)})", 0),
    ]
    if planned.not_tried:
        lines += ["", "Not tested: these runs do not contain the necessary motion or data"]
        for name, reason in planned.not_tried.items():
            lines += hanging(f"    {name}: ", reason, 0)
    return "\n".join(lines)


def plan_report(plan: Plan) -> str:
    """List the runs of a plan, followed by their detection limits."""
    lines = ["Recommended runs, the most informative first", ""]
    widest = max(len(run.name) for run in plan.runs)
    for run, words in zip(plan.runs, plan.words, strict=True):
        lines += hanging(f"{run.name:<{widest}}  ", words, 4)
    return "\n".join([*lines, "", *travel_lines(plan), "", planned_report(plan.planned)])


def travel_lines(plan: Plan) -> list[str]:
    """State the travel of the planned motions, and its limit with the source."""
    unit = plan.planned.model.rig.quantities.length
    text = f"the motions cover at most {number(plan.travel)} {unit} from their start"
    if plan.travel_limit is None:
        text += ". No limit was given: use --travel if the machine has end stops"
    else:
        limit = f"{number(plan.travel_limit)} {unit}"
        source = f"the given {limit}"
        if plan.travel_source == "recorded":
            source = f"the {limit} of the runs of the model; change it with --travel"
        text += f", in the positive direction, within {source}"
    return hanging("Travel: ", text, 0)


def short_plan(plan: Plan) -> str:
    """Summarize the plan in one line."""
    return f"Plan: {count_of(len(plan.runs), 'run')}; {short_power(plan.planned)}"


def short_power(planned: PlannedPower) -> str:
    """Summarize the detection limits of planned runs in one line."""
    detectable = sum(p.detectable_80 is not None for p in planned.power)
    return (
        f"PlannedPower: {count_of(len(planned.runs), 'run')}, {detectable} of "
        f"{count_of(len(planned.power), 'effect')} detectable"
    )
