"""Terms of a drive's machine: moved inertia or mass, weight and offset, estimated with the law.

A motor accelerates its load and carries its weight whatever the friction is. These terms belong to
the model from which the diagnosis of a drive starts; they are not missing effects.
"""

from __future__ import annotations

from collections.abc import Iterable

from jbf.diagnosis.candidates import Candidates

Names = tuple[str, ...]

OFFSET = "sensor_offset"
TERMS = (OFFSET, "inertia", "gravity")
"""Effects that are not friction and that no law can represent."""


def machine_of(candidates: Candidates, present: Iterable[str]) -> Names:
    """The effects of a model that are terms of its machine; empty for a rig without a drive."""
    if candidates.campaign.rig.drive is None:
        return ()
    return tuple(name for name in present if name in TERMS)
