"""A model's constants, in the words of a language."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from jbf.export.numbers import Group, Numbers

BEARING_FIELDS = ("radius_m", "length_m", "clearance_m", "mass_kg", "viscosity_pa_s")


@dataclass(frozen=True)
class Block:
    """A constant of several lines: how it opens, one line of it, how it closes.

    A closing `;` ends the last line; anything else has a line of its own.
    """

    opening: str
    line: str
    closing: str

    def lines(self, rows: list[dict[str, str]], **words: str) -> list[str]:
        """The lines, each row's words put in."""
        body = [self.line.format(**row) for row in rows]
        if self.closing == ";":
            *body, last = body
            return [self.opening.format(**words), *body, f"{last};"]
        return [self.opening.format(**words), *body, self.closing]


@dataclass(frozen=True)
class Language:
    """How a language writes constants.

    Attributes
    ----------
    infinity
        The number above all others; with a sign before it, below.
    prefix
        What every constant's name begins with.
    bearing, scalar, array
        The sizes of a bearing, one number, the values of a law or an effect.
    about
        A comment above a constant, for people; no lines for none.
    check
        What asks, while the source is compiled, whether the values are within their bounds.
    """

    infinity: str
    prefix: str
    bearing: Block
    scalar: str
    array: Block
    about: Callable[[str], list[str]]
    check: Callable[[Group, str], list[str]]

    def number(self, value: float) -> str:
        """The shortest text that reads back to the same bits."""
        if math.isinf(value):
            return self.infinity if value > 0 else f"-{self.infinity}"
        return repr(float(value))

    def name(self, group: Group) -> str:
        """The constant's name of a law's or an effect's values."""
        return self.prefix + group.name.upper()


def _held_words(why: str | None) -> str:
    """What stands beside a held value: firmware needs the number, who reads it must know that it
    is none. The note may be a user's, so it must neither end a comment nor begin one."""
    if why is None:
        return ""
    said = " ".join(why.split()).replace("*/", "").replace("/*", "")
    return f": held, {said}" if said else ": held"


def constants(numbers: Numbers, language: Language) -> list[str]:
    """The lines with every constant of a model."""
    out = []
    if numbers.bearing is not None:
        sizes = {name: language.number(numbers.bearing[name]) for name in BEARING_FIELDS}  # type: ignore[literal-required]
        sizes["count"] = str(numbers.bearing["count"])
        rows = [{"field": field, "value": value} for field, value in sizes.items()]
        out += language.about("Bearing and lubricant.")
        out += language.bearing.lines(rows)
    out += language.about("Load on one bearing, N.")
    out.append(language.scalar.format(value=language.number(numbers.load_n)))
    for group in numbers.groups:
        name = language.name(group)
        pages = zip(group.page.parameters, group.values, group.held, strict=True)
        rows = [
            {"value": language.number(value), "parameter": p.name + _held_words(why)}
            for p, value, why in pages
        ]
        out += language.about(f"Parameters of the {group.room} {group.name}.")
        out += language.array.lines(rows, name=name, count=str(len(rows)))
        out += language.check(group, name)
    return out
