"""Units of parameters in the units of a rig."""

from __future__ import annotations

from jbf.models.catalogue import Parameter, find_law, parameters_of
from jbf.records.quantities import Quantities

FORCES = {"presliding.sigma": "N/m", "stribeck_excess.a": "N", "dwell_stiction.a": "N"}
"""Parameters normalized by the load, which are forces in a law in newtons (load of 1 N)."""
DISPLACEMENTS = ("backlash.gap",)
"""Parameters that are angles on a rotary drive and displacements on a linear axis."""
PER_LOAD = ("dry_load_dependence.mu", "zero_load_dependence.k", "viscous_load_dependence.c")
"""Parameters per unit of load; the load is in N (or bar) for every kind of motion."""


def unit_of(name: str, page: Parameter, law: str, quantities: Quantities) -> str:
    """Unit of a parameter (dotted name) in a model with a law; `-` if dimensionless."""
    if find_law(law).needs_bearing:
        return page.unit
    if quantities.motion == "linear" and name in DISPLACEMENTS:
        return quantities.length
    if quantities.motion == "rotary" and name in PER_LOAD:
        return quantities.unit("N" if page.unit == "-" else "N s/m") + " per load"
    return quantities.unit(FORCES.get(name, page.unit))


def units_of(law: str, effects: tuple[str, ...], quantities: Quantities) -> dict[str, str]:
    """Unit of each parameter of a model by its full name; empty if dimensionless."""
    units = {
        name: unit_of(name, page, law, quantities)
        for name, page in parameters_of(law, effects).items()
    }
    return {name: "" if unit == "-" else unit for name, unit in units.items()}
