"""Labelled campaign on disk, and the row of results that a study stores for it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

Row = dict[str, Any]


@dataclass(frozen=True)
class Case:
    """A labelled campaign in two folders.

    Attributes
    ----------
    key
        A unique name.
    effects, artefacts
        The hidden effects and the recording artefacts.
    strength
        Strength of the artefacts: `mild`, `usual`, `severe`, or `-` if unknown.
    noise_rms
        White noise of the clean recording (1 s.d.), N.
    runs, held_out
        Folders: `rig.toml` and runs; clean runs of the same rig with other motions.
    effect_over_noise
        RMS of the weakest effect over the noise in the run that shows it best; 0 if unknown.
    """

    key: str
    effects: tuple[str, ...]
    artefacts: tuple[str, ...]
    strength: str
    noise_rms: float
    runs: str
    held_out: str
    effect_over_noise: float = 0.0

    @property
    def kind(self) -> str:
        """Kind of the campaign: `none`, `single` or `pair`, by the number of hidden effects."""
        return ("none", "single", "pair")[min(len(self.effects), 2)]
