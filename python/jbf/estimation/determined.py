"""The rule that decides whether the runs determine a parameter, with its notes.

A parameter that is not identifiable is held. Its value is used for prediction only, and is not an
estimate of the parameter; the note states the reason.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Mapping

import numpy as np

from jbf.estimation.jumps import active_effects
from jbf.models.catalogue import Parameter

HELD = "held fixed"
"""Note of a parameter that was not fitted."""
STATED = "stated, not fitted: given, or taken from the runs"
"""Note of a number that is not a fitted parameter."""
NEVER_MOVED = "never moved: these runs do not depend on it"
NOT_SEPARATE = "not separately known: another parameter does the same in these runs"
NO_EFFECT = "at its null: no effect"
AT_BOUND = 1e-6
"""Tolerance within which a value counts as at its bound.

It is a fraction of the logarithmic distance between the bounds, or of the value or its error. It is
a numerical tolerance.
"""
ONE_SIDED = 2.0
"""Standard errors added to the value of a scale for its upper limit. It concerns the text only."""


def undetermined(
    page: Parameter, value: float, error: float, *, moved: bool = True, separate: bool = True
) -> str | None:
    """Why the runs did not determine a fitted parameter; None if they did.

    Parameters
    ----------
    value, error
        Value and standard error in the parameter's unit; the error is nan if it is unknown.
    moved
        Whether anything in these runs depends on the parameter.
    separate
        Whether the parameter can be distinguished from all other parameters.
    """
    if not moved:
        return NEVER_MOVED
    note = bound_note(page, value, error)
    if note is None and not separate:
        note = NOT_SEPARATE
    return note or _larger_than_itself(page, value, error)


def bound_note(page: Parameter, value: float, error: float) -> str | None:
    """Return a note if a value is at one of its bounds, otherwise None."""
    for side, bound, wish in (("lower", page.lower, "less"), ("upper", page.upper, "more")):
        if _near(page, value, bound, error):
            return f"at its {side} bound {bound:g}: the runs ask for {wish}"
    return None


def _near(page: Parameter, value: float, bound: float, error: float) -> bool:
    """Whether a value is at a bound.

    A linear parameter is compared with its own size and error. The distance between its bounds is
    often many times the value of any machine.
    """
    if page.log:
        off = abs(np.log(value) - np.log(bound))
        return bool(off < AT_BOUND * (np.log(page.upper) - np.log(page.lower)))
    sizes = [abs(value), abs(bound), error if math.isfinite(error) else 0.0]
    return abs(value - bound) <= AT_BOUND * max(sizes)


def _larger_than_itself(page: Parameter, value: float, error: float) -> str | None:
    """Return a note if the error of a scale exceeds its value, else None.

    A scale has no sign, so such an error leaves its size undetermined. A signed parameter may
    be zero within its error.
    """
    if not (page.log or page.lower == 0.0) or not error > abs(value):
        return None
    said = f"its error, {error:.2g}, is larger than itself: these runs "
    most = value + ONE_SIDED * error
    # For a logarithmic parameter with such an error, no interval holds on either side.
    if page.log or most >= page.upper:
        return f"{said}do not tell its size"
    return f"{said}tell only that it is below {most:.2g}"


def idle_effects(
    effects: Collection[str],
    pages: Mapping[str, Parameter],
    values: Iterable[float],
    errors: Mapping[str, float] | None = None,
    fixed: Collection[str] = (),
) -> tuple[str, ...]:
    """Effects that a fit left at their null, where they change nothing.

    Parameters
    ----------
    pages, values
        Catalogue entries by full parameter name, and values in the same order.
    errors
        Standard errors by full name, where they are known.
    fixed
        Names of parameters that were not fitted.
    """
    errors = errors or {}
    snapped = []
    for (name, page), value in zip(pages.items(), values, strict=True):
        there = at_null(page, value, errors.get(name, math.nan), fixed=name in fixed)
        snapped.append(page.null if there and page.null is not None else math.nan)
    active = active_effects(effects, pages, snapped)
    return tuple(name for name in effects if name not in active)


def at_null(page: Parameter, value: float, error: float = math.nan, *, fixed: bool = False) -> bool:
    """Whether a value is at its parameter's null.

    A fit stops at a null that is a bound, or at the bound next to an infinite null. A null between
    the bounds does not stop a fit: an estimate there is an ordinary estimate with an error.
    """
    if page.null is None or fixed:
        return value == page.null
    if page.lower < page.null < page.upper:
        return False
    bound = page.lower if page.null <= page.lower else page.upper
    return value == page.null or _near(page, value, bound, error)
