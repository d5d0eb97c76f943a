"""Result of a least-squares search for a model."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from jbf.arrays import Array
from jbf.estimation.noise import Noise
from jbf.estimation.samples import Samples

MIN_SAMPLES = 100
"""Minimum number of samples of a run for a root mean square of its own."""
Lines = tuple[list[Array], list[Array]]
"""Residuals, and Jacobian of the prediction in the search variables, one array per run each."""


@dataclass(frozen=True, eq=False)
class Solution:
    """Parameter values of a fitted model, with residuals, Jacobian and noise model.

    Attributes
    ----------
    effects
        Effects of the model.
    values
        Parameter values, shape (k,).
    residuals
        Record minus prediction, N, one array per run.
    jacobian
        Derivative of the prediction with respect to each search variable, one (n, k) a run. For
        large numbers of samples, both are computed at each access.
    noise
        Noise model of the residuals.
    converged, message
        Convergence flag and message of the search.
    samples
        Samples used by the model at these values: fewer than those of the campaign if an effect
        shifts friction jumps in time.
    systematic
        Systematic error of each search variable, shape (k,): its change if the motion is smoothed
        less, and between fits of similar likelihood. None where the errors of the motion are
        neglected.
    """

    effects: tuple[str, ...]
    values: Array
    residuals: Sequence[Array]
    jacobian: Sequence[Array]
    noise: Noise
    converged: bool
    message: str
    samples: Samples
    systematic: Array | None = None

    @property
    def free(self) -> int:
        """Number of fitted parameters."""
        return self.jacobian[0].shape[1] if self.jacobian else len(self.values)

    @property
    def lines(self) -> Lines | None:
        """Residuals and Jacobian if they are held in memory, otherwise None."""
        if isinstance(self.residuals, list) and isinstance(self.jacobian, list):
            return self.residuals, self.jacobian
        return None

    @cached_property
    def cost(self) -> float:
        """Cost of the residuals, ``n log(mean square innovation)`` over weighted samples."""
        return self.samples.cost(self.residuals, self.noise)

    @cached_property
    def rms(self) -> float:
        """Root mean square of the residuals over the included samples, N."""
        return self.samples.rms(self.residuals)

    def stacked(self) -> tuple[Array, Array]:
        """Innovations (whitened residuals) and their Jacobian, for weighted samples of all runs."""
        return self.samples.stacked(self.residuals, self.jacobian, self.noise)

    def innovation_rms(self, residuals: Sequence[Array]) -> list[float]:
        """Root mean square of the innovations of each run, N, for the residuals of the estimates.

        For a run with fewer than `MIN_SAMPLES` samples, it is that of all runs.
        """
        by_run = self.samples.innovations(residuals, self.noise)
        included = [e[counted] for e, counted in zip(by_run, self.samples.counted, strict=True)]
        pooled = float(np.sqrt(np.mean(np.concatenate(included) ** 2)))
        return [
            float(np.sqrt(np.mean(e**2))) if len(e) >= MIN_SAMPLES else pooled for e in included
        ]
