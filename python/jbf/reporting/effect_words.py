"""Descriptions of effects, worded for drives, which have no bearing and no load cell."""

from __future__ import annotations

from jbf.models.catalogue import Effect, find_effect
from jbf.models.model import Model
from jbf.models.parameter_units import units_of
from jbf.records.quantities import Quantities
from jbf.reporting.paragraphs import hanging
from jbf.reporting.words import number, value_and_error


def summary_of(effect: Effect, said: Quantities) -> str:
    """Describe an effect in one clause, worded for the kind of machine."""
    if said.motion == "bearing":
        return effect.summary
    inertia = "inertia" if said.motion == "rotary" else "mass"
    own = {
        "sensor_offset": f"offset of {said.sensor}, or a constant {said.noun} "
        "(gravity on an inclined axis, a spring, a counterweight)",
        "sensor_drift": f"zero of {said.sensor} drifts linearly during a run",
        "sensor_lag": f"{said.sensor} or its filter follows the {said.noun} with a time lag",
        "sensor_hysteresis": f"{said.sensor} reads less while the {said.noun} rises than while it "
        "falls: play or friction in the force path",
        "sensor_nonlinearity": (
            f"nonlinear {said.sensor}: it reads a large {said.noun} too large or too small"
        ),
        "inertia": (
            f"{inertia} that the drive accelerates, contained in the reading of {said.sensor}"
        ),
        "drive_compliance": "elasticity of a belt, coupling or shaft between the position sensor "
        "and the load",
        "cogging": f"{said.noun} of the motor that is periodic in the position, also at rest",
    }
    return own.get(effect.name) or _here(effect.summary, said)


def limits_of(effect: Effect, said: Quantities) -> str:
    """Describe the limits of an effect, worded for the kind of machine."""
    if said.motion == "bearing":
        return effect.limits
    return _here(effect.limits, said)


def _here(words: str, said: Quantities) -> str:
    """Replace the terms of a bearing rig in a catalogue text by those of the machine."""
    for of_bearing, here in (
        ("the journal", "the load"),
        ("which gamma represents", "which the viscous friction of the law represents"),
    ):
        words = words.replace(of_bearing, here)
    return words


def effect_lines(model: Model) -> list[str]:
    """Describe each effect of a model of a drive; empty for a rig without [drive]."""
    if model.rig.drive is None or not model.effects:
        return []
    said = model.rig.quantities
    lines = ["", "Meaning of the effects"]
    for name in model.effects:
        lines += hanging(
            f"{name}: ", summary_of(find_effect(name), said) + known_mass(model, name), 4
        )
    return lines


def known_mass(model: Model, effect: str) -> str:
    """Compare the estimated mass or inertia with the value in the rig file.

    Empty if the effect is not `inertia`, or the rig file contains no such value.
    """
    drive = model.rig.drive
    if effect != "inertia" or drive is None or drive.friction == "voltage":
        return ""  # an inertia in V s^2/rad has no counterpart in kg m^2
    known = drive.inertia_kg_m2 if drive.motion == "rotary" else drive.mass_kg
    if known is None:
        return ""
    name = "inertia.m_e"
    unit = units_of(model.law, model.effects, model.rig.quantities)[name]
    value, error = value_and_error(model.parameters[name])
    found = f"{value} +/- {error}" if error else value
    return f"; {found} {unit}, rig file: {number(known, 4)}"
