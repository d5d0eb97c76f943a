"""Descriptions of effects, worded for drives, which have no bearing and no load cell."""

from __future__ import annotations

from jbf.models.catalogue import Effect, find_effect
from jbf.models.model import Model
from jbf.models.parameter_units import units_of
from jbf.records.quantities import Quantities
from jbf.reporting.paragraphs import hanging
from jbf.reporting.words import number, value_and_error


def summary_of(effect: Effect, terms: Quantities) -> str:
    """Describe an effect in one clause, worded for the kind of machine."""
    if terms.motion == "bearing":
        return effect.summary
    inertia = "inertia" if terms.motion == "rotary" else "mass"
    descriptions = {
        "sensor_offset": f"offset of {terms.sensor}, or a constant {terms.noun} "
        "(gravity on an inclined axis, a counterweight)",
        "sensor_drift": f"zero of {terms.sensor} drifts linearly during a run",
        "sensor_lag": f"{terms.sensor} or its filter follows the {terms.noun} with a time lag",
        "sensor_hysteresis": f"{terms.sensor} reads less while the {terms.noun} rises than while "
        "it falls: play or friction in the force path",
        "sensor_nonlinearity": (
            f"{terms.sensor} is not linear: it reads a large {terms.noun} too large or too small"
        ),
        "inertia": (
            f"{inertia} that the drive accelerates, contained in the reading of {terms.sensor}"
        ),
        "drive_compliance": "elasticity of a belt, coupling or shaft between the position sensor "
        "and the load",
        "cogging": f"{terms.noun} of the motor that is periodic in the position, also at rest",
    }
    return descriptions.get(effect.name) or _in_terms_of(effect.summary, terms)


def limits_of(effect: Effect, terms: Quantities) -> str:
    """Describe the limits of validity of an effect, worded for the kind of machine."""
    if terms.motion == "bearing":
        return effect.limits
    return _in_terms_of(effect.limits, terms)


def _in_terms_of(words: str, terms: Quantities) -> str:
    """Replace the terms of a bearing rig in a catalogue text by those of the machine."""
    for of_bearing, of_machine in (
        ("the journal", "the load"),
        ("which gamma represents", "which the viscous friction of the law represents"),
    ):
        words = words.replace(of_bearing, of_machine)
    return words


def effect_lines(model: Model) -> list[str]:
    """Describe each effect of a model of a drive; empty for a rig without [drive]."""
    if model.rig.drive is None or not model.effects:
        return []
    quantities = model.rig.quantities
    lines = ["", "Meaning of the effects"]
    for name in model.effects:
        lines += hanging(
            f"{name}: ", summary_of(find_effect(name), quantities) + known_mass(model, name), 4
        )
    return lines


def known_mass(model: Model, effect: str) -> str:
    """Compare the estimated mass or inertia with the value in the rig file, in one clause.

    The text is empty if the effect is not `inertia`, or the rig file contains no such value.
    """
    drive = model.rig.drive
    if effect != "inertia" or drive is None or drive.friction == "voltage":
        return ""  # an inertia in V s^2/rad has no counterpart in kg m^2
    rig_value = drive.inertia_kg_m2 if drive.motion == "rotary" else drive.mass_kg
    if rig_value is None:
        return ""
    name = "inertia.m_e"
    unit = units_of(model.law, model.effects, model.rig.quantities)[name]
    value, error = value_and_error(model.parameters[name])
    estimate = f"{value} +/- {error}" if error else value
    return f"; {estimate} {unit}, rig file: {number(rig_value, 4)}"
