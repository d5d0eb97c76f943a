"""Target `c`: one C99 file and a header without any library but that of the compiler.

The core is not needed on the target. The fragments of `c_parts` have its operations in its order.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from importlib.resources import files as package_files

import numpy as np
import numpy.typing as npt

from jbf import _core
from jbf.errors import InputError
from jbf.export.c_parts import CONTACT, LAWS, OTHER, PRESLIDING, TRANSMISSION, CLaw
from jbf.export.compiled import NoCompiler, run_c
from jbf.export.ledger import Term
from jbf.export.reference import BODY, Reference, force_of_effects, instrument
from jbf.export.target import MAIN, Settings, Target, Written
from jbf.models.model import Model

Array = npt.NDArray[np.float64]
FUNCTIONS = ("EXP", "EXPM1", "POW", "LOG", "SIN", "COS", "FABS", "ROUND", "CEIL")
"""Functions of math.h that the fragments use, by the name in braces."""


@dataclass(frozen=True)
class PlainC:
    """C code of a model, and its force along the runs of a reference.

    Attributes
    ----------
    prefix
        Prefix of all names.
    source, header
        Texts of the files; `STEM` is the name of the header without its suffix.
    terms, force, evaluated_by, notes
        As in `Written`.
    """

    prefix: str
    source: str
    header: str
    terms: tuple[Term, ...]
    force: list[Array]
    evaluated_by: str
    notes: tuple[str, ...]

    @property
    def source_of_force(self) -> str:
        """Part of the source that computes the force at a motion."""
        return self.source[: self.source.index("/* Motion between two instants")]


def plain_c(reference: Reference, settings: Settings) -> PlainC:
    """Write a model as C99 and run it."""
    model = reference.machine
    _check(model, settings)
    prefix = f"{settings.joint}_friction"
    source = c_source(model, prefix, settings.precision)
    header = _header(model, prefix, settings)
    force, evaluated_by = reference.force, "jbf; no C compiler that works was found"
    try:
        whole = run_c(source, header, prefix, settings.precision, reference)
        body = force_of_effects(model, BODY, reference.motions)
        force = [a - b for a, b in zip(whole, body, strict=True)]
        evaluated_by = "the compiled C code"
    except NoCompiler:
        pass
    omitted = instrument(reference.model)
    terms = [Term(model.law, "exact", f"{prefix}_step")]
    for name in reference.model.effects:
        if name in omitted:
            terms.append(Term(name, "external", "property of the recording"))
        else:
            terms.append(Term(name, "exact", f"{prefix}_step"))
    note = (
        f"{settings.precision}; math.h replaces the functions of the core, which costs rounding "
        "errors in laws with exp or pow"
    )
    return PlainC(prefix, source, header, tuple(terms), force, evaluated_by, (note,))


def write_c(reference: Reference, settings: Settings) -> Written:
    """Write a model as C99."""
    made = plain_c(reference, settings)
    files = {MAIN: made.source, ".h": made.header}
    return Written(files, made.terms, made.force, made.evaluated_by, made.notes)


def _check(model: Model, settings: Settings) -> None:
    settings.check_joint_is_identifier()
    if model.rig.bearing is not None or model.law not in LAWS:
        raise InputError(
            problem=f"the law {model.law} has no form in C without the core",
            remedy=f"use a law of {', '.join(LAWS)} on a rig with [drive]; for a built-in law, "
            "jbf export --c writes C for the core",
        )
    known = {*CONTACT, *OTHER, *TRANSMISSION, "presliding"}
    for name in model.effects:
        if name not in known:
            raise InputError(
                problem=f"the effect {name} has no form in C without the core",
                remedy="fit without the effect; for a built-in effect, jbf export --c writes C for "
                "the core",
            )


def filled(text: str, prefix: str, precision: str) -> str:
    """Replace the names in braces by the prefix and by the functions of math.h."""
    suffix = "f" if precision == "float" else ""
    names = {name: name.lower() + suffix for name in FUNCTIONS} | {"p": prefix, "real": precision}
    return re.sub(r"\{(\w+)\}", lambda m: names.get(m[1], m[0]), text)


def c_source(model: Model, prefix: str, precision: str) -> str:
    """Text of the C file of a model."""
    law = LAWS[model.law]
    bristle = PRESLIDING if "presliding" in model.effects else law
    effects = [name for name in model.effects if name != "presliding"]
    steps = {
        stage: "\n".join(f"  {fragments[name]}" for name in effects if name in fragments)
        for stage, fragments in (
            ("CONTACT", CONTACT),
            ("OTHER", OTHER),
            ("TRANSMISSION", TRANSMISSION),
        )
    }
    template = package_files("jbf.export").joinpath("friction.c.txt").read_text(encoding="utf-8")
    body = template
    for name, text in {
        **steps,
        "FRICTION": law.friction,
        "BRISTLE": _bristle(bristle),
        "HELPERS": bristle.helpers,
        "RESTING": "  state->resting = (state->velocity == R(0.0)) && (motion->velocity == R(0.0));"
        if model.law == "coulomb"
        else "",
        "INNER_STEPS": _inner_steps(model, law, bristle),
    }.items():
        body = body.replace(f"@{name}@", text)
    for name, sign in (("max", ">"), ("min", "<")):
        used = f"{{p}}_{name}(" in body
        text = (
            f"static {{p}}_real {{p}}_{name}({{p}}_real a, {{p}}_real b) {{\n"
            f"  return (a {sign} b) ? a : b;\n}}"
        )
        body = body.replace(f"@{name.upper()}@", text if used else "")
    body = re.sub(r"\n\s*\n\s*\n+", "\n\n", body)
    constants = "\n".join(_constants(model, body))
    text = filled(body.replace("@CONSTANTS@", constants), prefix, precision)
    return re.sub(r"(?m)^[ \t]+$\n", "", text)


def _bristle(bristle: CLaw) -> str:
    """Statements that determine the force of the contact."""
    if not bristle.states:
        return "  state->force = sliding.jump * {p}_sign(v) + sliding.smooth;"
    return f"""\
  if (dt_s > R(0.0)) {{
    {{p}}_leg leg;
    leg.direction = {{p}}_sign(state->velocity + v);
    leg.distance = {{FABS}}(state->velocity + v) * (R(0.5) * dt_s);
    leg.level0 = state->magnitude;
    leg.level1 = magnitude;
    {bristle.bend}
  }} else {{
    {bristle.start}
  }}
  state->force = bent + sliding.smooth;"""


def _inner_steps(model: Model, law: CLaw, bristle: CLaw) -> str:
    longest = min((x.longest_step_s for x in (law, bristle) if x.longest_step_s > 0.0), default=0.0)
    if not longest:
        return "R(1.0)"
    step = f"R({longest})"
    if model.law == "lugre":
        step = f"{{p}}_max({step}, sample_s * R(0.0625))"
    return f"{{p}}_min({{p}}_max({{CEIL}}(dt_s / {step} - R(1e-9)), R(1.0)), R(1e6))"


def _constants(model: Model, body: str) -> list[str]:
    """Declarations of the parameters that a file uses."""
    lines = []
    for dotted, value in model.parameters.items():
        name = dotted.replace(".", "_")
        if re.search(rf"\b{name}\b", body):
            lines.append(f"static const {{p}}_real {name} = R({value.value!r});")
    if model.law == "maxwell_slip":
        names = ("sigma_0", "exponent", "F_v")
        values = [1.0, *(model.parameters[name].value for name in names)]
        springs = _core.maxwell_slip_elements(values)
        for name, column in zip(
            ("spring_stiffness", "spring_share"), zip(*springs, strict=True), strict=True
        ):
            cells = ", ".join(f"R({value!r})" for value in column)
            lines.append(f"static const {{p}}_real {name}[16] = {{{cells}}};")
    return lines


def _header(model: Model, prefix: str, settings: Settings) -> str:
    template = package_files("jbf.export").joinpath("friction.h.txt").read_text(encoding="utf-8")
    quantities = model.rig.quantities
    states = max(LAWS[model.law].states, int("presliding" in model.effects), 1)
    for name, text in {
        "TITLE": " + ".join([model.law, *model.effects]),
        "VERSION": _core.__version__,
        "GUARD": prefix.upper() + "_H",
        "STATES": str(states),
        "FORCE": quantities.force,
        "LENGTH": quantities.length,
        "SPEED": quantities.speed,
    }.items():
        template = template.replace(f"@{name}@", text)
    return filled(template, prefix, settings.precision)


PLAIN_C = Target(
    "c",
    "C99 file and header without the core, for a controller",
    ".c",
    write_c,
)
