"""Samples next to a jump whose instant is itself fitted.

Friction jumps where the motion turns round. Of those samples a record does not tell the sign, and
`conditioning` distrusts them. An effect that moves the jump elsewhere (a late record, a gap to
be crossed first) moves the doubt with it: there a sample is worth twice the friction or nothing,
by chance of a millisecond. Such samples drive neither a fit nor a verdict.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from jbf.campaign import Campaign
from jbf.catalogue import find_effect

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

JUMP = 0.25
"""A change within two samples by more than this share of the run's largest friction is a jump."""


def moves_jumps(effects: Iterable[str]) -> bool:
    """True where one of the effects moves the instants of jumps."""
    return any(find_effect(name).moves_jumps for name in effects)


def jumps(prediction: Array) -> Mask:
    """True at samples of a prediction (N) in or next to a jump."""
    found = np.zeros(len(prediction), dtype=bool)
    steep = np.abs(np.diff(prediction)) > 0.5 * JUMP * np.max(np.abs(prediction), initial=0.0)
    for shift in (-1, 0, 1, 2):
        at = np.flatnonzero(steep) + shift
        found[at[(at >= 0) & (at < len(found))]] = True
    return found


def without_jumps(
    campaign: Campaign, effects: Iterable[str], predictions: Sequence[Array]
) -> Campaign:
    """The campaign less the samples that a model with these effects puts in doubt."""
    if not moves_jumps(effects):
        return campaign
    prepared = tuple(
        replace(p, trusted=p.trusted & ~jumps(f))
        for p, f in zip(campaign.prepared, predictions, strict=True)
    )
    return Campaign(campaign.rig, prepared)
