"""Stribeck curve of all runs: mean friction over speed, for record and model."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jbf.arrays import Array
from jbf.comparison.axes import BOUNDARY_SHARE
from jbf.comparison.comparison import Comparison
from jbf.comparison.parts import added_by, non_friction_effects
from jbf.models.catalogue import transition_speed
from jbf.models.model import Model

BINS = 24
FEWEST = 5
"""Minimum number of samples for a mean."""


@dataclass(frozen=True)
class OverSpeed:
    """Mean friction by speed for one direction of motion.

    The bins have equal numbers of samples, the slowest first.

    Attributes
    ----------
    way
        Direction, 1.0 or -1.0.
    speed_m_s
        Mean speed of each bin, with its sign.
    measured_n, scatter_n
        Mean and standard deviation of the readings, without contributions other than friction.
    modelled_n
        Mean of the model at the same samples.
    """

    way: float
    speed_m_s: Array
    measured_n: Array
    scatter_n: Array
    modelled_n: Array


def friction_over_speed(comparison: Comparison) -> tuple[OverSpeed, ...]:
    """Compute the mean friction by speed over all included samples, for each direction."""
    rest = added_by(comparison, non_friction_effects(comparison))
    prepared, samples = comparison.campaign.prepared, comparison.samples
    speed = samples.flat([p.motion.velocity for p in prepared])
    measured = samples.flat([p.friction - f for p, f in zip(prepared, rest, strict=True)])
    modelled = samples.flat([m - f for m, f in zip(comparison.predictions, rest, strict=True)])
    branches = []
    for direction in (1.0, -1.0):
        in_direction = np.flatnonzero(speed * direction > 0.0)
        if len(in_direction) < FEWEST:
            continue
        order = in_direction[np.argsort(direction * speed[in_direction], kind="stable")]
        parts = np.array_split(order, max(min(BINS, len(order) // FEWEST), 1))
        rows = [
            (speed[p].mean(), measured[p].mean(), measured[p].std(), modelled[p].mean())
            for p in parts
        ]
        x, mean, scatter, model = np.array(rows).T
        branches.append(OverSpeed(direction, x, mean, scatter, model))
    return tuple(branches)


def regimes(model: Model) -> list[tuple[float, str]]:
    """Speeds, m/s, at which lubrication regimes begin, with their names; empty without a film."""
    u_tr = transition_speed(model.law, model.values.tolist())
    return [] if u_tr is None else [(BOUNDARY_SHARE * u_tr, "mixed"), (u_tr, "full film")]
