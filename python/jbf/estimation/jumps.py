"""Samples next to a jump whose instant is itself fitted, or read for long.

Friction jumps where the motion turns round. Of those samples a record does not tell the sign, and
they do not count (`Samples`). An effect that moves the jump elsewhere (a late record, a gap to be
crossed first) moves the uncertainty with it: there the model has a ramp over a sample where the
record has a jump somewhere within it. What that costs is known: some half of the change over the
sample. A fit weighs the sample by it, and no test looks at it. What an effect spreads of a jump is
weighed by the error of its instant (`reversals`); where that is much of the noise, no test looks.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from jbf.estimation.prepared import Prepared
from jbf.estimation.reversals import instant_errors_n
from jbf.estimation.samples import Samples
from jbf.models.catalogue import Parameter, find_effect

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

JUMP = 0.1
"""A change within a sample by more than this share of the run's largest friction is a jump,"""
ALONE = 3.0
"""if it is so many times a change within two samples before it, and one after: a steep rise that
the record resolves, such as a mass set going, is none."""


UNSURE = 0.5
"""Share of the noise from which on an error of the instant is looked at by no test."""


def moves_jumps(effects: Iterable[str]) -> bool:
    """True where one of the effects moves the instants of jumps."""
    return any(find_effect(name).moves_jumps for name in effects)


def spreads_jumps(effects: Iterable[str]) -> bool:
    """True where one of the effects is read for long after a jump."""
    return any(find_effect(name).spreads_jumps for name in effects)


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
    samples: Samples,
    prepared: Sequence[Prepared],
    predictions: Sequence[Array],
    effects: Sequence[str],
) -> Samples:
    """The samples as a model with these effects, none at its null, leaves them, by where its
    predictions jump; as they are where it neither moves jumps nor spreads them."""
    moves, spreads = moves_jumps(effects), spreads_jumps(effects)
    if not (moves or spreads):
        return samples
    counted, weight = [], []
    for p, c, w, prediction in zip(
        prepared, samples.counted, samples.weight, predictions, strict=True
    ):
        if moves:
            c, w = _beside_jumps(p, c, w, prediction)
        if spreads:
            c, w = _behind_reversals(p, c, w, prediction)
        counted.append(c)
        weight.append(w)
    return replace(samples, counted=tuple(counted), weight=tuple(weight))


def _beside_jumps(
    p: Prepared, counted: Mask, weight: Array, prediction: Array
) -> tuple[Mask, Array]:
    change = jumps(prediction)
    kept = counted & (change == 0.0)
    return kept, weight * _share(0.5 * change, _noise_n(p, kept, prediction))


def _behind_reversals(
    p: Prepared, counted: Mask, weight: Array, prediction: Array
) -> tuple[Mask, Array]:
    noise_n = _noise_n(p, counted, prediction)
    error_n = instant_errors_n(p, prediction, UNSURE * noise_n)
    return counted & (error_n == 0.0), weight * _share(error_n, noise_n)


def _noise_n(p: Prepared, kept: Mask, prediction: Array) -> float:
    return float(np.sqrt(np.mean((prediction - p.friction_n)[kept] ** 2))) if kept.any() else 0.0


def _share(error_n: Array, noise_n: float) -> Array:
    """What a sample weighs whose prediction errs by so much beside its noise."""
    with np.errstate(divide="ignore", invalid="ignore"):
        share: Array = np.where(error_n > 0.0, noise_n / np.hypot(noise_n, error_n), 1.0)
    return share
