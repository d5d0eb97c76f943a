"""Targets `urdf`, `sdf` and `isaac`: joint dynamics of robot descriptions and of Isaac Lab."""

from __future__ import annotations

import json
import xml.etree.ElementTree as ET
from dataclasses import replace

from jbf.export.joint_elements import Elements, JointForm
from jbf.export.joint_form import joint_form
from jbf.export.ledger import Term
from jbf.export.reference import Reference
from jbf.export.target import MAIN, Settings, Target, Written, xml_text
from jbf.models.model import Model

EVALUATED = "jbf, same equations"
LEVEL_AND_DAMPING = Elements()


def _form(
    reference: Reference, elements: Elements = LEVEL_AND_DAMPING
) -> tuple[JointForm, tuple[Term, ...], list[str]]:
    """Dry level and damping of a joint, the terms, and a note with the units."""
    form, terms = joint_form(reference, elements)
    quantities = reference.model.rig.quantities
    units = f"friction in {quantities.force}, damping in {quantities.unit('N s/m')}"
    return form, terms, [units]


def _carried(terms: tuple[Term, ...], values: dict[str, float]) -> tuple[Term, ...]:
    """Terms whose first one, the law, names the values that carry it."""
    law, *others = terms
    lost = f"; {law.how}" if law.how else ""
    return (replace(law, how=", ".join(values) + lost, values=values), *others)


def _text(value: float) -> str:
    return f"{value:.9g}"


def _rotary(model: Model) -> bool:
    return model.rig.quantities.motion == "rotary"


def write_urdf(reference: Reference, settings: Settings) -> Written:
    """Write the element `<dynamics>` of a URDF joint, and a robot with this joint."""
    form, terms, notes = _form(reference)
    values = {"friction": form.level, "damping": form.damping[0]}
    dynamics = {name: _text(value) for name, value in values.items()}
    robot = ET.Element("robot", name=f"{settings.joint}_friction")
    ET.SubElement(robot, "link", name="base")
    link = ET.SubElement(robot, "link", name="body")
    inertial = ET.SubElement(link, "inertial")
    ET.SubElement(inertial, "mass", value="1")
    moments = dict.fromkeys(("ixx", "iyy", "izz"), "1")
    ET.SubElement(inertial, "inertia", {**moments, "ixy": "0", "ixz": "0", "iyz": "0"})
    joint = ET.SubElement(
        robot,
        "joint",
        name=settings.joint,
        type="continuous" if _rotary(reference.model) else "prismatic",
    )
    ET.SubElement(joint, "parent", link="base")
    ET.SubElement(joint, "child", link="body")
    ET.SubElement(joint, "axis", xyz="0 0 1")
    if not _rotary(reference.model):
        limits = {"lower": "-1000", "upper": "1000", "effort": "1e6", "velocity": "1e3"}
        ET.SubElement(joint, "limit", limits)
    ET.SubElement(joint, "dynamics", dynamics)
    files = {MAIN: xml_text(robot), "_fragment.xml": xml_text(ET.Element("dynamics", dynamics))}
    notes.append("consumers differ: some read damping and ignore friction; URDF has no armature")
    return Written(files, _carried(terms, values), form.force(reference), EVALUATED, tuple(notes))


def write_sdf(reference: Reference, settings: Settings) -> Written:
    """Write the element `<dynamics>` of an SDFormat joint, and a model with this joint."""
    form, terms, notes = _form(reference)
    values = {"friction": form.level, "damping": form.damping[0]}

    def dynamics() -> ET.Element:
        element = ET.Element("dynamics")
        for name, value in values.items():
            ET.SubElement(element, name).text = _text(value)
        return element

    root = ET.Element("sdf", version="1.9")
    model = ET.SubElement(root, "model", name=f"{settings.joint}_friction")
    ET.SubElement(model, "link", name="base")
    ET.SubElement(model, "link", name="body")
    kind = "revolute" if _rotary(reference.model) else "prismatic"
    joint = ET.SubElement(model, "joint", name=settings.joint, type=kind)
    ET.SubElement(joint, "parent").text = "base"
    ET.SubElement(joint, "child").text = "body"
    axis = ET.SubElement(joint, "axis")
    ET.SubElement(axis, "xyz").text = "0 0 1"
    axis.append(dynamics())
    files = {MAIN: xml_text(root), "_fragment.xml": xml_text(dynamics())}
    notes.append("physics engines differ: some read damping and ignore friction")
    return Written(files, _carried(terms, values), form.force(reference), EVALUATED, tuple(notes))


def _static_level(model: Model, dynamic: float) -> float:
    """Static friction level of a model, N or N m, not below the dynamic one.

    It is that of the law, with `coulomb_drag` and the value of `stribeck_excess` at rest.
    """
    p = {name: value.value for name, value in model.parameters.items()}
    law = p["F_c"] + p["F_s_inf"] if "F_s_inf" in p else p.get("F_s", p.get("F_c", 0.0))
    effects = p.get("coulomb_drag.F_d", 0.0) + p.get("stribeck_excess.a", 0.0)
    return max(law + effects, dynamic)


def write_isaac(reference: Reference, settings: Settings) -> Written:
    """Write the friction fields of an actuator of Isaac Lab, as Python and as JSON."""
    settings.check_joint_is_identifier()
    form, terms, notes = _form(reference, Elements(static_level=True))
    model = reference.model
    values = {
        "friction": _static_level(model, form.level),
        "dynamic_friction": form.level,
        "viscous_friction": form.damping[0],
    }
    inertia = model.parameters.get("inertia.m_e")
    armature = {} if inertia is None else {"armature": max(inertia.value, 0.0)}
    law, *others = _carried(terms, values)
    how = "armature; subtract the inertia that your bodies have"
    carried = [replace(t, how=how, values=armature) if t.name == "inertia" else t for t in others]
    fields = values | armature
    rotary = _rotary(model)
    meanings = {
        "friction": ("static friction effort", "N m" if rotary else "N"),
        "dynamic_friction": ("dynamic friction effort", "N m" if rotary else "N"),
        "viscous_friction": ("times the joint velocity", "N m s/rad" if rotary else "N s/m"),
        "armature": ("inertia, without that of the bodies", "kg m^2" if rotary else "kg"),
    }
    lines = [
        f"    {name}={value!r},  # {meanings[name][0]}, {meanings[name][1]}"
        for name, value in fields.items()
    ]
    python = "\n".join(
        [
            "from isaaclab.actuators import ImplicitActuatorCfg",
            "",
            f"{settings.joint.upper()}_ACTUATOR = ImplicitActuatorCfg(",
            f'    joint_names_expr=["{settings.joint}"],',
            "    stiffness=0.0,",
            "    damping=0.0,",
            *lines,
            ")",
            "",
        ]
    )
    entries = {
        name: {"value": value, "unit": meanings[name][1], "meaning": meanings[name][0]}
        for name, value in fields.items()
    }
    files = {MAIN: python, "_values.json": json.dumps(entries, indent=1) + "\n"}
    notes.append(
        "the fields are efforts from Isaac Sim 5.0; in 4.5 friction is a coefficient of the "
        "transmitted force and the others are not applied"
    )
    return Written(files, (law, *carried), form.force(reference), EVALUATED, tuple(notes))


URDF = Target("urdf", "damping and friction of a URDF joint", ".urdf", write_urdf, ("joint",))
SDF = Target("sdf", "damping and friction of an SDFormat joint", ".sdf", write_sdf, ("joint",))
ISAAC = Target(
    "isaac",
    "static, dynamic and viscous friction of an Isaac Lab actuator",
    ".py",
    write_isaac,
    ("joint",),
)
