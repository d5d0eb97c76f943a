"""What differs from run to run and is no effect: the zero of the cell, the oil's warmth.

A run has its own deviation from the campaign, Gaussian about nothing with a spread that the runs
themselves tell: a random effect (Laird & Ware 1982). The residuals of a run are then correlated in
the directions of those deviations. Whitened by that correlation, likelihood, score tests and errors
are what they are without it; and what is left of a test is taken with the deviations' best linear
predictions removed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from jbf.estimation.noise import Noise

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class BetweenRuns:
    """Deviations of the runs.

    Attributes
    ----------
    names
        What deviates, shape (q,).
    directions
        What a deviation of one standard deviation adds to each run's friction, N, one (n, q) a run.
    sigma_n
        Standard deviation of the innovations, N.
    """

    names: tuple[str, ...]
    directions: tuple[Array, ...]
    sigma_n: float

    def only(self, which: Sequence[int]) -> BetweenRuns:
        """Those of some of the runs."""
        return replace(self, directions=tuple(self.directions[i] for i in which))

    def without(self, name: str) -> BetweenRuns | None:
        """The others; None if there are none."""
        kept = [k for k, own in enumerate(self.names) if own != name]
        if not kept:
            return None
        directions = tuple(d[:, kept] for d in self.directions)
        return replace(self, names=tuple(self.names[k] for k in kept), directions=directions)

    def whitened(
        self, run: int, stacked: Sequence[Array], weight: Array, step_s: float, noise: Noise
    ) -> list[Array]:
        """Innovations of a run, weighted and without its gaps, free of the correlation that its
        deviations make."""
        u, size = self._basis(run, weight, step_s, noise)
        share = (1.0 - 1.0 / np.sqrt(1.0 + size**2))[:, None]

        def white(values: Array) -> Array:
            columns = values if values.ndim == 2 else values[:, None]
            left: Array = columns - u @ (share * (u.T @ columns))
            return left.reshape(values.shape)

        return [white(values) for values in stacked]

    def log_determinant(
        self, weight: Sequence[Array], steps_s: Sequence[float], noise: Noise
    ) -> float:
        """Of the runs' correlation: what their freedom to deviate costs in twice the log
        likelihood."""
        sizes = [
            self._basis(i, w, step, noise)[1]
            for i, (w, step) in enumerate(zip(weight, steps_s, strict=True))
        ]
        return float(np.sum(np.log1p(np.concatenate(sizes) ** 2)))

    def predicted(
        self, run: int, residual: Array, weight: Array, step_s: float, noise: Noise
    ) -> Array:
        """The best linear prediction of what a run's deviations add to its friction, N."""
        directions = self.directions[run]
        keep = weight > 0.0
        n = noise.innovations(directions * weight[:, None], step_s)[keep] / self.sigma_n
        r = noise.innovations(residual * weight, step_s)[keep] / self.sigma_n
        size = np.linalg.solve(n.T @ n + np.eye(n.shape[1]), n.T @ r)
        found: Array = directions @ size
        return found

    def _basis(self, run: int, weight: Array, step_s: float, noise: Noise) -> tuple[Array, Array]:
        keep = weight > 0.0
        directions = self.directions[run] * weight[:, None]
        n = noise.innovations(directions, step_s)[keep] / self.sigma_n
        u, size, _ = np.linalg.svd(n, full_matrices=False)
        return u, size
