"""Evaluation of expressions block by block; units are checked before values are read."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from jbf.arrays import Array
from jbf.errors import InputError, quoted
from jbf.importing.expression import OPEN, Binary, Call, Node, Number, Reference, Signed
from jbf.units.table import ASK, BASES, NONE
from jbf.units.unit import ONE, Unit, parse_unit

Value = Array | float

_RAD = BASES.index("rad")
_FACTOR_TOLERANCE = 1e-6
"""Relative difference below which a number equals the conversion factor of a unit."""


@dataclass(frozen=True)
class Quantity:
    """A value, possibly not yet read, and its unit.

    Attributes
    ----------
    unit_uncertain
        Whether the value contains a factor without a unit, so that its dimensions are uncertain.
    """

    value: Value
    unit: Unit
    unit_uncertain: bool = False


def column_unit(reference: Reference, units: Mapping[str, str]) -> Unit:
    """Unit in which a column is read: that of the expression, otherwise that of the file.

    Parameters
    ----------
    units
        Unit text of each column, from the file.

    Raises
    ------
    InputError
        If the unit is open, ambiguous or unknown.
    """
    text = units.get(reference.column, "") if reference.unit is None else reference.unit
    if text == OPEN:
        raise InputError(
            column=reference.column,
            problem="its unit is open",
            remedy="replace the ? in the map by the unit, such as [mm]",
        )
    if reference.unit is None and text in ASK:
        raise InputError(
            column=reference.column,
            problem=f"the unit {quoted(text)} is ambiguous: {ASK[text]}",
            remedy="write one of them after the column in the map, in square brackets",
        )
    unit = parse_unit(text) if text else ONE
    if unit is None:
        raise InputError(
            column=reference.column,
            problem=f"the unit {quoted(text)} is not known",
            remedy="write one such as [N m], [mm/s], [rpm] after the column in the map",
        )
    return unit


def evaluate(node: Node, columns: Mapping[str, Value], units: Mapping[str, str]) -> Quantity:
    """Evaluate an expression.

    Parameters
    ----------
    columns
        Values of each column in the expression, as in the file.
    units
        Unit text of each column, from the file.

    Raises
    ------
    InputError
        If units are incompatible. The error names no file.
    """
    if isinstance(node, Number):
        if node.unit is None:
            return Quantity(node.value, ONE, unit_uncertain=True)
        unit = parse_unit(node.unit)
        if unit is None:
            raise InputError(
                problem=f"the unit {quoted(node.unit)} of {node.value:g} is not known",
                remedy="write one such as [mm] or [N m/A]",
            )
        return Quantity(node.value, unit)
    if isinstance(node, Reference):
        return Quantity(columns[node.column], column_unit(node, units))
    if isinstance(node, Signed):
        inner = evaluate(node.of, columns, units)
        _no_zero(inner.unit)
        return Quantity(-inner.value, inner.unit, inner.unit_uncertain)
    if isinstance(node, Call):
        return _called(node, evaluate(node.of, columns, units))
    left, right = (evaluate(side, columns, units) for side in (node.left, node.right))
    _no_zero(left.unit)
    _no_zero(right.unit)
    if node.sign in "*/":
        _refuse_double_conversion(node, left, right)
        return _product(node.sign, left, right)
    return _sum(node.sign, left, right)


def converted(quantity: Quantity, target: Unit, key: str) -> Array:
    """Convert values to the unit that the name of a run column implies.

    Raises
    ------
    InputError
        If the values have other dimensions. The error names no file.
    """
    values = np.asarray(quantity.value, dtype=np.float64)
    if quantity.unit.fits(target):
        return quantity.unit.converted(values, target)
    angle = target.dimensions[_RAD] - quantity.unit.dimensions[_RAD]
    if quantity.unit_uncertain and angle == 0:
        # A bare factor is in SI units, and supplies the dimensions that are missing.
        return values * (quantity.unit.in_si / target.in_si)
    if quantity.unit is ONE and not quantity.unit_uncertain:
        problem = f"has no unit, but {target.text} is required"
        remedy = "write a unit in square brackets after each column"
    elif angle and quantity.unit.dimensions[:_RAD] == target.dimensions[:_RAD]:
        problem, remedy = (
            "the unit is ambiguous: revolutions, degrees or radians",
            "give a factor its unit: [mm/rev], [counts/rev]",
        )
    else:
        problem = f"has the unit {quantity.unit.text}, but {target.text} is required"
        remedy = "give columns and factors their units in square brackets"
    raise InputError(key=f"columns.{key}", problem=problem, remedy=remedy)


def _product(sign: str, left: Quantity, right: Quantity) -> Quantity:
    """Multiply or divide two quantities."""
    unit_uncertain = left.unit_uncertain or right.unit_uncertain
    if sign == "*":
        return Quantity(left.value * right.value, left.unit.times(right.unit), unit_uncertain)
    with np.errstate(divide="ignore", invalid="ignore"):
        quotient = np.divide(left.value, right.value)
    return Quantity(quotient, left.unit.times(right.unit, -1), unit_uncertain)


def _sum(sign: str, left: Quantity, right: Quantity) -> Quantity:
    """Add or subtract two quantities; their units must be compatible."""
    unit, value = left.unit, right.value
    if right.unit.dimensions == unit.dimensions:
        value = right.unit.converted(np.asarray(value, dtype=np.float64), unit)
    elif right.unit_uncertain and right.unit.dimensions == NONE:
        # A bare number added to a column with a unit has the unit of the column.
        pass
    elif left.unit_uncertain and left.unit.dimensions == NONE:
        unit = right.unit
    else:
        raise InputError(
            problem=f"{left.unit.text} and {right.unit.text} cannot be added",
            remedy="give each its unit in square brackets, such as [bar]",
        )
    total = left.value + value if sign == "+" else left.value - value
    return Quantity(total, unit, left.unit_uncertain and right.unit_uncertain)


def _called(node: Call, inner: Quantity) -> Quantity:
    """Apply a function to a quantity."""
    _no_zero(inner.unit)
    if node.function == "abs":
        return Quantity(np.abs(inner.value), inner.unit, inner.unit_uncertain)
    if node.function == "sign":
        return Quantity(np.sign(inner.value), ONE)
    if node.function == "sqrt":
        return Quantity(_root(inner), ONE, unit_uncertain=True)
    if inner.unit.dimensions[:_RAD] != NONE[:_RAD] or inner.unit.dimensions[_RAD] not in (0, 1):
        raise InputError(
            problem=f"{node.function} requires an angle, not {inner.unit.text}",
            remedy="use an angle as its argument",
        )
    angle = np.asarray(inner.value) * inner.unit.in_si
    return Quantity(np.sin(angle) if node.function == "sin" else np.cos(angle), ONE)


def _root(inner: Quantity) -> Value:
    """Square root of a dimensionless quantity."""
    if inner.unit.dimensions != NONE:
        raise InputError(
            problem=f"the square root of {inner.unit.text} has no unit",
            remedy="divide by a unit first",
        )
    with np.errstate(invalid="ignore"):
        root: Value = np.sqrt(np.asarray(inner.value) * inner.unit.in_si)
    return root


def _refuse_double_conversion(node: Binary, left: Quantity, right: Quantity) -> None:
    """Raise an InputError if a factor without a unit would repeat the conversion of a unit."""
    for this, other, power in ((left, right, 1), (right, left, 1 if node.sign == "*" else 0)):
        if not (other.unit_uncertain and isinstance(other.value, float) and power):
            continue
        size = this.unit.in_si
        if this.unit.dimensions == NONE or size == 1.0 or other.unit is not ONE:
            continue
        factor = abs(other.value if node.sign == "*" or other is left else 1.0 / other.value)
        if math.isclose(factor, size, rel_tol=_FACTOR_TOLERANCE):
            raise InputError(
                problem=f"the factor {other.value:g} converts {this.unit.text} a second time",
                remedy="remove it: units are converted automatically",
            )


def _no_zero(unit: Unit) -> None:
    """Raise an InputError for a unit with an offset, such as degrees Celsius."""
    if unit.zero:
        raise InputError(
            problem=f"{unit.text} has an offset zero and cannot be used in a calculation",
            remedy="use the temperature column alone",
        )
