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

    def sliced(self, slices: Sequence[slice]) -> RandomEffects:
        """Return the random effects of the samples in the slices, one slice per run."""
        pairs = zip(self.directions, slices, strict=True)
        return replace(self, directions=tuple(d[kept] for d, kept in pairs))


@dataclass(frozen=True, eq=False)
class Basis:
    """Random effects of one run in its whitened samples.

    Attributes
    ----------
    direction
        Contribution of the random effects to the whitened samples, in standard deviations of the
        innovations, shape (m, q).
    u, size
        Left singular vectors, (m, q), and singular values, (q,), of `direction`. The correlation of
        the run is the identity matrix plus ``u diag(size^2) u'``.
    """

    direction: Array
    u: Array
    size: Array

    @classmethod
    def of(cls, direction: Array) -> Basis:
        """Create the basis of random effects with these contributions, shape (m, q)."""
        u, size, _ = np.linalg.svd(direction, full_matrices=False)
        return cls(direction, u, size)

    def whitened(self, columns: Array) -> Array:
        """Columns (m, k) or (m,) with the correlation due to the random effects removed."""
        share = 1.0 - 1.0 / np.sqrt(1.0 + self.size**2)
        along = self.u.T @ columns
        return np.asarray(columns - self.u @ (share.reshape(-1, *[1] * (columns.ndim - 1)) * along))

    @property
    def log_determinant(self) -> float:
        """Log determinant of the correlation due to the random effects.

        This is the penalty for the random effects in minus twice the log likelihood.
        """
        return float(np.sum(np.log1p(self.size**2)))

    def predicted(self, innovations: Array) -> Array:
        """Best linear prediction of the deviations, in their standard deviations, shape (q,).

        `innovations` are those of the run, in standard deviations, shape (m,).
        """
        n = self.direction
        return np.asarray(np.linalg.solve(n.T @ n + np.eye(n.shape[1]), n.T @ innovations))
