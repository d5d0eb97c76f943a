"""What single effects add to a model's friction: the model less the same model without them.

The core is asked twice; nothing of an effect's form is written here.
"""

from __future__ import annotations

import warnings
from collections.abc import Collection

import numpy as np
import numpy.typing as npt

from jbf.comparison.comparison import Comparison, predicted
from jbf.errors import FilmWarning
from jbf.models.chain import chain
from jbf.models.model import Model

Array = npt.NDArray[np.float64]

NO_FRICTION = (
    "inertia_leak",
    "gravity",
    "cogging",
    "cogging_2",
    "sensor_offset",
    "sensor_drift",
    "zero_load_dependence",
)
"""Effects that a force sensor reads beside the friction, and adds to it."""


def without(model: Model, effects: Collection[str]) -> Model:
    """The same model, every other parameter as it is, without some of its effects."""
    kept = tuple(name for name in model.effects if name not in effects)
    values = {n: p for n, p in model.parameters.items() if n.rpartition(".")[0] not in effects}
    return Model(model.rig, model.law, kept, values, model.clock)


def added_by(comparison: Comparison, effects: Collection[str]) -> list[Array]:
    """What effects add to the model's friction in each run, N; zeros of those it does not have."""
    model = comparison.model
    if not set(effects) & set(model.effects):
        return [np.zeros(len(f)) for f in comparison.predictions]
    with warnings.catch_warnings():
        # The whole model has given it already.
        warnings.simplefilter("ignore", FilmWarning)
        rest = predicted(without(model, effects), comparison.campaign)
    return [whole - f for whole, f in zip(comparison.predictions, rest, strict=True)]


def beside_friction(comparison: Comparison) -> tuple[str, ...]:
    """Effects of the model that are no friction: inertia, weight, zero, cogging."""
    return tuple(name for name in NO_FRICTION if name in comparison.model.effects)


def friction_alone(comparison: Comparison) -> list[Array]:
    """The readings of each run less all that the model knows to be no friction, N."""
    rest = added_by(comparison, beside_friction(comparison))
    return [p.friction_n - f for p, f in zip(comparison.campaign.prepared, rest, strict=True)]


def made_of(before: Comparison, after: Comparison) -> dict[str, list[Array]]:
    """Of what a model left, the part that each effect of a fuller one says, N, one array a run.

    An effect is said to add what the first model's own parameters cannot make up for: what it adds,
    less its projection on that model's derivatives.
    """
    model, campaign = before.model, before.campaign
    core = chain(model.rig, model.law, model.clock, model.effects)
    free = [i for i, p in enumerate(model.parameters.values()) if not p.held]
    new = [name for name in after.model.effects if name not in model.effects]
    if not new:
        return {}
    rows = core.jacobian(model.values, campaign.motions, free)
    tangent = [j for _, j in rows]
    counted = before.samples.counted
    stacked = np.concatenate([j[c] for j, c in zip(tangent, counted, strict=True)])
    size = np.linalg.norm(stacked, axis=0)
    scale = np.where(size > 0.0, size, 1.0)
    found = {}
    for name in new:
        added = added_by(after, (name,))
        flat = before.samples.flat(added)
        share, *_ = np.linalg.lstsq(stacked / scale, flat, rcond=None)
        found[name] = [a - j @ (share / scale) for a, j in zip(added, tangent, strict=True)]
    return found
