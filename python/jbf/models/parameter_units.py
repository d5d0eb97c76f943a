"""Names and units of parameters in the quantities of a rig.

The name of a parameter in files and in Python carries the unit of the catalogue, in newtons and
metres. If the unit of the rig differs, the displayed name omits the unit (as `jbf.Fit` and `--fix`
accept it) and the unit is displayed separately.
"""

from __future__ import annotations

from collections.abc import Mapping

from jbf.models.catalogue import Parameter, find_law, parameters_of
from jbf.records.quantities import Quantities

FORCES = {"presliding.sigma_1_m": "N/m", "stribeck_excess.a": "N", "dwell_stiction.a": "N"}
"""Parameters over the load that are forces in a law in newtons, whose load is one newton."""
ALONG = ("backlash.gap_rad",)
"""Angles of the drive that are displacements on a linear axis."""
OVER_LOAD = ("dry_load_dependence.mu", "zero_load_dependence.k", "viscous_load_dependence.c_s_m")
"""Parameters over a load whose unit stays N (or bar), whatever the motion is."""


def unit_of(name: str, page: Parameter, law: str, quantities: Quantities) -> str:
    """Unit of a parameter (dotted name) in combination with a law; `-` if dimensionless."""
    if find_law(law).needs_bearing:
        return page.unit
    if quantities.motion == "linear" and name in ALONG:
        return quantities.length
    if quantities.motion == "rotary" and name in OVER_LOAD:
        return quantities.unit("N" if page.unit == "-" else "N s/m") + " over load"
    return quantities.unit(FORCES.get(name, page.unit))


def shown_name(name: str, page: Parameter, unit: str) -> str:
    """Displayed name: without the unit if that differs from the unit of the rig."""
    return name if unit == page.unit else bare_name(name, page)


def bare_name(name: str, page: Parameter) -> str:
    """Name without the unit at its end: `F_v` for `F_v_n_s_m`."""
    end = page.unit.lower().replace("^", "").replace(" ", "_").replace("/", "_")
    return name.removesuffix(f"_{end}")


def shown(
    law: str, effects: tuple[str, ...], quantities: Quantities
) -> Mapping[str, tuple[str, str]]:
    """Map the full name of each parameter to its displayed name and unit.

    The unit is empty if the parameter is dimensionless.
    """
    found = {}
    for name, page in parameters_of(law, effects).items():
        unit = unit_of(name, page, law, quantities)
        found[name] = shown_name(name, page, unit), "" if unit == "-" else unit
    return found
