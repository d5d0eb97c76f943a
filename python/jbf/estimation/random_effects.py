"""Random effects: deviations between runs, such as the load cell's zero or the oil temperature.

Each run deviates from the campaign by a zero-mean Gaussian amount whose spread is estimated from
the runs (Laird & Ware 1982). The residuals of a run are then correlated in the directions of these
deviations. After whitening by this correlation, likelihood, score tests and standard errors have
their usual form. Tests of the residual structure use residuals from which the best linear
predictions of the deviations are subtracted.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
from scipy import special

from jbf.estimation.noise import Noise

Array = npt.NDArray[np.float64]
ROUNDING = 1e-9
"""Fraction of the total precision below which the precision of other runs is a rounding error.

It is a numerical tolerance.
"""


def spread_between(estimates: Array, precisions: Array) -> tuple[float, float, float]:
    """Standard deviation between runs, its p-value, and the ratio of the variance to chance.

    The standard deviation is zero where the runs agree.
    """
    mean = float(np.sum(precisions * estimates) / np.sum(precisions))
    q, free = float(np.sum(precisions * (estimates - mean) ** 2)), len(estimates) - 1
    # Residuals are never as white as assumed, so twice the chi-square is required.
    chance = float(special.chdtrc(free, 0.5 * q))
    whole = float(np.sum(precisions))
    apart = whole - float(np.sum(precisions**2)) / whole
    # If one run has all of the precision, the others do not determine a spread.
    variance = (q - free) / apart if apart > ROUNDING * whole else 0.0
    return float(np.sqrt(max(variance, 0.0))), chance, q / free


@dataclass(frozen=True, eq=False)
class BetweenRuns:
    """Random effects: deviations of the runs from the campaign.

    Attributes
    ----------
    names
        Names of the random effects, shape (q,).
    directions
        Contribution of one standard deviation of each random effect to the friction of each run, N;
        one (n, q) array a run.
    sigma_n
        Standard deviation of the innovations, N.
    """

    names: tuple[str, ...]
    directions: tuple[Array, ...]
    sigma_n: float

    def only(self, which: Sequence[int]) -> BetweenRuns:
        """Return the random effects of a selection of runs."""
        return replace(self, directions=tuple(self.directions[i] for i in which))

    def without(self, name: str) -> BetweenRuns | None:
        """Return the random effects except `name`; None if no other exists."""
        kept = [k for k, own in enumerate(self.names) if own != name]
        if not kept:
            return None
        directions = tuple(d[:, kept] for d in self.directions)
        return replace(self, names=tuple(self.names[k] for k in kept), directions=directions)

    def whitened(
        self, run: int, stacked: Sequence[Array], weight: Array, step_s: float, noise: Noise
    ) -> list[Array]:
        """Innovations of a run with the correlation due to its random effects removed.

        The innovations are weighted and exclude the gaps of the run.
        """
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
        """Log determinant of the correlation of the runs due to the random effects.

        It is the penalty, in twice the log likelihood, for the freedom of the runs to deviate.
        """
        sizes = [
            self._basis(i, w, step, noise)[1]
            for i, (w, step) in enumerate(zip(weight, steps_s, strict=True))
        ]
        return float(np.sum(np.log1p(np.concatenate(sizes) ** 2)))

    def predicted(
        self, run: int, residual: Array, weight: Array, step_s: float, noise: Noise
    ) -> Array:
        """Best linear prediction of the random effects in a run's friction, N."""
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
