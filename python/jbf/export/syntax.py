"""Writer of equations in a programming language, from the syntax tree of `program`."""

from __future__ import annotations

import ast
import re
from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import ClassVar

BINARY = {ast.Add: ("+", 4), ast.Sub: ("-", 4), ast.Mult: ("*", 5), ast.Div: ("/", 5)}
"""Signs and precedences of the operators, the same in all languages."""
COMPARE = {ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">="}
"""Signs of comparisons, the same in all languages."""
NUMBER = ("real", "time", "int", "bool")
"""Types that are not structures; a local name without annotation is `real`."""


class Syntax(ABC):
    """Syntax of a language: statements and expressions.

    A subclass defines the class attributes, and `_call` and what else differs.

    Attributes
    ----------
    equal
        Sign of a comparison for equality.
    words
        Texts of `and`, `or`, `not`, `True`, `False`.
    assignment
        Template of an assignment.
    branches
        Templates of `if`, `elif`, `else`, `end`.
    loop
        Templates that begin and end a loop over integers from `low`, below `count`.
    leave
        Template of the return of a value.
    choice
        Template of a conditional expression: condition, value if it holds, value otherwise.
    """

    equal: str
    words: ClassVar[Mapping[str, str]]
    assignment: str
    branches: ClassVar[Mapping[str, str]]
    loop: tuple[str, str]
    leave: str = ""
    choice: str = ""

    def _number(self, value: float) -> str:
        return repr(value)

    def _field(self, owner: str, name: str) -> str:
        return f"{owner}.{name}"

    def _index(self, node: ast.expr) -> str:
        return self.expression(node)

    @abstractmethod
    def _call(self, name: str, arguments: list[ast.expr]) -> str:
        """Text of a call of a function."""

    def _value(self, text: str) -> str:
        """Text of a value that is assigned."""
        return text

    def expression(self, node: ast.expr, above: int = 0) -> str:
        """Text of an expression, in parentheses if its operator binds less than `above`."""
        text, binds = self._expression(node)
        return f"({text})" if binds < above else text

    def _expression(self, node: ast.expr) -> tuple[str, int]:
        if isinstance(node, ast.BinOp):
            if isinstance(node.op, ast.Pow):
                return self._power(node.left, node.right), 9
            sign, binds = BINARY[type(node.op)]
            left = self.expression(node.left, binds)
            return f"{left} {sign} {self.expression(node.right, binds + 1)}", binds
        if isinstance(node, ast.UnaryOp):
            if isinstance(node.op, ast.Not):
                return f"{self.words['not']}({self.expression(node.operand)})", 9
            return f"-{self.expression(node.operand, 6)}", 3
        if isinstance(node, ast.BoolOp):
            word = self.words["and" if isinstance(node.op, ast.And) else "or"]
            return f" {word} ".join(self.expression(v, 3) for v in node.values), 1
        if isinstance(node, ast.Compare):
            sign = COMPARE.get(type(node.ops[0]), self.equal)
            sides = self.expression(node.left, 3), self.expression(node.comparators[0], 3)
            return f"{sides[0]} {sign} {sides[1]}", 2
        if isinstance(node, ast.IfExp):
            parts = (self.expression(x, 1) for x in (node.test, node.body, node.orelse))
            return self.choice.format(*parts), 0
        return self._atom(node), 9

    def _atom(self, node: ast.expr) -> str:
        if isinstance(node, ast.Constant):
            if isinstance(node.value, bool):
                return self.words[str(node.value)]
            assert isinstance(node.value, (int, float))
            return self._number(node.value)
        if isinstance(node, ast.Name):
            return node.id
        if isinstance(node, ast.Attribute):
            return self._field(self._atom(node.value), node.attr)
        if isinstance(node, ast.Subscript):
            return f"{self._atom(node.value)}[{self._index(node.slice)}]"
        assert isinstance(node, ast.Call)
        assert isinstance(node.func, ast.Name)
        return self._call(node.func.id, node.args)

    def block(self, statements: list[ast.stmt], indent: int = 1) -> list[str]:
        """Lines of statements."""
        lines: list[str] = []
        for statement in statements:
            lines += self._statement(statement, indent)
        return lines

    def _statement(self, node: ast.stmt, indent: int) -> list[str]:
        space = "  " * indent
        if isinstance(node, (ast.Assign, ast.AnnAssign)) and node.value is not None:
            return [
                space
                + self._assign(
                    node.targets[0] if isinstance(node, ast.Assign) else node.target,
                    self.expression(node.value),
                )
            ]
        if isinstance(node, ast.AugAssign):
            sign, binds = BINARY[type(node.op)]
            target_text = self._atom(node.target)
            value = f"{target_text} {sign} {self.expression(node.value, binds + 1)}"
            return [space + self._assign(node.target, value)]
        if isinstance(node, ast.If):
            return self._if(node, indent)
        if isinstance(node, ast.For):
            assert isinstance(node.target, ast.Name)
            assert isinstance(node.iter, ast.Call)
            *first, count = node.iter.args
            low = self.expression(first[0]) if first else "0"
            begin, end = self.loop
            begin = begin.format(name=node.target.id, low=low, count=self.expression(count))
            return [space + begin, *self.block(node.body, indent + 1), space + end]
        if isinstance(node, ast.Return):
            assert node.value is not None
            return [space + self.leave.format(value=self.expression(node.value))]
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Call):
            return [f"{space}{self.expression(node.value)};"]
        return []  # a declaration or a docstring

    def _assign(self, target: ast.expr, value: str) -> str:
        return self.assignment.format(target=self._atom(target), value=self._value(value))

    def _power(self, base: ast.expr, exponent: ast.expr) -> str:
        return self._call("pow", [base, exponent])

    def _if(self, node: ast.If, indent: int, keyword: str = "if") -> list[str]:
        space = "  " * indent
        lines = [space + self.branches[keyword].format(self.expression(node.test))]
        lines += self.block(node.body, indent + 1)
        rest = node.orelse
        if len(rest) == 1 and isinstance(rest[0], ast.If):
            lines += self._if(rest[0], indent, "elif")
            return lines
        if rest:
            lines += [space + self.branches["else"], *self.block(rest, indent + 1)]
        return [*lines, space + self.branches["end"]]


