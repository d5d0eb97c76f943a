"""Laws and effects that the page offers for a rig, and the units of its quantities."""

from __future__ import annotations

from typing import Any

from jbf.errors import InputError
from jbf.models.catalogue import effects, find_effect, laws, reason_not_applicable
from jbf.models.chain import check_rig, default_law_of_diagnosis
from jbf.models.vocabulary import AUTO
from jbf.records.quantities import BEARING
from jbf.records.rig import Rig
from jbf.reporting.catalogue_text import effect_page
from jbf.reporting.effect_words import summary_of


def first_law(rig: Rig) -> str:
    """Initial base law for a rig.

    The default law of a diagnosis, or `stribeck` if the data of a bearing are incomplete.
    """
    law = default_law_of_diagnosis(rig)
    if law == AUTO:
        return law
    try:
        check_rig(rig, law)
    except InputError:
        return "stribeck"
    return law


def laws_for(rig: Rig | None) -> list[dict[str, Any]]:
    """Base laws in the order in which the page offers them: usable ones before unusable ones.

    Each has a name, a summary, and the reason why the rig does not permit it, or None.
    """
    usable = [{"name": AUTO, "summary": "selected from the data by a diagnosis", "refused": None}]
    unusable: list[dict[str, Any]] = []
    for law in laws().values():
        entry = {"name": law.name, "summary": law.summary, "refused": None}
        try:
            if rig is not None:
                check_rig(rig, law.name)
        except InputError as error:
            unusable.append({**entry, "refused": error.problem})
        else:
            usable.append(entry)
    return [*usable, *unusable]


def effects_for(law: str, rig: Rig | None) -> list[dict[str, Any]]:
    """Effects with their summaries, and the reason why the law excludes them, or None.

    The summaries are worded for the kind of machine.
    """
    quantities = BEARING if rig is None else rig.quantities
    return [
        {
            "name": page.name,
            "summary": summary_of(page, quantities),
            "refused": reason_not_applicable(page, law),
        }
        for page in effects().values()
    ]


def effect_text(name: str) -> str:
    """Equation, source, limits and parameters of an effect, as `jbf effects NAME` prints them."""
    return effect_page(find_effect(name))


def units_of_rig(rig: Rig) -> dict[str, str]:
    """Units and terms of the quantities of a rig, for the labels of the page."""
    quantities = rig.quantities
    return {
        "force": quantities.force,
        "speed": quantities.speed,
        "place": "m" if rig.drive is not None and rig.drive.motion == "linear" else "rad",
        "velocity": quantities.velocity,
        "friction": quantities.friction,
        "noun": quantities.noun,
    }
