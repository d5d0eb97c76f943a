"""Target `c`: one C99 file and a header without any library but that of the compiler.

The core is not needed on the target. `equations` has its operations in its order.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from importlib.resources import files as package_files

from jbf import _core
from jbf.arrays import Array
from jbf.errors import InputError
from jbf.export.c_syntax import C
from jbf.export.compensator import EQUATIONS, ROOTS
from jbf.export.compiled import NoCompiler, run_c
from jbf.export.drive_equations import DRIVE
from jbf.export.equations import LAWS
from jbf.export.ledger import Term
from jbf.export.program import KNOWN, Program, program
from jbf.export.reference import BODY, Reference, force_of_effects, instrument
from jbf.export.target import MAIN, Precision, Settings, Target, Written
from jbf.models.model import Model

SLOPES = """
/* Assign the time derivatives of the bristles, and return the force that resists the motion. */
{p}_real {p}_slopes({p}_state *state, const {p}_motion *motion);
"""
FUNCTIONS = ("start", "step")
"""Functions of every model that the header declares."""


@dataclass(frozen=True)
class PlainC:
    """C code of a model, and its force along the runs of a reference.

    Attributes
    ----------
    prefix
        Prefix of all names.
    source, header
        Texts of the files; `STEM` is the name of the header without its suffix.
    program
        Functions and constants of the source.
    terms, force, evaluated_by, notes
        As in `Written`.
    """

    prefix: str
    source: str
    header: str
    program: Program
    terms: tuple[Term, ...]
    force: list[Array]
    evaluated_by: str
    notes: tuple[str, ...]


def plain_c(reference: Reference, settings: Settings, sloped: bool = False) -> PlainC:
    """Write a model as C99 and run it.

    `sloped` adds the time derivatives of the bristles, for a solver.
    """
    model = reference.machine
    check_equations(model, settings, "C")
    prefix = f"{settings.joint}_friction"
    made = program(model, (*FUNCTIONS, "slopes")) if sloped else _program(model, settings)
    source = c_source(made, prefix, settings.precision)
    header = _header(model, made, prefix, settings.precision)
    force, evaluated_by = _run(reference, source, header, prefix, settings.precision)
    terms = exact_terms(reference, f"{prefix}_step")
    note = (
        f"{settings.precision}; math.h replaces the functions of the core, which costs rounding "
        "errors in laws with exp or pow"
    )
    return PlainC(prefix, source, header, made, terms, force, evaluated_by, (note,))


def _program(model: Model, settings: Settings) -> Program:
    """Functions of a model, with those of the compensator of the settings."""
    if settings.compensator is None:
        return program(model)
    if model.rig.quantities.motion != "rotary":
        raise InputError(
            problem="the compensator is for rotary drives, and the rig is linear",
            remedy="export without --compensator",
        )
    driven = [name for name in model.effects if name in DRIVE]
    if driven:
        raise InputError(
            problem=f"the observer is for a rigid drive, and the model has {driven[0]}",
            remedy="export without --compensator, or fit without the effect",
        )
    added = (EQUATIONS, settings.compensator.constants())
    return program(model, (*FUNCTIONS, *ROOTS), added)


def run_equations(reference: Reference, made: Program) -> tuple[list[Array], str]:
    """Force of the equations of a model in double precision, and the program that computed it."""
    source = c_source(made, "model", "double")
    header = _header(reference.machine, made, "model", "double")
    force, evaluated_by = _run(reference, source, header, "model", "double")
    return force, evaluated_by.replace("the compiled C code", "its equations, compiled as C")


def _run(
    reference: Reference, source: str, header: str, prefix: str, precision: Precision
) -> tuple[list[Array], str]:
    """Force of C code without that of the body, and the program that computed it."""
    try:
        whole = run_c(source, header, prefix, precision, reference)
    except NoCompiler:
        return reference.force, "jbf; no C compiler that works was found"
    body = force_of_effects(reference.machine, BODY, reference.motions)
    return [a - b for a, b in zip(whole, body, strict=True)], "the compiled C code"


def write_c(reference: Reference, settings: Settings) -> Written:
    """Write a model as C99."""
    made = plain_c(reference, settings)
    files = {MAIN: made.source, ".h": made.header}
    return Written(files, made.terms, made.force, made.evaluated_by, made.notes)


def exact_terms(reference: Reference, carrier: str) -> tuple[Term, ...]:
    """Terms of an export that has the equations of law and effects, without the instrument."""
    omitted = instrument(reference.model)
    return tuple(
        Term(name, "external", "property of the recording")
        if name in omitted
        else Term(name, "exact", carrier)
        for name in (reference.model.law, *reference.model.effects)
    )


def check_equations(model: Model, settings: Settings, language: str) -> None:
    """Raise an InputError for a law, an effect or a name without a form in a language."""
    settings.check_joint_is_identifier()
    if model.rig.bearing is not None or model.law not in LAWS:
        raise InputError(
            problem=f"the law {model.law} has no form in {language} without the core",
            remedy=f"use a law of {', '.join(LAWS)} on a rig with [drive]; for a built-in law, "
            "jbf export --c writes C for the core",
        )
    for name in model.effects:
        if name not in KNOWN:
            raise InputError(
                problem=f"the effect {name} has no form in {language} without the core",
                remedy="fit without the effect; for a built-in effect, jbf export --c writes C for "
                "the core",
            )
    for name, parameter in model.parameters.items():
        if not math.isfinite(parameter.value):
            raise InputError(
                key=name,
                problem=f"is {parameter.value}, with which its effect vanishes",
                remedy=f"fit without the effect {name.partition('.')[0]}",
            )


def _template(name: str) -> str:
    return package_files("jbf.export").joinpath(name).read_text(encoding="utf-8")


def filled(text: str, prefix: str, precision: str) -> str:
    """Replace the prefix and the floating-point type in a template."""
    return text.replace("{p}", prefix).replace("{real}", precision)


def c_source(made: Program, prefix: str, precision: str) -> str:
    """Text of the C file of a model."""
    template = _template("friction.c.txt")
    text = C(prefix, precision).source(made, (*FUNCTIONS, "slopes", *ROOTS))
    return filled(template.replace("@FUNCTIONS@", text), prefix, precision)


def _header(model: Model, made: Program, prefix: str, precision: Precision) -> str:
    template = _template("friction.h.txt")
    quantities = model.rig.quantities
    names = {f.name for f in made.functions}
    compensated, sloped = bool(names & set(ROOTS)), "slopes" in names
    fields = [("real", "jump", 0)] if compensated else []
    fields += [("real", "slope", made.states)] if sloped else []
    fields += [(kind, name, length) for name, (kind, length) in made.memory.items()]
    syntax = C(prefix, precision)
    for name, text in {
        "TITLE": " + ".join([model.law, *model.effects]),
        "VERSION": _core.__version__,
        "GUARD": prefix.upper() + "_H",
        "STATES": str(made.states),
        "FIELDS": "".join(
            f"  {syntax.type_name(kind)} {name}{f'[{length}]' if length else ''};\n"
            for kind, name, length in fields
        ),
        "SLOPES": SLOPES if sloped else "",
        "COMPENSATOR": _template("compensator.h.txt") if compensated else "",
        "FORCE": quantities.force,
        "LENGTH": quantities.length,
        "SPEED": quantities.speed,
    }.items():
        template = template.replace(f"@{name}@", text)
    return filled(template, prefix, precision)


PLAIN_C = Target(
    "c",
    "C99 file and header without the core, for a controller",
    ".c",
    write_c,
    ("joint", "precision", "compensator"),
)