def wrapped(text: str, width: int = 100) -> str:
    """Break long lines after a comma or before an operator."""
    lines = []
    for line in text.splitlines():
        indent = len(line) - len(line.lstrip()) + 4
        while len(line) > width:
            places = [m.end() for m in re.finditer(r",(?= )| (?=(?:[-+*/]|&&|AND|and) )", line)]
            place = max((p for p in places if indent < p <= width), default=None)
            if place is None:
                break
            lines.append(line[:place].rstrip())
            line = " " * indent + line[place:].lstrip()
        lines.append(line)
    return "\n".join(lines)


def type_of(annotation: ast.expr | None) -> tuple[str, bool]:
    """Type of an annotation, and whether the function changes the argument."""
    if isinstance(annotation, ast.Subscript):
        return type_of(annotation.slice)[0], True
    return annotation.id if isinstance(annotation, ast.Name) else "real", False


def local_types(function: ast.FunctionDef | list[ast.stmt]) -> dict[str, str]:
    """Types of the local names of a function or of statements, in the order of their appearance."""
    statements = function.body if isinstance(function, ast.FunctionDef) else function
    arguments = function.args.args if isinstance(function, ast.FunctionDef) else []
    found: dict[str, str] = {}
    for node in (node for statement in statements for node in walk_in_order(statement)):
        if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
            found.setdefault(node.target.id, type_of(node.annotation)[0])
        elif isinstance(node, ast.For) and isinstance(node.target, ast.Name):
            found.setdefault(node.target.id, "int")
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            found.setdefault(node.id, "real")
    for argument in arguments:
        found.pop(argument.arg, None)
    return found


def walk_in_order(node: ast.AST) -> list[ast.AST]:
    """Return the nodes of a syntax tree, depth first."""
    nodes = [node]
    for child in ast.iter_child_nodes(node):
        nodes += walk_in_order(child)
    return nodes
