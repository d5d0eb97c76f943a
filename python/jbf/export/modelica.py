"""Target `modelica`: a package with the friction as a block of differential equations."""

from __future__ import annotations

import ast
from collections.abc import Mapping
from typing import ClassVar

from jbf import _core
from jbf.errors import InputError
from jbf.export.plain_c import check_equations, exact_terms
from jbf.export.program import STATES, Program, law_equations, program
from jbf.export.reference import BODY, Reference, force_of_effects
from jbf.export.rumoca_run import NotSimulated, installed, run_rumoca
from jbf.export.syntax import Syntax, local_types, wrapped
from jbf.export.target import MAIN, Settings, Target, Written

BUILT_IN = {"abs", "exp", "log", "sqrt", "sin", "cos", "max", "min", "sign", "sum"}
DEGREES_C = 20.0
"""Temperature of the example, C."""


class Modelica(Syntax):
    """Syntax of algorithms in Modelica."""

    equal = "=="
    words: ClassVar[Mapping[str, str]] = {
        "and": "and",
        "or": "or",
        "not": "not ",
        "True": "true",
        "False": "false",
    }
    assignment = "{target} := {value};"
    branches: ClassVar[Mapping[str, str]] = {
        "if": "if {} then",
        "elif": "elseif {} then",
        "else": "else",
        "end": "end if;",
    }
    loop = ("for {name} in {low}:{count} - 1 loop", "end for;")
    choice = "if {} then {} else {}"
    leave = "force := {value};"

    def _field(self, owner: str, name: str) -> str:
        return {"bristle": "y"}.get(name, name)

    def _index(self, node: ast.expr) -> str:
        if isinstance(node, ast.Constant):
            return str(int(str(node.value)) + 1)
        return f"{self.expression(node)} + 1"

    def _call(self, name: str, arguments: list[ast.expr]) -> str:
        texts = ", ".join(self.expression(argument) for argument in arguments)
        if name == "round":
            return f"floor({texts} + 0.5)"
        assert name in BUILT_IN, name
        return f"{name}({texts})"

    def _power(self, base: ast.expr, exponent: ast.expr) -> str:
        return f"{self.expression(base, 9)} ^ {self.expression(exponent, 9)}"

    def function(self, node: ast.FunctionDef, about: str, inputs: list[str], outputs: str) -> str:
        """Text of a function."""
        local = [f"  {'Integer' if t == 'int' else 'Real'} {n};" for n, t in _locals(node).items()]
        return "\n".join(
            [
                f"function {node.name} {about}",
                *(f"  input Real {name};" for name in inputs),
                outputs,
                "protected",
                *local,
                "algorithm",
                *self.block(node.body),
                f"end {node.name};",
            ]
        )


def _locals(node: ast.FunctionDef) -> dict[str, str]:
    """Local names without the variables of loops, which Modelica declares itself."""
    loops = {n.target.id for n in ast.walk(node) if isinstance(n, ast.For)}  # type: ignore[attr-defined]
    return {name: kind for name, kind in local_types(node).items() if name not in loops}


def package_name(settings: Settings) -> str:
    """Name of the package of a joint."""
    return f"{settings.joint[0].upper()}{settings.joint[1:]}Friction"


