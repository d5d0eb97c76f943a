"""Parameter bounds that a user imposes on a fit, and detection of estimates at a bound."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import replace

import numpy as np

from jbf.errors import InputError
from jbf.models.catalogue import Parameter, find_parameter
from jbf.records.arguments import by_name, described
from jbf.records.toml_file import number

AT_BOUND = 1e-6
"""Relative tolerance within which a value counts as at its bound. It is a fraction of the
logarithmic distance between the bounds, or of the value or its error."""
Bounds = dict[str, tuple[float, float]]
"""Full parameter name to its lower and upper bound."""


def checked_bounds(
    bounds: Mapping[str, tuple[float, float]] | None, pages: Mapping[str, Parameter]
) -> Bounds:
    """Resolve the parameter names of user-given bounds, and limit them to the catalogue's bounds.

    Raises
    ------
    InputError
        A name is unknown, or an interval is empty or outside the bounds of the catalogue.
    """
    checked = {}
    for name, given in ({} if bounds is None else by_name(bounds, "bounds")).items():
        full = find_parameter(name, pages)
        pair = list(given) if isinstance(given, Iterable) and not isinstance(given, str) else []
        if len(pair) != 2:
            raise InputError(
                key=f"bounds.{full}",
                problem=f"is {described(given)}",
                remedy="give a pair: (low, high)",
            )
        page = pages[full]
        low = max(number(pair[0], f"bounds.{full}"), page.lower)
        high = min(number(pair[1], f"bounds.{full}"), page.upper)
        if not low < high:
            raise InputError(
                key=f"bounds.{full}",
                problem=f"({pair[0]:g}, {pair[1]:g}) does not overlap {page.lower:g} "
                f"to {page.upper:g}",
                remedy="give low < high; `fixed` holds a parameter at a value",
            )
        checked[full] = (low, high)
    return checked


def bounded_pages(pages: Mapping[str, Parameter], bounds: Bounds) -> dict[str, Parameter]:
    """Return catalogue entries by parameter name, with the bounds imposed by the user.

    Starting values are clipped to the bounds, and a null outside of them no longer applies. An
    angle is not wrapped, because wrapping could leave the bounds.
    """
    bounded = dict(pages)
    for name, (low, high) in bounds.items():
        page = pages[name]
        starts = tuple(dict.fromkeys(min(max(x, low), high) for x in page.starts))
        null = page.null if page.null is not None and low <= page.null <= high else None
        bounded[name] = replace(page, lower=low, upper=high, starts=starts, null=null, period=None)
    return bounded


def bound_note(page: Parameter, value: float, error: float) -> str | None:
    """Return the note of a result for a parameter value at one of its bounds, otherwise None."""
    for side, bound, wish in (("lower", page.lower, "less"), ("upper", page.upper, "more")):
        if at_bound(page, value, bound, error):
            return f"at its {side} bound {bound:g}: the best fit requires {wish}"
    return None


def at_bound(page: Parameter, value: float, bound: float, error: float) -> bool:
    """Whether a value is at a bound.

    For a linear parameter, the tolerance is relative to the value and the standard error. The
    distance between the bounds of the catalogue is often much larger than any realistic value.
    """
    if page.log:
        distance = abs(np.log(value) - np.log(bound))
        return bool(distance < AT_BOUND * (np.log(page.upper) - np.log(page.lower)))
    sizes = [abs(value), abs(bound), error if math.isfinite(error) else 0.0]
    return abs(value - bound) <= AT_BOUND * max(sizes)
