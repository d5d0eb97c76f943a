"""Bounds of parameters that a user imposes on a fit."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace

from jbf.errors import InputError
from jbf.models.catalogue import Parameter, find_parameter
from jbf.records.arguments import by_name, described
from jbf.records.toml_file import number

Bounds = dict[str, tuple[float, float]]
"""Full parameter name to its lower and upper bound."""


def checked_bounds(
    bounds: Mapping[str, tuple[float, float]] | None, known: Mapping[str, Parameter]
) -> Bounds:
    """Resolve parameter names, and limit each interval to the bounds of the catalogue.

    Raises
    ------
    InputError
        A name is unknown, or an interval is empty or outside the bounds of the catalogue.
    """
    found = {}
    for name, given in ({} if bounds is None else by_name(bounds, "bounds")).items():
        full = find_parameter(name, known)
        pair = list(given) if isinstance(given, Iterable) and not isinstance(given, str) else []
        if len(pair) != 2:
            raise InputError(
                key=f"bounds.{full}",
                problem=f"is {described(given)}",
                mend="give a pair: (low, high)",
            )
        page = known[full]
        low = max(number(pair[0], f"bounds.{full}"), page.lower)
        high = min(number(pair[1], f"bounds.{full}"), page.upper)
        if not low < high:
            raise InputError(
                key=f"bounds.{full}",
                problem=f"({pair[0]:g}, {pair[1]:g}) is empty within {page.lower:g} to "
                f"{page.upper:g}",
                mend="give low < high; `fixed` holds a parameter at a value",
            )
        found[full] = (low, high)
    return found


def bounded_page(page: Parameter, low: float, high: float) -> Parameter:
    """Return a parameter within bounds: starting values are moved inside.

    A null outside the bounds no longer applies. An angle is not wrapped, because wrapping could
    leave the bounds.
    """
    starts = tuple(dict.fromkeys(min(max(x, low), high) for x in page.starts))
    null = page.null if page.null is not None and low <= page.null <= high else None
    return replace(page, lower=low, upper=high, starts=starts, null=null, period=None)


def bounded_pages(pages: Mapping[str, Parameter], bounds: Bounds) -> dict[str, Parameter]:
    """Return parameters by name, those with bounds within them."""
    return {
        name: bounded_page(page, *bounds[name]) if name in bounds else page
        for name, page in pages.items()
    }
