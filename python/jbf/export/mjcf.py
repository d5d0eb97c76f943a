"""Target `mjcf`: elements of a MuJoCo joint, as an include file and as a complete test model."""

from __future__ import annotations

import math
import re
import xml.etree.ElementTree as ET
from dataclasses import replace

from jbf import _core
from jbf.arrays import Array
from jbf.errors import InputError
from jbf.export.joint_elements import Elements, JointForm
from jbf.export.joint_form import joint_form
from jbf.export.ledger import Term
from jbf.export.mujoco_run import installed_version, run_mujoco
from jbf.export.reference import Reference
from jbf.export.target import MAIN, Settings, Target, Written, xml_text
from jbf.models.model import Model

DCMOTOR = (3, 7, 0)
"""First version with `dcmotor` and with polynomial damping."""
PASSIVE_DCMOTOR = (4, 0, 0)
"""First version in which a `dcmotor` without input may have no motor constant."""
SPRINGYIELD = (4, 0, 0)
"""First version with `springyield`."""
TIMESTEP_S = 0.0005
"""Time step of the test model, s."""
STIFF_CONSTRAINT = {
    "solreffriction": "0.001 1",
    "solimpfriction": "0.9999 0.9999 0.001 0.5 2",
}
"""Constraint of `frictionloss` with the least creep below the friction level.

MuJoCo raises the time constant to two time steps. With its defaults a loaded joint creeps a
thousand times as fast, and a sliding one stops twice as late.
"""
LUGRE = {
    "stiffness": "sigma_0",
    "damping": "sigma_1",
    "coulomb": "F_c",
    "static": "F_s",
    "stribeck": "v_s",
}
"""Parameters of a bristle by the names of `lugre`, in its order."""
NEGLIGIBLE_MOTOR = {"motorconst": "1e-6", "resistance": "1e6"}
"""Electrical values of a `dcmotor` whose torque and back-EMF are negligible."""


def version_of(text: str) -> tuple[int, ...]:
    """Parse a version of MuJoCo, such as `3.7.0`."""
    found = re.match(r"\d+(\.\d+){0,2}(?!\w)", text)
    if found is None:
        raise InputError(problem=f'"{text}" is not a version of MuJoCo', remedy="write it as 4.0.0")
    parts = [int(part) for part in found[0].split(".")]
    return tuple(parts + [0] * (3 - len(parts)))


def write_mjcf(reference: Reference, settings: Settings) -> Written:
    """Write the elements of a MuJoCo joint."""
    version = version_of(settings.mujoco)
    motor = version >= DCMOTOR
    elements = Elements(motor, motor, version >= SPRINGYIELD, motor)
    form, terms = joint_form(reference, elements)
    model = reference.model
    include = ET.Element("mujocoinclude")
    sections = _sections(model, form, settings.joint, version)
    include.extend(sections)
    test = ET.Element("mujoco", model=f"{settings.joint}_friction")
    ET.SubElement(test, "compiler", angle="radian")
    option = {"timestep": _text(TIMESTEP_S), "gravity": "0 0 0", "integrator": "implicitfast"}
    ET.SubElement(test, "option", option)
    test.append(sections[0])
    body = ET.SubElement(ET.SubElement(test, "worldbody"), "body", name=f"{settings.joint}_body")
    kind = "hinge" if model.rig.quantities.motion == "rotary" else "slide"
    # The moved inertia is that of the body: MuJoCo scales the constraint of `frictionloss` of a
    # slide joint by the mass of the body alone.
    joint = {"name": settings.joint, "class": _class(settings.joint), "type": kind}
    ET.SubElement(body, "joint", {**joint, "axis": "0 0 1", "armature": "0"})
    moved = _text(_armature(model) or 1.0)
    ET.SubElement(body, "inertial", pos="0 0 0", mass=moved, diaginertia=" ".join([moved] * 3))
    test.extend(sections[1:])
    files = {MAIN: xml_text(include), "_test.xml": xml_text(test)}
    force, evaluated_by = _force(form, files["_test.xml"], version, reference)
    return Written(
        files,
        _terms(terms, form, model),
        force,
        evaluated_by,
        _notes(form, version, kind == "hinge"),
    )


def _force(
    form: JointForm, test_model: str, version: tuple[int, ...], reference: Reference
) -> tuple[list[Array], str]:
    """Force of the elements along the runs: in MuJoCo if it is installed and new enough."""
    installed = installed_version()
    if installed is not None and version_of(installed) >= version:
        force = run_mujoco(test_model, TIMESTEP_S, reference)
        if force is not None:
            return force, f"MuJoCo {installed}, time step {1e3 * TIMESTEP_S:g} ms"
    return form.force(reference), "jbf, same equations"


def _class(joint: str) -> str:
    return f"{joint}_friction"


def _text(value: float) -> str:
    return f"{value:.9g}"


def _armature(model: Model) -> float:
    found = model.parameters.get("inertia.m_e")
    return 0.0 if found is None else max(found.value, 0.0)


def _joint(model: Model, form: JointForm) -> dict[str, str]:
    """Attributes of the joint."""
    attributes: dict[str, str] = {}
    if form.level > 0.0:
        attributes |= {"frictionloss": _text(form.level), **STIFF_CONSTRAINT}
    if any(form.damping):
        used = form.damping[:1] if not any(form.damping[1:]) else form.damping
        attributes["damping"] = " ".join(map(_text, used))
    if _armature(model):
        attributes["armature"] = _text(_armature(model))
    return attributes


