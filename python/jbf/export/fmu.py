"""Targets `fmu2` and `fmu3`: source-code FMUs around the target `c`."""

from __future__ import annotations

import io
import uuid
import xml.etree.ElementTree as ET
import zipfile
from collections.abc import Iterator, Sequence
from importlib.resources import files as package_files

from jbf import _core
from jbf.export.equations import LAWS
from jbf.export.plain_c import PlainC, filled, plain_c
from jbf.export.program import law_equations, memories
from jbf.export.reference import Reference
from jbf.export.target import MAIN, STEM, Settings, Target, Written, xml_text
from jbf.records.quantities import Quantities

XML = '<?xml version="1.0" encoding="UTF-8"?>\n'
DEFAULT_C = 20.0
"""Temperature before the first input, C."""
_BASE_UNITS: dict[str, dict[str, str]] = {
    "N": {"kg": "1", "m": "1", "s": "-2"},
    "V": {"kg": "1", "m": "2", "s": "-3", "A": "-1"},
    "N.m": {"kg": "1", "m": "2", "s": "-2"},
    "m": {"m": "1"},
    "m/s": {"m": "1", "s": "-1"},
    "m/s2": {"m": "1", "s": "-2"},
    "rad": {"rad": "1"},
    "rad/s": {"rad": "1", "s": "-1"},
    "rad/s2": {"rad": "1", "s": "-2"},
    "degC": {"K": "1", "offset": "273.15"},
}
"""Units of FMI by their exponents of SI base units."""
JUMPING = ("coulomb_drag", "dry_asymmetry", "stribeck_asymmetry", "direction_asymmetry")
"""Effects whose force jumps where the speed changes its sign."""
UNIDENTIFIED = "00000000-0000-0000-0000-000000000000"
"""Identifier in the texts from which the identifier of an FMU is computed."""


def write_fmu2(reference: Reference, settings: Settings) -> Written:
    """Write a model as a source-code FMU for FMI 2.0."""
    return _write(reference, settings, 2)


def write_fmu3(reference: Reference, settings: Settings) -> Written:
    """Write a model as a source-code FMU for FMI 3.0."""
    return _write(reference, settings, 3)


def _write(reference: Reference, settings: Settings, version: int) -> Written:
    made = plain_c(reference, settings, sloped=_continuous(reference))
    archive = _archive(reference, settings, version, made, UNIDENTIFIED)
    identifier = str(uuid.uuid5(uuid.NAMESPACE_OID, "".join(archive.values())))
    archive = _archive(reference, settings, version, made, identifier)
    notes = (
        *made.notes,
        "the FMU contains sources only; most tools compile them on import",
        "the inputs are those at the end of a step: a master that sets them at its beginning "
        "gets the force one step later",
    )
    return Written(
        {MAIN: _zipped(archive)}, made.terms, made.force, made.evaluated_by, tuple(notes)
    )


def _continuous(reference: Reference) -> bool:
    """Whether the force is continuous in speed and states, so that Model Exchange is offered."""
    bristles = law_equations(reference.machine)[1] if reference.machine.law in LAWS else None
    if bristles is None or bristles.states != 1 or not bristles.continuous:
        return False
    if not all(memory.solvable for memory in memories(reference.machine)):
        return False
    return not set(JUMPING) & set(reference.machine.effects)


