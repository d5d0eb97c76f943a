"""Constants of an exported model, in the syntax of a programming language."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from jbf.export.numbers import Group, Numbers

BEARING_FIELDS = ("radius_m", "length_m", "clearance_m", "mass_kg", "viscosity_pa_s")


@dataclass(frozen=True)
class Block:
    """Template of a multi-line constant: opening, repeated line, closing.

    A closing `;` is appended to the last line; any other closing is a separate line.
    """

    opening: str
    line: str
    closing: str

    def lines(self, rows: list[dict[str, str]], **words: str) -> list[str]:
        """Format the constant with one repeated line per row."""
        body = [self.line.format(**row) for row in rows]
        if self.closing == ";":
            *body, last = body
            return [self.opening.format(**words), *body, f"{last};"]
        return [self.opening.format(**words), *body, self.closing]


@dataclass(frozen=True)
class Language:
    """Syntax of constants in a programming language.

    Attributes
    ----------
    infinity
        Expression for positive infinity; a leading minus yields negative infinity.
    prefix
        Common prefix of all constant names.
    bearing, scalar, array
        Templates of the bearing dimensions, of one number, and of the values of a law or an
        effect.
    about
        Function that returns the comment lines above a constant; may return an empty list.
    check
        Function that returns compile-time checks of the parameter bounds.
    """

    infinity: str
    prefix: str
    bearing: Block
    scalar: str
    array: Block
    about: Callable[[str], list[str]]
    check: Callable[[Group, str], list[str]]

    def number(self, value: float) -> str:
        """Shortest text of a number that is parsed as the same value."""
        if math.isinf(value):
            return self.infinity if value > 0 else f"-{self.infinity}"
        return repr(float(value))

    def name(self, group: Group) -> str:
        """Name of the constant with the values of a law or an effect."""
        return self.prefix + group.name.upper()


def _held_words(why: str | None) -> str:
    """Comment for a value that was held fixed, with the note of the parameter.

    Firmware needs the number, but readers must know that it was not estimated. The note may come
    from a user, so comment delimiters are removed.
    """
    if why is None:
        return ""
    note = " ".join(why.split()).replace("*/", "").replace("/*", "")
    return f": held, {note}" if note else ": held"


def constants(numbers: Numbers, language: Language) -> list[str]:
    """Source lines of all constants of a model in a language."""
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
            {
                "value": language.number(value),
                "parameter": p.name + _held_words(why),
                "field": p.name.lower(),
            }
            for p, value, why in pages
        ]
        out += language.about(f"Parameters of the {group.room} {group.name}.")
        out += language.array.lines(rows, name=name, count=str(len(rows)), module=group.name)
        out += language.check(group, name)
    return out
