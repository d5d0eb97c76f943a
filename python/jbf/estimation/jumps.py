"""Samples next to a jump whose instant is itself fitted.

Friction jumps where the motion turns round. Of those samples a record does not tell the sign, and
`conditioning` distrusts them. An effect that moves the jump elsewhere (a late record, a gap to
be crossed first) moves the doubt with it: there the model has a ramp over a sample where the record
has a jump somewhere within it. What that costs is known: some half of the change over the sample.
A fit weighs the sample by it, and no verdict looks at it.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from jbf.estimation.campaign import Campaign, Prepared
from jbf.models.catalogue import Parameter, find_effect

Array = npt.NDArray[np.float64]

JUMP = 0.1
"""A change within a sample by more than this share of the run's largest friction is a jump,"""
ALONE = 3.0
"""if it is so many times a change within two samples before it, and one after: a steep rise that
the record resolves, such as a mass set going, is none."""


def moves_jumps(effects: Iterable[str]) -> bool:
    """True where one of the effects moves the instants of jumps."""
    return any(find_effect(name).moves_jumps for name in effects)


def at_work(
    effects: Iterable[str], pages: Mapping[str, Parameter], values: Iterable[float]
) -> list[str]:
    """The effects that are not at their null; `pages` and `values` by the parameters' full names,
    in one order."""
    idle = {
        name.split(".")[0]
        for (name, page), value in zip(pages.items(), values, strict=True)
        if "." in name and page.null == value
    }
    return [effect for effect in effects if effect not in idle]


def jumps(prediction: Array) -> Array:
    """Change of a prediction (N) at samples in or next to a jump, N; zero elsewhere."""
    change = np.abs(np.diff(prediction))
    # A ramp that lies across a sample takes part of two changes: one neighbour may be its own. The
    # two jumps at a gap may be as close as that, too.
    around = np.pad(change, 2)
    before, after = (
        np.minimum(around[:-4], around[1:-3]),
        np.minimum(around[3:-1], around[4:]),
    )
    alone = change > ALONE * np.maximum(before, after)
    steep = alone & (change > JUMP * np.max(np.abs(prediction), initial=0.0))
    steep = np.where(steep, change, 0.0)
    found: Array = np.maximum(np.append(steep, 0.0), np.append(0.0, steep))
    return found


def without_jumps(
    campaign: Campaign, effects: Iterable[str], predictions: Sequence[Array]
) -> Campaign:
    """The campaign with the doubt that a model with these effects casts on its samples."""
    if not moves_jumps(effects):
        return campaign
    pairs = zip(campaign.prepared, predictions, strict=True)
    return campaign.of(_doubted(p, f) for p, f in pairs)


def _doubted(p: Prepared, prediction: Array) -> Prepared:
    change = jumps(prediction)
    sure = p.trusted & (change == 0.0)
    noise = float(np.sqrt(np.mean((prediction - p.friction_n)[sure] ** 2))) if sure.any() else 0.0
    error = 0.5 * change
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where(error > 0.0, noise / np.hypot(noise, error), 1.0)
    return replace(p, trusted=sure, weight=p.weight * share)