def _archive(
    reference: Reference, settings: Settings, version: int, made: PlainC, identifier: str
) -> dict[str, str]:
    """Texts of the archive by their paths."""
    inputs = made.program.inputs
    variables = {"force": _unit(reference, "force")} | {n: _unit(reference, n) for n in inputs}
    sloped = "slopes" in {f.name for f in made.program.functions}
    rates = {name: f"{name}_rate" for name in made.program.rates}
    # Fields of the continuous states, and of their time derivatives.
    fields = {"bristle[0]": "slope[0]", **rates} if sloped else {}
    states = ["bristle", *rates] if sloped else []
    template = (
        package_files("jbf.export").joinpath(f"fmi{version}.c.txt").read_text(encoding="utf-8")
    )
    assignments = [
        f"  motion.{name} = ({{p}}_real)now->value[{i}];" for i, name in enumerate(inputs, start=1)
    ]
    defaults = [
        f"  {'c->now.' if version == 2 else 'now->'}value[{i}] = {DEFAULT_C};"
        for i, name in enumerate(inputs, start=1)
        if name == "temperature"
    ]
    for name, text in {
        "COUNT": str(len(variables)),
        "STATES": str(len(states)),
        "CASES": "".join(
            f"  if (i == {i}) {{\n    return &state->{name};\n  }}\n"
            for i, name in enumerate(fields)
            if i > 0
        ),
        "EVALUATED": "\n".join(
            f"  now->value[VALUES + {2 * i + k}] = now->state.{name};"
            for i, pair in enumerate(fields.items())
            for k, name in enumerate(pair)
        ),
        "GUID": identifier,
        "INPUTS": "\n".join(assignments),
        "DEFAULTS": "\n".join(defaults),
    }.items():
        template = template.replace(f"@{name}@", text)
    sources = {
        f"fmi{version}.c": filled(template, made.prefix, settings.precision),
        "model.c": made.source.replace(STEM, "model"),
        "model.h": made.header,
    }
    title = " + ".join([reference.model.law, *reference.machine.effects])
    describe = _description_2 if version == 2 else _description_3
    for name in states:
        variables |= dict.fromkeys((name, f"der({name})"), "")
    archive = {"modelDescription.xml": describe(made.prefix, title, identifier, variables)}
    if version == 3:
        archive["sources/buildDescription.xml"] = _build_description(made.prefix)
        archive["terminalsAndIcons/terminalsAndIcons.xml"] = _terminals(["force", *inputs])
    return archive | {f"sources/{name}": text for name, text in sources.items()}


def _unit(reference: Reference, name: str) -> str:
    """FMI unit of a variable; empty without one."""
    quantities: Quantities = reference.model.rig.quantities
    return {
        "force": quantities.force.replace(" ", "."),
        "velocity": quantities.speed,
        "acceleration": f"{quantities.length}/s2",
        "position": quantities.length,
        "weight_offset": "rad",
        "temperature": "degC",
    }.get(name, "")


def _description_2(prefix: str, title: str, guid: str, variables: dict[str, str]) -> str:
    """Text of modelDescription.xml for FMI 2.0."""
    root = _root(prefix, title, {"fmiVersion": "2.0", "guid": guid})
    saved = {"canGetAndSetFMUstate": "true", "canSerializeFMUstate": "true"}
    kinds = _kinds(variables)
    for kind, attributes in kinds.items():
        simulation = ET.SubElement(root, kind, {"modelIdentifier": prefix, **attributes, **saved})
        sources = ET.SubElement(simulation, "SourceFiles")
        for name in ("fmi2.c", "model.c"):
            ET.SubElement(sources, "File", name=name)
    _add_units(root, variables)
    listed = ET.SubElement(root, "ModelVariables")
    for common, real in _variables(variables):
        # In FMI 2.0 unit and start are attributes of the type, not of the variable.
        if "derivative" in real:
            real["derivative"] = str(int(real["derivative"]) + 1)  # an index that counts from one
        ET.SubElement(ET.SubElement(listed, "ScalarVariable", common), "Real", real)
    structure = ET.SubElement(root, "ModelStructure")
    ET.SubElement(ET.SubElement(structure, "Outputs"), "Unknown", index="1")
    unknown = [1]
    if "ModelExchange" in kinds:
        derivatives = ET.SubElement(structure, "Derivatives")
        for number in _derivatives(variables):
            ET.SubElement(derivatives, "Unknown", index=str(number + 1))
            unknown += [number, number + 1]
    initial = ET.SubElement(structure, "InitialUnknowns")
    for index in unknown:
        ET.SubElement(initial, "Unknown", index=str(index))
    return XML + xml_text(root)


def _kinds(variables: dict[str, str]) -> dict[str, dict[str, str]]:
    """Interfaces that an FMU offers, with their attributes."""
    stepped = {"CoSimulation": {"canHandleVariableCommunicationStepSize": "true"}}
    return {"ModelExchange": {}, **stepped} if _derivatives(variables) else stepped


def _derivatives(variables: dict[str, str]) -> list[int]:
    """Value references of the time derivatives; each follows that of its state."""
    return [i for i, name in enumerate(variables) if name.startswith("der(")]


def _root(prefix: str, title: str, attributes: dict[str, str]) -> ET.Element:
    """Root element of modelDescription.xml."""
    return ET.Element(
        "fmiModelDescription",
        attributes,
        modelName=prefix,
        description=f"Friction of a drive: {title}",
        generationTool=f"jbf {_core.__version__}",
        variableNamingConvention="flat",
    )


