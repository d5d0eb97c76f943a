"""The artefacts by name, in the order in which they act on a signal."""

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
"""No artefact except that starts and stops fall between samples, as in all recordings here."""

ARTEFACTS: dict[str, Artefact] = {
    a.name: a for a in sorted(_IN_ORDER, key=lambda a: STAGES.index(a.stage))
}

ONE_OF = (
    {"coarse_velocity", "backward_velocity", "filtered_velocity"},
    {"slow_force", "drifting_clock"},
)
"""Artefacts that exclude each other: a recording has one speed and one clock of the force."""


def chosen(names: tuple[str, ...]) -> list[Artefact]:
    """Return the named artefacts in order; raise for unknown or mutually exclusive names."""
    if unknown := set(names) - set(ARTEFACTS) - {OFF_GRID}:
        known = ", ".join([OFF_GRID, *ARTEFACTS])
        raise ValueError(f"no artefact named {', '.join(sorted(unknown))}; there are {known}")
    for group in ONE_OF:
        if len(group & set(names)) > 1:
            raise ValueError(f"a recording has one of {', '.join(sorted(group))}, not more")
    return [a for name, a in ARTEFACTS.items() if name in names]
