"""A finding: one thing that the recording did to a channel of a run."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Finding:
    """What the recording did.

    Attributes
    ----------
    kind
        `glitches`, `held_samples`, `interpolated`, `steps`, `gaps`, `saturation`, ...
    channel
        Name of the column.
    run
        Name of the run; several, with commas, where one finding is theirs in common.
    size
        How large, in `unit`.
    done
        What was done about it: `set aside`, `weighed`, `none`, ...
    words
        The finding in a sentence.
    """

    kind: str
    channel: str
    run: str
    size: float
    unit: str
    done: str
    words: str

    def to_dict(self) -> dict[str, Any]:
        """For JSON, as the file contract has it."""
        return dict(vars(self))
