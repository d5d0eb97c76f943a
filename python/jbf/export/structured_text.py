"""Target `st`: a function block in Structured Text (IEC 61131-3) for a PLC."""

from __future__ import annotations

import ast
from collections.abc import Mapping
from typing import ClassVar

from jbf import _core
from jbf.errors import InputError
from jbf.export.plain_c import check_equations, exact_terms, run_equations
from jbf.export.program import Program, program
from jbf.export.reference import Reference
from jbf.export.syntax import NUMBER, Syntax, local_types, type_of, wrapped
from jbf.export.target import MAIN, Settings, Target, Written
from jbf.models.model import Model

STANDARD = {
    "abs": "ABS",
    "exp": "EXP",
    "log": "LN",
    "sqrt": "SQRT",
    "sin": "SIN",
    "cos": "COS",
    "max": "MAX",
    "min": "MIN",
    "pow": "EXPT",
}
"""Standard functions of IEC 61131-3."""
TYPES = {"real": "LREAL", "time": "LREAL", "int": "DINT", "bool": "BOOL"}
HELPERS = {
    "expm1": """\
FUNCTION {p}_expm1 : LREAL
(* EXP(x) - 1 without cancellation, after Kahan *)
VAR_INPUT
  x : LREAL;
END_VAR
VAR
  u : LREAL;
END_VAR
  u := EXP(x);
  IF u = 1.0 THEN
    {p}_expm1 := x;
  ELSIF u - 1.0 = -1.0 THEN
    {p}_expm1 := -1.0;
  ELSE
    {p}_expm1 := (u - 1.0) * x / LN(u);
  END_IF;
END_FUNCTION""",
    "round": """\
FUNCTION {p}_round : LREAL
(* The nearest integer *)
VAR_INPUT
  x : LREAL;
END_VAR
  {p}_round := LINT_TO_LREAL(LREAL_TO_LINT(x));
END_FUNCTION""",
    "ceil": """\
FUNCTION {p}_ceil : LREAL
(* The least integer that is not below x *)
VAR_INPUT
  x : LREAL;
END_VAR
  {p}_ceil := LINT_TO_LREAL(LREAL_TO_LINT(x));
  IF {p}_ceil < x THEN
    {p}_ceil := {p}_ceil + 1.0;
  END_IF;
END_FUNCTION""",
    "finite": """\
FUNCTION {p}_finite : BOOL
VAR_INPUT
  x : LREAL;
END_VAR
  {p}_finite := x - x = 0.0;
END_FUNCTION""",
    "sum": """\
FUNCTION {p}_sum : LREAL
VAR_INPUT
  terms : ARRAY[0..{last}] OF LREAL;
END_VAR
VAR
  i : DINT;
END_VAR
  {p}_sum := 0.0;
  FOR i := 0 TO {last} DO
    {p}_sum := {p}_sum + terms[i];
  END_FOR;
END_FUNCTION""",
}
"""Functions that the standard lacks."""
BLOCK = """\
FUNCTION_BLOCK {p}
(* {title}
   Call it once a cycle with the motion at that instant. Force in {force}, position in {length},
   speed in {speed}. *)
VAR_INPUT
  reset : BOOL; (* start anew with the motion of this call *)
  dt_s : LREAL; (* time since the last call, s *)
{inputs}
END_VAR
VAR_OUTPUT
  force : LREAL; (* resists the motion *)
END_VAR
VAR
  motion : {p}_motion;
  state : {p}_state;
  started : BOOL;
END_VAR
  motion.time_s := motion.time_s + dt_s;
{assignments}
  IF reset OR NOT started THEN
    motion.time_s := 0.0;
    force := {p}_start(state, motion);
    started := TRUE;
  ELSE
    force := {p}_step(state, motion);
  END_IF;
END_FUNCTION_BLOCK
"""
ABOUT = {
    "velocity": "{speed}",
    "acceleration": "{speed} per s",
    "position": "{length}",
    "weight_offset": "rad; angle of the joints before this one",
    "load": "recorded load",
    "temperature": "C",
}