def modelica_package(reference: Reference, settings: Settings) -> tuple[str, Program]:
    """Text of the package, and the equations in it."""
    model = reference.machine
    bristles = law_equations(model)[1].states
    made = program(model, ("slopes", "settled") if bristles else ("slopes",))
    syntax = Modelica()
    quantities = model.rig.quantities
    units = {
        "velocity": quantities.speed,
        "acceleration": f"{quantities.length}/s2",
        "position": quantities.length,
        "weight_offset": "rad",
        "temperature": "degC",
        "force": quantities.force.replace(" ", "."),
    }

    def declared(kind: str, name: str, about: str) -> str:
        unit = f'(unit="{units[name]}")' if name in units else ""
        return f'  {kind} Real {name}{unit} "{about}";'

    array = f"[{bristles}]"
    forces = "force, slope" if bristles else "force"
    # States that are not bristles, and the motion.
    given = [*made.rates, *made.inputs]
    arguments = ", ".join(["y", *given] if bristles else given)
    inputs = [f"y{array}", *given] if bristles else given
    functions = {f.name: f for f in made.functions}
    results = f"  output Real force;\n  output Real slope{array};" if bristles else ""
    texts = [
        syntax.function(
            functions["slopes"],
            '"Force that resists the motion, and the time derivatives of the bristles"',
            inputs,
            results or "  output Real force;",
        )
    ]
    if bristles:
        texts.append(
            syntax.function(
                functions["settled"],
                '"Bristles at the start of a motion"',
                given,
                f"  output Real y{array};",
            )
        )
    state = [
        f'  Real y{array} "{quantities.force}; forces of the bristles";',
        f"  Real slope{array};",
    ]
    initial = [f"  {name} = {syntax.expression(start)};" for name, (start, _) in made.rates.items()]
    initial += [f"  y = settled({', '.join(given)});"] if bristles else []
    block = [
        f'block Friction "{" + ".join([model.law, *model.effects])}"',
        *(declared("input", name, f"{name} of the drive") for name in made.inputs),
        declared("output", "force", "force that resists the motion"),
        *(state if bristles else []),
        *(f'  Real {name} "state of the friction";' for name in made.rates),
        *(["initial equation", *initial] if initial else []),
        "equation",
        f"  ({forces}) = slopes({arguments});" if bristles else f"  force = slopes({arguments});",
        *(["  der(y) = slope;"] if bristles else []),
        *(f"  der({name}) = {syntax.expression(rate)};" for name, (_, rate) in made.rates.items()),
        "end Friction;",
    ]
    constants = []
    for name, value in made.constants.items():
        if isinstance(value, tuple):
            cells = ", ".join(map(repr, value))
            constants.append(f"constant Real {name}[{len(value)}] = {{{cells}}};")
        else:
            constants.append(f"constant Real {name} = {value!r};")
    name = package_name(settings)
    lines = [
        f'package {name} "Written by jbf export {_core.__version__}"',
        *constants,
        *texts,
        *block,
        *_example(reference, made.inputs),
        f"end {name};",
    ]
    body = "\n".join(lines).splitlines()
    text = "\n".join([body[0], *(f"  {line}" for line in body[1:-1]), body[-1], ""])
    return wrapped(text) + "\n", made


def _example(reference: Reference, inputs: tuple[str, ...]) -> list[str]:
    """Model with a sine motion at the top speed of the runs."""
    median = {
        "load": [run.load_n for run in reference.runs],
        "temperature": [run.temperature_c for run in reference.runs],
    }
    values = {
        "velocity": "top * sin(omega * time)",
        "position": "top / omega * (1.0 - cos(omega * time))",
        "acceleration": "top * omega * cos(omega * time)",
        "weight_offset": "0.0",
        "load": repr(float(median["load"][0][0]) if median["load"][0] is not None else 0.0),
        "temperature": repr(DEGREES_C),
    }
    return [
        'model Example "Friction along a sine motion"',
        "  Friction friction;",
        f"  parameter Real top = {reference.top_speed:.6g};",
        "  parameter Real omega = 6.283185307179586;",
        "equation",
        *(f"  friction.{name} = {values[name]};" for name in inputs),
        "end Example;",
    ]


def write_modelica(reference: Reference, settings: Settings) -> Written:
    """Write a model as a Modelica package."""
    model = reference.machine
    check_equations(model, settings, "Modelica")
    for term in (model.law, *model.effects):
        if term in STATES and not STATES[term].solvable:
            raise InputError(
                problem=f"the state of {term} switches and is not a differential equation",
                remedy="fit without it, or export with --to fmu2 or fmu3 for Co-Simulation",
            )
    text, made = modelica_package(reference, settings)
    name = package_name(settings)
    force, evaluated_by = reference.force, "jbf, same equations"
    if installed():
        try:
            whole = run_rumoca(text, name, made.inputs, reference)
            body = force_of_effects(model, BODY, reference.motions)
            force = [a - b for a, b in zip(whole, body, strict=True)]
            evaluated_by = "the package, simulated by Rumoca"
        except NotSimulated as reason:
            evaluated_by += f"; Rumoca: {reason}"
    notes = [f"save the file as {name}.mo; needs no library"]
    if not law_equations(model)[1].states:
        notes.append(
            "friction without bristles jumps at zero speed: for a joint that moves freely fit "
            "lugre, or add the effect presliding"
        )
    terms = exact_terms(reference, f"{name}.Friction")
    return Written({MAIN: text}, terms, force, evaluated_by, tuple(notes))


MODELICA = Target(
    "modelica",
    "Modelica package with the friction as a block of differential equations",
    ".mo",
    write_modelica,
    ("joint",),
)
