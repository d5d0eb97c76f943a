"""Parser for column expressions: `Torque [Nm] / 0.0127`, `p [bar] * 3.1 [cm^2]`.

    sum     = product { ("+" | "-") product }
    product = signed { ("*" | "/") signed }
    signed  = ("-" | "+") signed | item
    item    = number [unit] | column [unit] | function "(" sum ")" | "(" sum ")"

A column is written as in the header of the file, complete (unit included) or without its unit. The
longest name that fits is used, so that names may contain blanks, slashes and brackets. A name in
back quotes is taken literally. A unit in square brackets after a column is the unit in which it is
read, whatever the header states; after a number, it is the unit of the number. The parser evaluates
nothing outside this grammar.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

from jbf.errors import InputError, did_you_mean, quoted

FUNCTIONS = ("abs", "sign", "sqrt", "sin", "cos")
OPEN = "?"
"""Placeholder in unit brackets, or in place of a value, that the user must replace."""

_NUMBER = re.compile(r"\d+(?:\.\d*)?(?:[eE][+-]?\d+)?|\.\d+(?:[eE][+-]?\d+)?")
_UNIT = re.compile(r"\s*\[([^\[\]]*)\]")
_WORD = re.compile(r"[^\W\d]\w*")
_DEEPEST = 50


@dataclass(frozen=True)
class Number:
    """A number, and the unit that follows it, if any."""

    value: float
    unit: str | None


@dataclass(frozen=True)
class Reference:
    """A column in an expression, and the unit stated after it, if any."""

    column: str
    unit: str | None


@dataclass(frozen=True)
class Signed:
    """Negation of an operand."""

    of: Node


@dataclass(frozen=True)
class Binary:
    """Two operands and an operator."""

    sign: Literal["+", "-", "*", "/"]
    left: Node
    right: Node


@dataclass(frozen=True)
class Call:
    """A function of one operand."""

    function: str
    of: Node


Node = Number | Reference | Signed | Binary | Call


def references(node: Node) -> list[Reference]:
    """All column references of an expression, from left to right."""
    if isinstance(node, Reference):
        return [node]
    if isinstance(node, Binary):
        return references(node.left) + references(node.right)
    return references(node.of) if isinstance(node, Signed | Call) else []


def written(name: str) -> str:
    """Name of a column as it must be written in an expression (quoted if necessary)."""
    return f"`{name}`"


def parse_expression(text: str, names: Mapping[str, str], columns: Sequence[str] = ()) -> Node:
    """Parse an expression into a tree.

    Parameters
    ----------
    names
        Permitted names, and the column that each denotes.
    columns
        Columns to suggest if a name is unknown; the keys of `names` by default.

    Raises
    ------
    InputError
        If the text is not an expression, or names an unknown column. The error names no file.
    """
    return _Parser(text, names, columns or list(names)).parse()


class _Parser:
    """Recursive-descent parser of column expressions; `at` is the index of the next character."""

    def __init__(self, text: str, names: Mapping[str, str], columns: Sequence[str]) -> None:
        self.text = text
        self.names = names
        self.columns = columns
        self.longest_first = sorted((n for n in names if n), key=len, reverse=True)
        self.at = 0
        self.depth = 0

    def parse(self) -> Node:
        tree = self._sum()
        self._skip()
        if self.at < len(self.text):
            raise self._wrong(f"{quoted(self.text[self.at :])} is not understood")
        return tree

    def _sum(self) -> Node:
        self.depth += 1
        if self.depth > _DEEPEST:
            raise self._wrong("has too many brackets")
        tree = self._product()
        while sign := self._one_of("+-"):
            tree = Binary(sign, tree, self._product())  # type: ignore[arg-type]
        self.depth -= 1
        return tree

    def _product(self) -> Node:
        tree = self._signed()
        while sign := self._one_of("*/"):
            tree = Binary(sign, tree, self._signed())  # type: ignore[arg-type]
        return tree

    def _signed(self) -> Node:
        minus = False
        while True:
            # A name may begin with a sign and then takes precedence.
            if self._longest_name() is None and (sign := self._one_of("+-")):
                minus ^= sign == "-"
                continue
            item = self._item()
            return Signed(item) if minus else item

    def _item(self) -> Node:
        self._skip()
        if self.at == len(self.text):
            raise self._wrong("ends where a column or a number is expected")
        if self.text[self.at] == "`":
            return self._in_back_quotes()
        name = self._longest_name()
        number = _NUMBER.match(self.text, self.at)
        if name is not None and (number is None or len(name) > len(number[0])):
            self.at += len(name)
            return Reference(self.names[name], self._unit())
        if number is not None:
            self.at = number.end()
            return Number(float(number[0]), self._unit())
        if self._one_of("("):
            return self._closed(self._sum())
        word = _WORD.match(self.text, self.at)
        if word is not None and word[0] in FUNCTIONS:
            self.at = word.end()
            if self._one_of("("):
                return Call(word[0], self._closed(self._sum()))
            self.at = word.start()
        raise self._no_column(self.text[self.at :] if word is None else word[0])

    def _in_back_quotes(self) -> Node:
        end = self.text.find("`", self.at + 1)
        if end < 0:
            raise self._wrong("a back quote is not closed")
        name = self.text[self.at + 1 : end]
        if name not in self.names:
            raise self._no_column(name)
        self.at = end + 1
        return Reference(self.names[name], self._unit())

    def _closed(self, inside: Node) -> Node:
        if not self._one_of(")"):
            raise self._wrong("a bracket is not closed")
        return inside

    def _longest_name(self) -> str | None:
        """Longest column name at the current position that does not end within a word."""
        self._skip()
        rest = self.text[self.at :]
        for name in self.longest_first:
            if rest.startswith(name):
                after = rest[len(name) : len(name) + 1]
                if not (_is_word(name[-1]) and _is_word(after)):
                    return name
        return None

    def _unit(self) -> str | None:
        match = _UNIT.match(self.text, self.at)
        if match is None:
            return None
        self.at = match.end()
        return match[1].strip()

    def _one_of(self, signs: str) -> str | None:
        self._skip()
        if self.at < len(self.text) and self.text[self.at] in signs:
            self.at += 1
            return self.text[self.at - 1]
        return None

    def _skip(self) -> None:
        while self.at < len(self.text) and self.text[self.at].isspace():
            self.at += 1

    def _no_column(self, word: str) -> InputError:
        problem = f"{quoted(self.text)}: the file has no column {quoted(word.strip())}"
        return InputError(problem=problem, remedy=did_you_mean(word, self.columns))

    def _wrong(self, problem: str) -> InputError:
        remedy = "write columns and numbers with + - * / and brackets, units as [N m] after them"
        return InputError(problem=f"{quoted(self.text)} {problem}", remedy=remedy)


def _is_word(sign: str) -> bool:
    return sign.isalnum() or sign == "_"
