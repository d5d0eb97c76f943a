"""Formatting of numbers and of the differences between models as text.

Numbers have a few significant digits; a value and its error end at the same decimal.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from jbf.models.parameter_value import ParameterValue

BASE_LAW = "base law"


def number(value: float, digits: int = 3) -> str:
    """Format a number with the given significant digits, without an exponent if that is short."""
    if value == 0.0 or not math.isfinite(value):
        return f"{value:g}"
    size = math.floor(math.log10(abs(value)))
    if -4 <= size < 6:
        return f"{value:.{max(digits - 1 - size, 0)}f}"
    return f"{value:.{digits - 1}e}"


def measured(value: float, stderr: float | None) -> tuple[str, str]:
    """Format a value and its error to the same decimal, the second digit of the error.

    The error is empty if it is unknown.
    """
    if stderr is None or not math.isfinite(stderr) or stderr <= 0.0 or not math.isfinite(value):
        return number(value, 5), ""
    decimals = 1 - math.floor(math.log10(stderr))
    if abs(value) >= 1e7 or decimals > 8:
        return f"{value:.4e}", f"{stderr:.1e}"
    places = max(decimals, 0)
    return f"{round(value, decimals):.{places}f}", f"{round(stderr, decimals):.{places}f}"


def value_and_error(p: ParameterValue) -> tuple[str, str]:
    """Format value and standard error of a parameter; a held parameter is marked, without error."""
    if p.held:
        return f"held at {number(p.value, 5)}", ""
    return measured(p.value, p.stderr)


def percent(value: ParameterValue) -> str:
    """Format the standard error as a percentage of the value, `0.46 %`; empty if undefined."""
    if value.stderr is None or value.value == 0.0 or not math.isfinite(value.value):
        return ""
    return f"{number(100.0 * abs(value.stderr / value.value), 2)} %"


def step_words(models: Sequence[Sequence[str]], index: int) -> str:
    """Describe model `index` of a sequence: effects that it adds or removes, or the base law."""
    effects = models[index]
    if index == 0:
        return f"{BASE_LAW} + {', '.join(effects)}" if effects else BASE_LAW
    before = models[index - 1]
    new = [e for e in effects if e not in before]
    removed = [e for e in before if e not in effects]
    return ", ".join([f"+ {e}" for e in new] + [f"- {e}" for e in removed]) or "refitted"
