"""Catalogue of recording artefacts, in the order in which they act on a signal."""

from __future__ import annotations

from .cell import CELL, CONVERTER
from .clocks import CLOCKS
from .draft import STAGES, Artefact
from .faults import CONVERTER_FAULTS, LATER_FAULTS
from .noises import NOISES
from .rig import LOAD, RIG
from .speeds import SPEEDS

_IN_ORDER = (
    *RIG,
    *CLOCKS,
    *CELL,
    *NOISES,
    *CONVERTER_FAULTS,  # a spike is clipped and rounded like the other samples
    *CONVERTER,
    *SPEEDS,
    *LATER_FAULTS,
    *LOAD,
)
OFF_GRID = "off_grid"
"""Name for a recording without artefacts, in which starts and stops fall between samples."""

ARTEFACTS: dict[str, Artefact] = {
    a.name: a for a in sorted(_IN_ORDER, key=lambda a: STAGES.index(a.stage))
}

ONE_OF = (
    {"coarse_velocity", "backward_velocity", "filtered_velocity"},
    {"slow_force", "drifting_clock"},
)
"""Groups of artefacts of which a recording can have only one."""


def chosen(names: tuple[str, ...]) -> list[Artefact]:
    """Return the named artefacts in the order of their action.

    Raises for unknown and for mutually exclusive names.
    """
    if unknown := set(names) - set(ARTEFACTS) - {OFF_GRID}:
        known = ", ".join([OFF_GRID, *ARTEFACTS])
        raise ValueError(f"no artefact named {', '.join(sorted(unknown))}; there are {known}")
    for group in ONE_OF:
        if len(group & set(names)) > 1:
            raise ValueError(f"a recording has one of {', '.join(sorted(group))}, not more")
    return [a for name, a in ARTEFACTS.items() if name in names]
