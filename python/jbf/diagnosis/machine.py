"""The machine of a drive: moved inertia or mass, weight and offset, estimated with the law.

A motor accelerates its load and carries its weight whatever the friction is. These terms are part
of the model from which a diagnosis of a drive starts; they are no missing effects.
"""

from __future__ import annotations

from collections.abc import Iterable

from jbf.diagnosis.candidates import Candidates

Names = tuple[str, ...]

OFFSET = "sensor_offset"
TERMS = (OFFSET, "inertia_leak", "gravity")
"""Effects that are no friction and that no law can represent."""


def machine_of(candidates: Candidates, present: Iterable[str]) -> Names:
    """The effects of a model that are terms of its machine; none of a rig without a drive."""
    if candidates.campaign.rig.drive is None:
        return ()
    return tuple(name for name in present if name in TERMS)
