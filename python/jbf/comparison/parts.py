"""Contributions of single effects to the friction of a model, by prediction without them.

Both predictions are computed by the core; this module contains no formula of an effect.
"""

from __future__ import annotations

import warnings
from collections.abc import Collection

import numpy as np

from jbf.arrays import Array
from jbf.comparison.comparison import Comparison, predicted
from jbf.errors import FilmWarning
from jbf.models.chain import chain
from jbf.models.model import Model

NO_FRICTION = (
    "inertia",
    "gravity",
    "spring",
    "cogging",
    "cogging_2",
    "sensor_offset",
    "sensor_drift",
    "zero_load_dependence",
)
"""Effects that a force sensor reads in addition to the friction."""


def without(model: Model, effects: Collection[str]) -> Model:
    """Model without some of its effects, with all other parameters unchanged."""
    remaining = tuple(name for name in model.effects if name not in effects)
    values = {n: p for n, p in model.parameters.items() if n.rpartition(".")[0] not in effects}
    return Model(model.rig, model.law, remaining, values, model.clock)


def added_by(comparison: Comparison, effects: Collection[str]) -> list[Array]:
    """Contribution of effects to the predicted friction, N, one array per run.

    The contribution is zero for effects that the model does not have.
    """
    model = comparison.model
    if not set(effects) & set(model.effects):
        return [np.zeros(len(f)) for f in comparison.predictions]
    with warnings.catch_warnings():
        # The prediction of the full model has already issued this warning.
        warnings.simplefilter("ignore", FilmWarning)
        rest = predicted(without(model, effects), comparison.campaign)
    return [with_effects - f for with_effects, f in zip(comparison.predictions, rest, strict=True)]


def non_friction_effects(comparison: Comparison) -> tuple[str, ...]:
    """Effects of a model that are not friction, such as inertia, weight, spring and cogging."""
    return tuple(name for name in NO_FRICTION if name in comparison.model.effects)


def explained_residual(before: Comparison, after: Comparison) -> dict[str, list[Array]]:
    """Part of a model's residual, N, that each new effect of a larger model explains.

    There is one array per run and effect: the contribution of the effect minus its projection on
    the column space of the first model's Jacobian.
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
    explained = {}
    for name in new:
        added = added_by(after, (name,))
        flat = before.samples.flat(added)
        share, *_ = np.linalg.lstsq(stacked / scale, flat, rcond=None)
        explained[name] = [a - j @ (share / scale) for a, j in zip(added, tangent, strict=True)]
    return explained