def _variables(units: dict[str, str]) -> Iterator[tuple[dict[str, str], dict[str, str]]]:
    """Attributes of each variable, and those of its real type; the first one is the output.

    Parameters
    ----------
    units
        Units of the variables by name; empty without one.
    """
    for reference, (name, unit) in enumerate(units.items()):
        common = {"name": name, "valueReference": str(reference), "variability": "continuous"}
        real = {"unit": unit} if unit else {}
        if reference == 0:
            common |= {"causality": "output", "initial": "calculated"}
            common["description"] = "force that resists the motion"
        elif name.startswith("der("):
            common |= {"causality": "local", "initial": "calculated"}
            common["description"] = "its time derivative"
            real["derivative"] = str(reference - 1)
        elif f"der({name})" in units:
            common |= {"causality": "local", "initial": "calculated"}
            quantity = "force of the bristle" if name == "bristle" else name.replace("_", " ")
            common["description"] = f"{quantity}, a continuous state"
        else:
            common |= {"causality": "input", "description": f"{name} of the drive"}
            real["start"] = str(DEFAULT_C if name == "temperature" else 0.0)
        yield common, real


def _add_units(root: ET.Element, variables: dict[str, str]) -> None:
    units = ET.SubElement(root, "UnitDefinitions")
    for name in dict.fromkeys(unit for unit in variables.values() if unit):
        defined = ET.SubElement(units, "Unit", name=name)
        ET.SubElement(defined, "BaseUnit", _BASE_UNITS[name])


def _description_3(prefix: str, title: str, token: str, variables: dict[str, str]) -> str:
    """Text of modelDescription.xml for FMI 3.0."""
    root = _root(prefix, title, {"fmiVersion": "3.0", "instantiationToken": token})
    saved = {"canGetAndSetFMUState": "true", "canSerializeFMUState": "true"}
    kinds = _kinds(variables)
    for kind, attributes in kinds.items():
        ET.SubElement(root, kind, {"modelIdentifier": prefix, **attributes, **saved})
    _add_units(root, variables)
    listed = ET.SubElement(root, "ModelVariables")
    for common, real in _variables(variables):
        ET.SubElement(listed, "Float64", common | real)
    ET.SubElement(
        listed,
        "Float64",
        name="time",
        valueReference=str(len(variables)),
        causality="independent",
        variability="continuous",
        unit="s",
    )
    units = root.find("UnitDefinitions")
    assert units is not None
    ET.SubElement(ET.SubElement(units, "Unit", name="s"), "BaseUnit", s="1")
    structure = ET.SubElement(root, "ModelStructure")
    ET.SubElement(structure, "Output", valueReference="0")
    unknown = [0]
    if "ModelExchange" in kinds:
        for number in _derivatives(variables):
            ET.SubElement(structure, "ContinuousStateDerivative", valueReference=str(number))
            unknown += [number - 1, number]
    for number in unknown:
        ET.SubElement(structure, "InitialUnknown", valueReference=str(number))
    return XML + xml_text(root)


def _build_description(prefix: str) -> str:
    """Text of buildDescription.xml for FMI 3.0."""
    root = ET.Element("fmiBuildDescription", fmiVersion="3.0")
    configuration = ET.SubElement(root, "BuildConfiguration", modelIdentifier=prefix)
    sources = ET.SubElement(configuration, "SourceFileSet", language="C99")
    for name in ("fmi3.c", "model.c"):
        ET.SubElement(sources, "SourceFile", name=name)
    return XML + xml_text(root)


def _terminals(names: Sequence[str]) -> str:
    """Text of terminalsAndIcons.xml: one terminal with the force and the motion of the drive."""
    root = ET.Element("fmiTerminalsAndIcons", fmiVersion="3.0")
    terminal = ET.SubElement(
        ET.SubElement(root, "Terminals"),
        "Terminal",
        name="drive",
        matchingRule="bus",
        description="motion of the drive, and the force that resists it",
    )
    for name in names:
        ET.SubElement(
            terminal,
            "TerminalMemberVariable",
            variableName=name,
            memberName=name,
            variableKind="signal",
        )
    return XML + xml_text(root)


def _zipped(archive: dict[str, str]) -> bytes:
    """ZIP archive of texts, the same bytes for the same texts."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as zipped:
        for name, text in archive.items():
            entry = zipfile.ZipInfo(name)
            entry.external_attr = 0o644 << 16
            entry.compress_type = zipfile.ZIP_DEFLATED
            zipped.writestr(entry, text)
    return buffer.getvalue()


FMU_SETTINGS = ("joint", "precision")
FMU2 = Target("fmu2", "source-code FMU for FMI 2.0", ".fmu", write_fmu2, FMU_SETTINGS)
FMU3 = Target("fmu3", "source-code FMU for FMI 3.0", ".fmu", write_fmu3, FMU_SETTINGS)
