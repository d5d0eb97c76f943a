"""Whether runs determined a parameter: the one rule, in numbers and words.

What they did not determine is held. Its value is what predicts, and no answer to how large the
parameter is; the note says why.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Mapping

import numpy as np

from jbf.estimation.jumps import active_effects
from jbf.models.catalogue import Parameter

HELD = "held fixed"
"""The note of a parameter that was not fitted."""
STATED = "stated, not fitted: given, or taken from the runs"
"""The note of a number that no fit finds."""
NEVER_MOVED = "never moved: these runs do not depend on it"
NOT_SEPARATE = "not separately known: another parameter does the same in these runs"
NO_EFFECT = "at its null: no effect"
AT_BOUND = 1e-6
"""A value is at its bound where it is off it by less than this share of the width in the
logarithm, or of its own size or error."""
ONE_SIDED = 2.0
"""So many standard errors above its value a scale may still be."""


def undetermined(
    page: Parameter, value: float, error: float, *, moved: bool = True, separate: bool = True
) -> str | None:
    """Why the runs did not determine a fitted parameter; None where they did.

    Parameters
    ----------
    value, error
        In the parameter's unit; the error is nan where there is none.
    moved
        Whether anything in these runs depends on it.
    separate
        Whether no other parameter does the same.
    """
    if not moved:
        return NEVER_MOVED
    note = bound_note(page, value, error)
    if note is None and not separate:
        note = NOT_SEPARATE
    return note or _larger_than_itself(page, value, error)


def bound_note(page: Parameter, value: float, error: float) -> str | None:
    """That a value stands at one of its bounds, if it does."""
    for side, bound, wish in (("lower", page.lower, "less"), ("upper", page.upper, "more")):
        if _near(page, value, bound, error):
            return f"at its {side} bound {bound:g}: the runs ask for {wish}"
    return None


def _near(page: Parameter, value: float, bound: float, error: float) -> bool:
    """A linear parameter is judged by its own size and error, not by the width between its bounds,
    which is often many times what any machine has."""
    if page.log:
        off = abs(np.log(value) - np.log(bound))
        return bool(off < AT_BOUND * (np.log(page.upper) - np.log(page.lower)))
    sizes = [abs(value), abs(bound), error if math.isfinite(error) else 0.0]
    return abs(value - bound) <= AT_BOUND * max(sizes)


def _larger_than_itself(page: Parameter, value: float, error: float) -> str | None:
    """Of a scale, which has no sign to lose: an error above its value leaves nothing of it. A
    signed parameter may well be nought, give or take."""
    if not (page.log or page.lower == 0.0) or not error > abs(value):
        return None
    said = f"its error, {error:.2g}, is larger than itself: these runs "
    most = value + ONE_SIDED * error
    # Of a logarithm so far out the error is no interval on either side.
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
    """The effects that a fit left at their null, where they change nothing.

    Parameters
    ----------
    pages, values
        By the parameters' full names, in one order.
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
    """Whether a value stands at its parameter's null.

    A fit comes to a null that is a bound, or to the bound next to an infinite one, and stops there.
    A null between the bounds stops no fit: what it finds there it found, with an error.
    """
    if page.null is None or fixed:
        return value == page.null
    if page.lower < page.null < page.upper:
        return False
    bound = page.lower if page.null <= page.lower else page.upper
    return value == page.null or _near(page, value, bound, error)
