"""Names and units of parameters as a rig's own quantities have them.

A parameter's name in files and in Python carries the catalogue's unit, in newtons and metres. Where
the rig's unit is another, people are shown the name without it (as `jbf.Fit` and `--fix` take it)
and the unit beside it.
"""

from __future__ import annotations

from collections.abc import Mapping

from jbf.models.catalogue import Parameter, find_law, parameters_of
from jbf.records.quantities import Quantities

FORCES = {"presliding.sigma_1_m": "N/m", "stribeck_excess.a": "N", "dwell_stiction.a": "N"}
"""Parameters over the load that a law in newtons, which presses with one newton, has as forces."""
ALONG = ("backlash.gap_rad",)
"""Angles of the drive that are ways on a linear axis."""
OVER_LOAD = ("dry_load_dependence.mu", "zero_load_dependence.k", "viscous_load_dependence.c_s_m")
"""Parameters over a load, which stays one in N (or bar) whatever moves."""


def unit_of(name: str, page: Parameter, law: str, quantities: Quantities) -> str:
    """The unit of a parameter (dotted name) beside a law; `-` of a number without one."""
    if find_law(law).needs_bearing:
        return page.unit
    if quantities.motion == "linear" and name in ALONG:
        return quantities.length
    if quantities.motion == "rotary" and name in OVER_LOAD:
        return quantities.unit("N" if page.unit == "-" else "N s/m") + " over load"
    return quantities.unit(FORCES.get(name, page.unit))


def shown_name(name: str, page: Parameter, unit: str) -> str:
    """The name as it is shown: without its unit where that is not the one it has."""
    return name if unit == page.unit else bare_name(name, page)


def bare_name(name: str, page: Parameter) -> str:
    """The name without the unit at its end: `F_v` of `F_v_n_s_m`."""
    end = page.unit.lower().replace("^", "").replace(" ", "_").replace("/", "_")
    return name.removesuffix(f"_{end}")


def shown(
    law: str, effects: tuple[str, ...], quantities: Quantities
) -> Mapping[str, tuple[str, str]]:
    """For each parameter's full name the one that is shown, and its unit (empty of a number)."""
    found = {}
    for name, page in parameters_of(law, effects).items():
        unit = unit_of(name, page, law, quantities)
        found[name] = shown_name(name, page, unit), "" if unit == "-" else unit
    return found
