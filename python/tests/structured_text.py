"""Interpreter of Structured Text: the syntax tree of blark, written as Python and run."""

from __future__ import annotations

import copy
import math
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

ZERO = {"LREAL": "0.0", "DINT": "0", "BOOL": "False"}
OPERATORS = {"=": "==", "<>": "!=", "AND": "and", "OR": "or", "NOT": "not"}
STANDARD: dict[str, Callable[..., Any]] = {
    "ABS": abs,
    "EXP": math.exp,
    "LN": math.log,
    "SQRT": math.sqrt,
    "SIN": math.sin,
    "COS": math.cos,
    "EXPT": math.pow,
    "MAX": max,
    "MIN": min,
    "DINT_TO_LREAL": float,
    "LINT_TO_LREAL": float,
    "LREAL_TO_DINT": round,
    "LREAL_TO_LINT": round,
}


def load(source: str) -> dict[str, Any]:
    """Types, functions and function blocks of a source by name; calls of them run the code.

    A type and a function block return a new object. The block's `run(block)` is one cycle.
    """
    from blark.parse import parse_source_code

    parsed = parse_source_code(source)
    assert parsed.exception is None, parsed.exception
    lines = []
    for item in parsed.transform().items:
        kind = type(item).__name__
        lines += {"DataTypeDeclaration": _type, "Function": _function, "FunctionBlock": _block}[
            kind
        ](item)
    scope: dict[str, Any] = {**STANDARD, "new": SimpleNamespace, "copied": copy.deepcopy}
    exec("\n".join(lines), scope)
    return scope


def _declared(declaration: Any) -> tuple[str, str]:
    """Name of a variable, and the Python text of its first value."""
    (variable,) = declaration.variables
    name = str(getattr(variable, "variable", variable).name)
    init = declaration.init
    spec = init.spec
    if hasattr(spec, "subranges"):
        (subrange,) = spec.subranges
        count = int(str(subrange.stop)) - int(str(subrange.start)) + 1
        if init.value is None:
            return name, f"[{ZERO[str(spec.type)]}] * {count}"
        cells = _cells(init.value)
        assert len(cells) == count
        return name, f"[{', '.join(cells)}]"
    kind = str(spec.type)
    if init.value is not None:
        return name, _expression(init.value, set())
    return name, ZERO.get(kind) or f"{kind}()"


def _cells(array: Any) -> list[str]:
    """Elements of the first value of an array, which the parser may have nested."""
    cells: list[str] = []
    for element in array.elements:
        value = getattr(element, "element", element)
        cells += _cells(value) if hasattr(value, "elements") else [_expression(value, set())]
    return cells


def _type(item: Any) -> list[str]:
    structure = item.declaration
    fields = ", ".join(f"{n}={v}" for n, v in map(_declared, structure.declarations))
    return [f"def {structure.name}():", f"    return new({fields})"]


def _sections(item: Any) -> dict[str, list[tuple[str, str]]]:
    sections: dict[str, list[tuple[str, str]]] = {}
    for section in item.declarations:
        found = [_declared(d) for d in section.items]
        sections.setdefault(type(section).__name__, []).extend(found)
    names = [name.lower() for found in sections.values() for name, _ in found]
    assert len(names) == len(set(names)), "names differ in case only"
    return sections


def _function(item: Any) -> list[str]:
    sections = _sections(item)
    by_reference = [n for n, _ in sections.pop("InputOutputDeclarations", [])]
    by_value = [n for n, _ in sections.pop("InputDeclarations", [])]
    lines = [f"def {item.name}({', '.join(by_reference + by_value)}):"]
    lines += [f"    {n} = copied({n})" for n in by_value]
    lines += [f"    {n} = {value}" for found in sections.values() for n, value in found]
    lines += _statements(item.body.statements, set(), str(item.name))
    return [*lines, f"    return {item.name}"]


def _block(item: Any) -> list[str]:
    fields = [field for found in _sections(item).values() for field in found]
    values = ", ".join(f"{n}={value}" for n, value in fields)
    body = _statements(item.body.statements, {n for n, _ in fields}, "")
    return [f"def {item.name}():", f"    return new({values})", "def run(block):", *body]


def _statements(statements: Any, fields: set[str], result: str, depth: int = 1) -> list[str]:
    lines: list[str] = []
    space = "    " * depth

    def inner(node: Any) -> list[str]:
        return _statements(node.statements, fields, result, depth + 1)

    for node in statements:
        kind = type(node).__name__
        if kind == "AssignmentStatement":
            (target,) = node.variables
            value = _expression(node.expression, fields)
            lines.append(f"{space}{_expression(target, fields)} = copied({value})")
        elif kind == "IfStatement":
            lines += [f"{space}if {_expression(node.if_expression, fields)}:"]
            lines += inner(node.statements)
            for other in node.else_ifs:
                lines += [f"{space}elif {_expression(other.if_expression, fields)}:"]
                lines += inner(other.statements)
            if node.else_clause is not None:
                lines += [f"{space}else:", *inner(node.else_clause.statements)]
        elif kind == "ForStatement":
            ends = _expression(node.from_, fields), _expression(node.to, fields)
            name = _expression(node.control, fields)
            lines += [f"{space}for {name} in range({ends[0]}, {ends[1]} + 1):"]
            lines += inner(node.statements)
        elif kind == "ReturnStatement":
            lines.append(f"{space}return {result}")
        else:
            assert kind == "FunctionCallStatement", kind
            lines.append(f"{space}{_call(node, fields)}")
    return lines


def _call(node: Any, fields: set[str]) -> str:
    arguments = [_expression(p.value, fields) for p in node.parameters]
    return f"{_expression(node.name, fields)}({', '.join(arguments)})"


def _expression(node: Any, fields: set[str]) -> str:
    kind = type(node).__name__
    if kind in ("Real", "Integer"):
        return str(node.value)
    if kind == "Boolean":
        return str(node.value).capitalize()
    if kind == "SimpleVariable":
        name = str(node.name)
        return f"block.{name}" if name in fields else name
    if kind == "MultiElementVariable":
        text = _expression(node.name, fields)
        for element in node.elements:
            if type(element).__name__ == "FieldSelector":
                text += f".{element.field.name}"
            else:
                (subscript,) = element.subscripts
                text += f"[{_expression(subscript, fields)}]"
        return text
    if kind == "FunctionCall":
        return _call(node, fields)
    if kind == "ParenthesizedExpression":
        return f"({_expression(node.expr, fields)})"
    if kind == "UnaryOperation":
        operator = OPERATORS.get(str(node.op), str(node.op))
        return f"({operator} {_expression(node.expr, fields)})"
    assert kind == "BinaryOperation", kind
    operator = OPERATORS.get(str(node.op), str(node.op))
    return f"({_expression(node.left, fields)} {operator} {_expression(node.right, fields)})"
