"""Slopes of the cost by which the noise of a residual is described."""

from __future__ import annotations

import numpy as np
import pytest
from jbf.estimation.noise import Noise, _changes, innovation_cost

STEP_S = 0.02


def test_the_slope_of_the_cost_is_that_of_differences() -> None:
    random = np.random.default_rng(4)
    residuals = [
        np.cumsum(random.normal(0.0, 0.1, 900)) + random.normal(0.0, 0.4, 900) for _ in "ab"
    ]
    masks = [np.ones(900, bool), np.arange(900) % 7 > 0]
    steps = [STEP_S, 1.5 * STEP_S]

    def cost(log_memory: float, colour: float) -> float:
        return innovation_cost(Noise(float(np.exp(log_memory)), colour), residuals, steps, masks)

    at, by = (np.log(0.15), 0.4), 1e-5
    slope, _ = _changes(Noise(0.15, 0.4), residuals, steps, masks)
    by_memory = (cost(at[0] + by, at[1]) - cost(at[0] - by, at[1])) / (2.0 * by)
    by_colour = (cost(at[0], at[1] + by) - cost(at[0], at[1] - by)) / (2.0 * by)
    assert slope == pytest.approx([by_memory, by_colour], rel=1e-5)
