"""Power as plain text: how strong each effect must be to be found."""

from __future__ import annotations

from collections.abc import Iterable

from jbf.diagnosis.planned import PlannedPower
from jbf.diagnosis.power import Power
from jbf.models.model import Model
from jbf.records.counts import count_of
from jbf.reporting.paragraphs import columns, hanging
from jbf.reporting.tables import power_rows
from jbf.reporting.words import law_words, number


def power_lines(power: Iterable[Power], model: Model) -> list[str]:
    """A line an effect, under a head."""
    head = ("effect", "found from", "of friction", "alone from", "else it could be")
    rows = power_rows(power, model.law, model.rig.quantities)
    return columns([head, *rows], "<<>><", 4)


def planned_report(planned: PlannedPower) -> str:
    """What planned runs would show."""
    model = planned.model
    unit = model.rig.quantities.force
    beside = " + ".join([law_words(model, ", "), *model.effects])
    lines = [
        f"{count_of(len(planned.runs), 'run')} beside {beside}, noise of "
        f"{number(planned.noise_n)} {unit}",
        "",
        "What such runs show, in 80 of 100 campaigns",
        *power_lines(planned.power, model),
    ]
    if planned.not_tried:
        lines += ["", "Not asked for: these runs cannot show"]
        for name, reason in planned.not_tried.items():
            lines += hanging(f"    {name}: ", reason, 0)
    return "\n".join(lines)


def short_power(planned: PlannedPower) -> str:
    """In a line."""
    found = sum(p.found_80 is not None for p in planned.power)
    return (
        f"PlannedPower: {count_of(len(planned.runs), 'run')} show {found} of "
        f"{count_of(len(planned.power), 'effect')}, each from a strength of its own"
    )
