"""Writer of equations in C99."""

from __future__ import annotations

import ast
from collections.abc import Mapping
from typing import ClassVar

from jbf.export.program import Program
from jbf.export.syntax import NUMBER, Syntax, local_types, type_of, wrapped

MATH = {
    "exp": "exp",
    "expm1": "expm1",
    "pow": "pow",
    "log": "log",
    "sqrt": "sqrt",
    "sin": "sin",
    "cos": "cos",
    "abs": "fabs",
    "round": "round",
    "ceil": "ceil",
}
"""Functions of math.h."""
SUM = """\
static {p}_real {p}_sum(const {p}_real terms[]) {
  {p}_real total = R(0.0);
  int i;
  for (i = 0; i < @STATES@; i++) {
    total = total + terms[i];
  }
  return total;
}"""
HELPERS = {"sum": SUM} | {
    name: f"static {{p}}_real {{p}}_{name}({{p}}_real x, {{p}}_real y) {{\n"
    f"  return (x {sign} y) ? x : y;\n}}"
    for name, sign in (("max", ">"), ("min", "<"))
}
"""Functions that math.h lacks, or has with another treatment of numbers that are not finite."""


STRUCTURES = ("model", "motion")
"""Fields that are structures."""


class C(Syntax):
    """Syntax of C99."""

    equal = "=="
    words: ClassVar[Mapping[str, str]] = {
        "and": "&&",
        "or": "||",
        "not": "!",
        "True": "1",
        "False": "0",
    }
    assignment = "{target} = {value};"
    branches: ClassVar[Mapping[str, str]] = {
        "if": "if ({}) {{",
        "elif": "}} else if ({}) {{",
        "else": "} else {",
        "end": "}",
    }
    loop = ("for ({name} = {low}; {name} < {count}; {name}++) {{", "}")
    choice = "({}) ? {} : {}"
    leave = "return {value};"

    def __init__(self, prefix: str, precision: str) -> None:
        self.prefix = prefix
        self.suffix = "f" if precision == "float" else ""
        self.pointers: set[str] = set()
        self.structures: set[str] = set()

    def type_name(self, name: str) -> str:
        """Return the name of a type."""
        plain = {"time": "double", "int": "int", "bool": "int"}
        return plain.get(name) or f"{self.prefix}_{name.lower()}"

    def _number(self, value: float) -> str:
        return str(value) if isinstance(value, int) else f"R({value!r})"

    def _field(self, owner: str, name: str) -> str:
        return f"{owner}{'->' if owner in self.pointers else '.'}{name}"

    def _call(self, name: str, arguments: list[ast.expr]) -> str:
        if name in ("real", "time", "int"):
            value = self.expression(arguments[0])
            return f"R({value})" if name == "real" else f"({self.type_name(name)})({value})"
        texts = [self._argument(argument) for argument in arguments]
        if name == "finite":
            return f"isfinite({texts[0]})"
        known = f"{MATH[name]}{self.suffix}" if name in MATH else f"{self.prefix}_{name}"
        return f"{known}({', '.join(texts)})"

    def _argument(self, node: ast.expr) -> str:
        text = self.expression(node)
        if isinstance(node, ast.Attribute):
            return f"&{text}" if node.attr in STRUCTURES else text
        is_value = isinstance(node, ast.Name) and node.id in self.structures
        return f"&{text}" if is_value else text

    def _value(self, text: str) -> str:
        return f"*{text}" if text in self.pointers else text

    def function(self, node: ast.FunctionDef, public: bool) -> str:
        """Text of a function."""
        arguments = []
        self.pointers, self.structures = set(), set()
        for argument in node.args.args:
            kind, changed = type_of(argument.annotation)
            if kind in NUMBER:
                arguments.append(f"{self.type_name(kind)} {argument.arg}")
            else:
                self.pointers.add(argument.arg)
                const = "" if changed else "const "
                arguments.append(f"{const}{self.type_name(kind)} *{argument.arg}")
        local = local_types(node)
        self.structures = {name for name, kind in local.items() if kind not in NUMBER}
        result = "void" if node.returns is None else self.type_name(type_of(node.returns)[0])
        storage = "" if public else "static "
        about = ast.get_docstring(node)
        head = f"{storage}{result} {self.prefix}_{node.name}("
        comment = [f"/* {about} */"] if about and not public else []
        return "\n".join(
            [
                *comment,
                head + ", ".join(arguments) + ") {",
                *(f"  {self.type_name(kind)} {name};" for name, kind in local.items()),
                *(f"  (void){name};" for name in _unused(node)),
                *self.block(node.body),
                "}",
            ]
        )

    def constants(self, program: Program) -> list[str]:
        """Declarations of constants."""
        lines = []
        real = self.type_name("real")
        for name, value in program.constants.items():
            if isinstance(value, tuple):
                cells = ", ".join(f"R({cell!r})" for cell in value)
                lines.append(f"static const {real} {name}[{len(value)}] = {{{cells}}};")
            else:
                lines.append(f"static const {real} {name} = R({value!r});")
        return lines

    def source(self, program: Program, public: tuple[str, ...]) -> str:
        """Return the constants and functions of a program."""
        functions = [self.function(f, f.name in public) for f in program.functions]
        body = "\n\n".join(functions)
        helpers = [
            text.replace("{p}", self.prefix).replace("@STATES@", str(program.states))
            for name, text in HELPERS.items()
            if f"{self.prefix}_{name}(" in body
        ]
        return wrapped("\n\n".join(["\n".join(self.constants(program)), *helpers, *functions]))


def _unused(node: ast.FunctionDef) -> list[str]:
    """Arguments that a function does not use."""
    read = {n.id for n in ast.walk(node) if isinstance(n, ast.Name)}
    return [argument.arg for argument in node.args.args if argument.arg not in read]
