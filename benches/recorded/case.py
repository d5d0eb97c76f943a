"""A labelled campaign on disk, and the row of figures that a bench keeps of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

Row = dict[str, Any]


@dataclass(frozen=True)
class Case:
    """What is in two folders.

    Attributes
    ----------
    key
        A name of its own.
    effects, artefacts
        The physics that is hidden, and what the recording did.
    strength
        Of the artefacts: `mild`, `usual`, `severe`, or `-` where it is not known.
    noise_n
        White noise of the clean recording (1 s.d.), N.
    runs, held_out
        Folders: `rig.toml` and runs; clean runs of the same rig with other motions.
    effect_over_noise
        RMS of the weakest effect over the noise in the run that shows it best; 0 if not known.
    """

    key: str
    effects: tuple[str, ...]
    artefacts: tuple[str, ...]
    strength: str
    noise_n: float
    runs: str
    held_out: str
    effect_over_noise: float = 0.0

    @property
    def kind(self) -> str:
        """How many effects are hidden, in a word."""
        return ("none", "single", "pair")[min(len(self.effects), 2)]
