"""Parse unit texts and convert values between units.

A text is a product of factors with integer exponents: `N m`, `N·m`, `Nm`, `mm/s`, `m s^-1`,
`kg m²`, `N/(mm s)`. A slash divides by the next factor only.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from fractions import Fraction

from jbf.arrays import Array
from jbf.units.table import (
    ALIASES,
    BASES,
    CELSIUS,
    FAHRENHEIT,
    NONE,
    SUFFIXES,
    TEMPERATURE,
    UNITS,
    Dimensions,
)

_RAD = BASES.index("rad")
_SUPERSCRIPTS = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "0123456789-")
_FACTOR = re.compile(r"([^\W\d_]+|[%‰°º\"]|1)(?:\^?(-?\d+))?", re.UNICODE)
_LONGEST = 40


@dataclass(frozen=True)
class Unit:
    """Size and dimensions of a unit: SI value = reading * ratio * pi^pi + zero.

    Attributes
    ----------
    text
        Original text.
    ratio, pi
        Size in SI units: `ratio * pi ** pi`.
    zero
        SI value of a reading of 0; not 0 for temperatures only.
    """

    text: str
    ratio: Fraction = Fraction(1)
    pi: int = 0
    dimensions: Dimensions = NONE
    zero: Fraction = Fraction(0)

    def times(self, other: Unit, power: int = 1) -> Unit:
        """Return the unit of a product (power 1) or a quotient (-1)."""
        raised = other.raised(power)
        sign = "*" if power > 0 else "/"
        return Unit(
            f"{self.text} {sign} {other.text}",
            self.ratio * raised.ratio,
            self.pi + raised.pi,
            tuple(a + b for a, b in zip(self.dimensions, raised.dimensions, strict=True)),
        )

    def raised(self, power: int) -> Unit:
        """Return the unit raised to an integer power."""
        dimensions = tuple(a * power for a in self.dimensions)
        return Unit(self.text, self.ratio**power, self.pi * power, dimensions)

    def fits(self, target: Unit) -> bool:
        """Return whether values in this unit can be converted to `target`.

        A radian in this unit may be omitted (rad m is m) but not added.
        """
        if self.dimensions == target.dimensions:
            return True
        mine, theirs = list(self.dimensions), list(target.dimensions)
        if theirs[_RAD] == 0:
            mine[_RAD] = 0
        return mine == theirs

    def converted(self, values: Array, to: Unit) -> Array:
        """Convert values in this unit to another unit, with one rounding where possible."""
        if self.zero != to.zero or (self.zero and self.ratio != to.ratio):
            shift = float((self.zero - to.zero) / to.ratio)
            return values * float(self.ratio / to.ratio) + shift
        return scaled(values, self.ratio / to.ratio, self.pi - to.pi)

    @property
    def in_si(self) -> float:
        """Size of the unit in SI units."""
        return float(self.ratio) * math.pi**self.pi


def scaled(values: Array, ratio: Fraction, pi: int = 0) -> Array:
    """Multiply values by a ratio and a power of pi.

    A ratio of 1/n is applied as a division, which rounds once.
    """
    if pi:
        return values * (float(ratio) * math.pi**pi)
    if ratio == 1:
        return values
    if ratio.numerator == 1:
        return values / float(ratio.denominator)
    return values * float(ratio)


ONE = Unit("1")
CELSIUS_UNIT = Unit("°C", dimensions=TEMPERATURE, zero=Fraction("273.15"))
FAHRENHEIT_UNIT = Unit("°F", Fraction(5, 9), 0, TEMPERATURE, Fraction("273.15") - Fraction(160, 9))


def parse_unit(text: str) -> Unit | None:
    """Return the unit of a text, or None if the text is not a known unit."""
    unit_text = " ".join(text.split())
    if not unit_text or len(unit_text) > _LONGEST:
        return None
    low = unit_text.lower()
    if low in CELSIUS:
        return CELSIUS_UNIT
    if low in FAHRENHEIT:
        return FAHRENHEIT_UNIT
    single = _single(unit_text)
    if single is not None:
        return Unit(unit_text, *single)
    try:
        product = _Product(unit_text).parse()
    except ValueError:
        return None
    return Unit(unit_text, product.ratio, product.pi, product.dimensions)


def unit_of_name(name: str) -> tuple[str, Unit] | None:
    """Split a name such as `speed_rpm` or `v_m_s` into its stem and the unit of its suffix.

    Return None if the name does not end in a unit.
    """
    parts = name.split("_")
    for count in (3, 2, 1):
        if len(parts) <= count:
            continue
        suffix_unit = SUFFIXES.get("_".join(parts[-count:]).lower())
        unit = None if suffix_unit is None else parse_unit(suffix_unit)
        if unit is not None:
            return "_".join(parts[:-count]), unit
    return None


def _single(name: str) -> tuple[Fraction, int, Dimensions] | None:
    """Look up a unit by its name, an alias, or its name in another case."""
    if name in UNITS:
        return UNITS[name]
    alias = ALIASES.get(name.lower())
    if alias is not None:
        return UNITS[alias]
    # Another case is accepted if exactly one unit matches.
    alike = {
        entry for name_in_table, entry in UNITS.items() if name_in_table.lower() == name.lower()
    }
    return alike.pop() if len(alike) == 1 and len(name) > 1 else None


class _Product:
    """Recursive-descent parser of factors, slashes, brackets and exponents."""

    def __init__(self, text: str) -> None:
        text = text.replace("·", " ").replace("*", " ").replace("⋅", " ").replace("×", " ")
        # A superscript is an exponent; a hyphen or a full stop between letters is a product.
        text = re.sub(r"([⁰¹²³⁴⁵⁶⁷⁸⁹⁻]+)", lambda m: "^" + m[1].translate(_SUPERSCRIPTS), text)
        self.text = re.sub(r"(?<=[^\W\d_])[-.](?=[^\W\d_])", " ", text)
        self.at = 0

    def parse(self) -> Unit:
        unit = self._product()
        if self.at != len(self.text):
            raise ValueError(self.text)
        return unit

    def _product(self) -> Unit:
        product, power = ONE, 1
        first = True
        while True:
            self._skip()
            if self._take("/"):
                power = -1
                self._skip()
            elif first is False and self.at < len(self.text) and self.text[self.at] == ")":
                return product
            elif self.at == len(self.text):
                if first:
                    raise ValueError(self.text)
                return product
            product = product.times(self._factor(), power)
            power, first = 1, False

    def _factor(self) -> Unit:
        if self._take("("):
            inside = self._product()
            if not self._take(")"):
                raise ValueError(self.text)
            return inside
        match = _FACTOR.match(self.text, self.at)
        if match is None:
            raise ValueError(self.text)
        entry = _single(match[1])
        if entry is None:
            raise ValueError(self.text)
        self.at = match.end()
        return Unit(match[1], *entry).raised(int(match[2] or 1))

    def _skip(self) -> None:
        while self.at < len(self.text) and self.text[self.at] == " ":
            self.at += 1

    def _take(self, sign: str) -> bool:
        if self.text.startswith(sign, self.at):
            self.at += len(sign)
            return True
        return False
