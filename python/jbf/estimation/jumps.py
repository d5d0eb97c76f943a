"""Samples next to a jump whose instant is itself fitted.

Friction jumps where the motion turns round. Of those samples a record does not tell the sign, and
they do not count (`Samples`). An effect that moves the jump elsewhere (a late record, a gap to be
crossed first) moves the uncertainty with it: there the model has a ramp over a sample where the
record has a jump somewhere within it. What that costs is known: some half of the change over the
sample. A fit weighs the sample by it, and no test looks at it.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from jbf.estimation.prepared import Prepared
from jbf.estimation.samples import Samples
from jbf.models.catalogue import Parameter, find_effect

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

JUMP = 0.1
"""A change within a sample by more than this share of the run's largest friction is a jump,"""
ALONE = 3.0
"""if it is so many times a change within two samples before it, and one after: a steep rise that
the record resolves, such as a mass set going, is none."""


def moves_jumps(effects: Iterable[str]) -> bool:
    """True where one of the effects moves the instants of jumps."""
    return any(find_effect(name).moves_jumps for name in effects)


def active_effects(
    effects: Iterable[str], pages: Mapping[str, Parameter], values: Iterable[float]
) -> list[str]:
    """The effects that are not at their null: one of their parameters that have a null is off it.

    `pages` and `values` are by the parameters' full names, in one order.
    """
    off: dict[str, bool] = {}
    for (name, page), value in zip(pages.items(), values, strict=True):
        effect, dot, _ = name.partition(".")
        if dot and page.null is not None:
            off[effect] = off.get(effect, False) or page.null != value
    return [effect for effect in effects if off.get(effect, True)]


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


def samples_beside_jumps(
    samples: Samples, prepared: Sequence[Prepared], predictions: Sequence[Array]
) -> Samples:
    """The samples as a model that moves jumps leaves them, by where its predictions jump."""
    found = [
        _uncertain(p, counted, weight, prediction)
        for p, counted, weight, prediction in zip(
            prepared, samples.counted, samples.weight, predictions, strict=True
        )
    ]
    return replace(samples, counted=tuple(c for c, _ in found), weight=tuple(w for _, w in found))


def _uncertain(p: Prepared, counted: Mask, weight: Array, prediction: Array) -> tuple[Mask, Array]:
    change = jumps(prediction)
    kept = counted & (change == 0.0)
    noise = float(np.sqrt(np.mean((prediction - p.friction_n)[kept] ** 2))) if kept.any() else 0.0
    error = 0.5 * change
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where(error > 0.0, noise / np.hypot(noise, error), 1.0)
    return kept, weight * share
