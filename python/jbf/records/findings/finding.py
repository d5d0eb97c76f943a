"""A data-quality finding: one recording artefact in a channel of a run."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Finding:
    """One recording artefact of a run.

    Attributes
    ----------
    kind
        `glitches`, `held_samples`, `interpolated`, `steps`, `gaps`, `saturation`, ...
    channel
        Name of the column.
    run
        Name of the run; several names, separated by commas, if the finding is common to them.
    size
        Magnitude, in `unit`.
    done
        Action taken: `excluded`, `weighted`, `none`, ...
    words
        Description of the finding, one sentence.
    """

    kind: str
    channel: str
    run: str
    size: float
    unit: str
    done: str
    words: str

    def to_dict(self) -> dict[str, Any]:
        """Return the finding for JSON, in the format of the file contract."""
        return dict(vars(self))
