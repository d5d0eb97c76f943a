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
from scipy import special

from jbf.arrays import Array
from jbf.estimation.noise import Noise

ROUNDING = 1e-9
"""Fraction of the total precision below which that of the other runs is treated as zero."""


def spread_between(estimates: Array, precisions: Array) -> tuple[float, float, float]:
    """Between-run standard deviation, its p-value, and Cochran's Q over its degrees of freedom.

    The standard deviation is zero if the runs differ by no more than their errors.

    Notes
    -----
    With precisions w, estimates d and their weighted mean m, ``Q = sum(w (d - m)^2)`` over n runs.
    The variance between runs is ``(Q - (n - 1)) / (sum(w) - sum(w^2) / sum(w))`` by the method of
    moments (DerSimonian & Laird 1986).
    """
    mean = float(np.sum(precisions * estimates) / np.sum(precisions))
    q, free = float(np.sum(precisions * (estimates - mean) ** 2)), len(estimates) - 1
    # Residual autocorrelation inflates Q, so twice the chi-square quantile is required.
    p_value = float(special.chdtrc(free, 0.5 * q))
    total = float(np.sum(precisions))
    scale = total - float(np.sum(precisions**2)) / total
    # If one run has almost all of the precision, the spread is not identifiable.
    variance = (q - free) / scale if scale > ROUNDING * total else 0.0
    return float(np.sqrt(max(variance, 0.0))), p_value, q / free


@dataclass(frozen=True, eq=False)
class RandomEffects:
    """Random effects of a set of runs: Gaussian deviations of each run from the campaign.

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

    def only(self, selection: Sequence[int]) -> RandomEffects:
        """Return the random effects of the runs with these indices."""
        return replace(self, directions=tuple(self.directions[i] for i in selection))

    def without(self, name: str) -> RandomEffects | None:
        """Return the random effects except `name`; None if it is the only one."""
        kept = [k for k, other in enumerate(self.names) if other != name]
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
            """Values without the part of their correlation that is due to the random effects."""
            columns = values if values.ndim == 2 else values[:, None]
            return np.asarray((columns - u @ (share * (u.T @ columns))).reshape(values.shape))

        return [white(values) for values in stacked]

    def log_determinant(
        self, weight: Sequence[Array], steps_s: Sequence[float], noise: Noise
    ) -> float:
        """Log determinant of the correlation of the runs due to the random effects.

        This is the penalty for the random effects in minus twice the log likelihood.
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
        n = self._innovations(run, weight, step_s, noise)
        r = noise.innovations(residual * weight, step_s)[weight > 0.0] / self.sigma_n
        size = np.linalg.solve(n.T @ n + np.eye(n.shape[1]), n.T @ r)
        return np.asarray(self.directions[run] @ size)

    def _basis(self, run: int, weight: Array, step_s: float, noise: Noise) -> tuple[Array, Array]:
        """Left singular vectors, (n, q), and singular values, (q,), of `_innovations` for a run.

        The correlation of the run due to the random effects is the identity matrix plus
        ``u diag(size^2) u'``.
        """
        n = self._innovations(run, weight, step_s, noise)
        u, size, _ = np.linalg.svd(n, full_matrices=False)
        return u, size

    def _innovations(self, run: int, weight: Array, step_s: float, noise: Noise) -> Array:
        """Whitened contributions of the random effects to a run, in standard deviations, (n, q)."""
        directions = self.directions[run] * weight[:, None]
        return noise.innovations(directions, step_s)[weight > 0.0] / self.sigma_n