class StructuredText(Syntax):
    """Syntax of Structured Text."""

    equal = "="
    words: ClassVar[Mapping[str, str]] = {
        "and": "AND",
        "or": "OR",
        "not": "NOT ",
        "True": "TRUE",
        "False": "FALSE",
    }
    assignment = "{target} := {value};"
    branches: ClassVar[Mapping[str, str]] = {
        "if": "IF {} THEN",
        "elif": "ELSIF {} THEN",
        "else": "ELSE",
        "end": "END_IF;",
    }
    loop = ("FOR {name} := {low} TO {count} - 1 DO", "END_FOR;")

    def __init__(self, prefix: str) -> None:
        self.prefix = prefix
        self.integers: set[str] = set()

    def _number(self, value: float) -> str:
        if isinstance(value, int):
            return str(value)
        mantissa, e, power = repr(value).partition("e")
        # A real literal has a decimal point.
        return (mantissa if "." in mantissa else f"{mantissa}.0") + e.upper() + power

    def _call(self, name: str, arguments: list[ast.expr]) -> str:
        texts = [self.expression(argument) for argument in arguments]
        if name in ("real", "time"):
            return f"DINT_TO_LREAL({texts[0]})" if texts[0] in self.integers else f"({texts[0]})"
        if name == "int":
            return f"LREAL_TO_DINT({texts[0]})"
        known = STANDARD.get(name) or f"{self.prefix}_{name}"
        return f"{known}({', '.join(texts)})"

    def type_name(self, name: str) -> str:
        """Name of a type."""
        return TYPES.get(name) or f"{self.prefix}_{name.lower()}"

    def function(self, node: ast.FunctionDef, made: Program) -> str:
        """Text of a function; one without a value returns TRUE."""
        name = f"{self.prefix}_{node.name}"
        sections: dict[str, list[str]] = {"VAR_IN_OUT": [], "VAR_INPUT": [], "VAR": []}
        for argument in node.args.args:
            kind, changed = type_of(argument.annotation)
            section = "VAR_IN_OUT" if changed else "VAR_INPUT"
            sections[section].append(f"{argument.arg} : {self.type_name(kind)};")
        local = local_types(node)
        self.integers = {n for n, kind in local.items() if kind == "int"}
        sections["VAR"] = [f"{n} : {self.type_name(kind)};" for n, kind in local.items()]
        sections["VAR CONSTANT"] = self._constants(node, made)
        self.leave = f"{name} := {{value}}; RETURN;"
        result = "bool" if node.returns is None else type_of(node.returns)[0]
        assert result in NUMBER
        about = ast.get_docstring(node)
        return "\n".join(
            [
                f"FUNCTION {name} : {TYPES[result]}",
                *([f"(* {about} *)"] if about else []),
                *(line for title, lines in sections.items() for line in _section(title, lines)),
                *self.block(node.body),
                *([f"  {name} := TRUE;"] if node.returns is None else []),
                "END_FUNCTION",
            ]
        )

    def _constants(self, node: ast.FunctionDef, made: Program) -> list[str]:
        """Declarations of the constants that a function uses."""
        used = {n.id for n in ast.walk(node) if isinstance(n, ast.Name)}
        lines = []
        for name, value in made.constants.items():
            if name not in used:
                continue
            if isinstance(value, tuple):
                cells = ", ".join(map(self._number, value))
                lines.append(f"{name} : ARRAY[0..{len(value) - 1}] OF LREAL := [{cells}];")
            else:
                lines.append(f"{name} : LREAL := {self._number(value)};")
        return lines


def _section(title: str, lines: list[str]) -> list[str]:
    return [title, *(f"  {line}" for line in lines), "END_VAR"] if lines else []


def _type_of_state(kind: str, length: int) -> str:
    return f"ARRAY[0..{length - 1}] OF {TYPES[kind]}" if length else TYPES[kind]


def _structure(name: str, fields: Mapping[str, str]) -> str:
    lines = [f"    {field} : {kind};" for field, kind in fields.items()]
    return "\n".join([f"TYPE {name} :", "  STRUCT", *lines, "  END_STRUCT", "END_TYPE"])


def st_source(model: Model, made: Program, prefix: str) -> str:
    """Text of the types, functions and the function block of a model."""
    syntax = StructuredText(prefix)
    reals = ("velocity", "acceleration", "position", "weight_offset", "load", "temperature")
    functions = [syntax.function(f, made) for f in made.functions]
    body = "\n".join(functions)
    bristles = f"ARRAY[0..{made.states - 1}] OF LREAL"
    quantities = model.rig.quantities
    units = {
        "force": quantities.force,
        "length": quantities.length,
        "speed": quantities.speed,
    }
    structures = {
        "motion": {"time_s": "LREAL"} | dict.fromkeys(reals, "LREAL"),
        "leg": dict.fromkeys(("direction", "distance", "level0", "level1"), "LREAL"),
        "state": {
            "motion": f"{prefix}_motion",
            **dict.fromkeys(("velocity", "level", "force"), "LREAL"),
            "bristle": bristles,
            **{name: _type_of_state(*kind) for name, kind in made.memory.items()},
        },
    }
    helpers = [
        text.replace("{p}", prefix).replace("{last}", str(made.states - 1))
        for name, text in HELPERS.items()
        if f"{prefix}_{name}(" in body
    ]
    block = BLOCK.format(
        p=prefix,
        title=" + ".join([model.law, *model.effects]),
        inputs="\n".join(f"  {n} : LREAL; (* {ABOUT[n].format(**units)} *)" for n in made.inputs),
        assignments="\n".join(f"  motion.{n} := {n};" for n in made.inputs),
        **units,
    )
    parts = [
        f"(* Written by jbf export {_core.__version__}. *)",
        *(_structure(f"{prefix}_{name}", fields) for name, fields in structures.items()),
        *helpers,
        *functions,
        block,
    ]
    return wrapped("\n\n".join(parts)) + "\n"


def write_st(reference: Reference, settings: Settings) -> Written:
    """Write a model as a function block."""
    model = reference.machine
    check_equations(model, settings, "Structured Text")
    prefix = f"{settings.joint}_friction"
    if "__" in prefix:
        raise InputError(
            problem=f'"{settings.joint}" is not an identifier of IEC 61131-3',
            remedy="give --joint single underscores, none at the end",
        )
    made = program(model)
    # Structured Text has double precision only; its equations are those of the C code.
    force, evaluated_by = run_equations(reference, made)
    notes = (
        "double precision (LREAL); EXPT, LN and EXP of the PLC replace the functions of the core",
    )
    terms = exact_terms(reference, prefix)
    return Written({MAIN: st_source(model, made, prefix)}, terms, force, evaluated_by, notes)


STRUCTURED_TEXT = Target(
    "st", "function block in Structured Text (IEC 61131-3) for a PLC", ".st", write_st, ("joint",)
)