def _sections(
    model: Model, form: JointForm, joint: str, version: tuple[int, ...]
) -> list[ET.Element]:
    """Top-level elements: defaults, actuators, tendons."""
    defaults = ET.Element("default")
    inner = ET.SubElement(defaults, "default", {"class": _class(joint)})
    ET.SubElement(inner, "joint", _joint(model, form))
    sections = [defaults]
    springs = _springs(form)
    if springs:
        tendons = ET.Element("tendon")
        for number, (stiffness, level) in enumerate(springs):
            # The threshold is a displacement, and the tendon is at rest at any position.
            fixed = ET.SubElement(
                tendons,
                "fixed",
                name=f"{joint}_spring_{number}",
                stiffness=_text(stiffness),
                springlength="0 0",
                springyield=_text(level / stiffness),
            )
            ET.SubElement(fixed, "joint", joint=joint, coef="1")
        sections.append(tendons)
    motors = _motors(model, form)
    if motors:
        actuators = ET.Element("actuator")
        passive = {"input": "none", "motorconst": "0", "resistance": "1"}
        for name, attributes in motors.items():
            electrical = passive if version >= PASSIVE_DCMOTOR else NEGLIGIBLE_MOTOR
            ET.SubElement(
                actuators,
                "dcmotor",
                {"name": f"{joint}_{name}", "joint": joint, **electrical, **attributes},
            )
        sections.append(actuators)
    return sections


def _springs(form: JointForm) -> list[tuple[float, float]]:
    if not form.springs:
        return []
    names = ("F_c", "sigma_0", "exponent")
    return _core.maxwell_slip_elements([*(form.springs[name] for name in names), 0.0])


def _motors(model: Model, form: JointForm) -> dict[str, dict[str, str]]:
    """Attributes of the actuators, by name."""
    motors = {}
    if form.bristle:
        motors["bristle"] = {"lugre": " ".join(_text(form.bristle[k]) for k in LUGRE.values())}
    for name in form.cogging:
        amplitude, poles, phase = _wave(model, name)
        motors[name] = {"cogging": f"{_text(amplitude)} {_text(poles)} {_text(phase)}"}
    return motors


def _wave(model: Model, name: str) -> tuple[float, float, float]:
    """Amplitude, periods per radian or metre, and phase of a torque that acts on the joint.

    jbf states the force that resists the motion, MuJoCo the force that drives it.
    """
    a, pitch, phase = (
        model.parameters[f"{name}.{parameter}"].value for parameter in ("A", "pitch", "phase_rad")
    )
    return a, 2.0 * math.pi / pitch, math.remainder(math.pi - phase, 2.0 * math.pi)


def _terms(terms: tuple[Term, ...], form: JointForm, model: Model) -> tuple[Term, ...]:
    """Terms with the names of the attributes that carry them."""
    values = {}
    carriers = []
    if form.level > 0.0:
        carriers.append("joint frictionloss")
        values["frictionloss"] = form.level
    if any(form.damping):
        carriers.append("joint damping")
        powers = zip(("damping", "damping_2", "damping_3"), form.damping, strict=True)
        values |= {name: value for name, value in powers if value}
    if form.bristle:
        carriers.append("dcmotor lugre")
        values |= {f"lugre_{name}": form.bristle[key] for name, key in LUGRE.items()}
    if form.springs:
        springs = _springs(form)
        carriers.append(f"{len(springs)} tendons with springyield")
        values["tendon_stiffness_sum"] = sum(stiffness for stiffness, _ in springs)
        values["tendon_level_sum"] = sum(level for _, level in springs)
    described = []
    for term in terms:
        if term is terms[0]:
            lost = f"; {term.how}" if term.how else ""
            described.append(replace(term, how=", ".join(carriers) + lost, values=values))
        elif term.name in form.cogging:
            amplitude, poles, phase = _wave(model, term.name)
            carried = {"amplitude": amplitude, "poles": poles, "phase": phase}
            described.append(replace(term, how="dcmotor cogging", values=carried))
        elif term.name == "inertia":
            how = "joint armature; subtract the inertia that your bodies have"
            described.append(replace(term, how=how, values={"armature": _armature(model)}))
        else:
            described.append(term)
    return tuple(described)


def _notes(form: JointForm, version: tuple[int, ...], rotary: bool) -> tuple[str, ...]:
    notes = []
    if form.level > 0.0:
        notes.append(
            "frictionloss is a soft constraint: below its level the joint creeps, with "
            "solreffriction and solimpfriction as written about 1/1000 of the default"
        )
        if not rotary:
            notes.append(
                "MuJoCo scales frictionloss of a slide joint by the mass of the body alone; with a "
                "large armature and a light body the joint creeps faster"
            )
    if form.bristle:
        notes.append(
            "a stiff lugre bristle is stable with Euler, implicit and implicitfast, and can "
            "diverge with RK4"
        )
        if version < PASSIVE_DCMOTOR:
            notes.append("before MuJoCo 4.0 each dcmotor adds a control input; leave it at zero")
    if form.springs:
        notes.append(
            "springyield is exact with Euler, implicit and implicitfast, and wrong with RK4 and "
            "discrete; save mjData.plastic with the state"
        )
    return tuple(notes)


MJCF = Target(
    "mjcf",
    "friction of a MuJoCo joint: include file and test model",
    ".xml",
    write_mjcf,
    ("joint", "mujoco"),
)
