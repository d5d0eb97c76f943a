"""Covariance of residuals that contain errors of the estimated motion.

A residual is the noise of the reading plus the error of the motion times the sensitivity of the
model to it. The errors of the motion are correlated in time, and their posterior is known.
Generalised least squares with this covariance gives unbiased parameters, and standard errors that
contain the errors of the motion. The errors are of Berkson type, since the motion is a posterior
mean.

References
----------
Berkson (1950); Carroll, Ruppert, Stefanski & Crainiceanu, Measurement Error in Nonlinear Models
(2006), chapter 2.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt

from jbf._core import MotionWhitening
from jbf.arrays import Array
from jbf.estimation.random_effects import Basis
from jbf.records.motion.estimated_motion import MotionErrors


@dataclass(frozen=True, eq=False)
class ErrorsInMotion:
    """Covariance of the residuals due to errors of the estimated motion, for a set of runs.

    Attributes
    ----------
    errors
        Posterior of the motion errors of each run; None where it is not known.
    sensitivity
        Derivatives of the prediction with respect to position, velocity and acceleration, one
        (n, 3) array a run.
    noise
        Standard deviation of the noise of the force, in the unit of the residuals.
    scale
        Factor on the standard errors of the motion in `errors`.
    by_delay
        Derivative of the prediction with respect to a common time delay of the forces, one (n,)
        array a run; None without a delay. The part of the residuals that a delay explains is
        projected out.
    """

    errors: tuple[MotionErrors | None, ...]
    sensitivity: tuple[Array, ...]
    noise: float
    scale: float = 1.0
    by_delay: tuple[Array, ...] | None = None

    def only(self, selection: Sequence[int]) -> ErrorsInMotion:
        """Return the errors of the runs with these indices."""
        return replace(
            self,
            errors=tuple(self.errors[i] for i in selection),
            sensitivity=tuple(self.sensitivity[i] for i in selection),
            by_delay=None if self.by_delay is None else tuple(self.by_delay[i] for i in selection),
        )

    def whitening(self, weights: Sequence[Array]) -> Whitening:
        """Return the filter for samples with these weights, 0 to 1, one (n,) array a run."""
        chains = [None if errors is None else errors.chain for errors in self.errors]
        ratio = self.scale / self.noise
        core = MotionWhitening(chains, self.sensitivity, ratio, weights)
        return Whitening(core, tuple(weights), self.noise, self.by_delay)

    def variance_ratio(self, run: int) -> Array:
        """Ratio of the variance due to the motion's errors to that of the noise, shape (n,)."""
        errors, sensitivity = self.errors[run], self.sensitivity[run]
        if errors is None:
            return np.zeros(len(sensitivity))
        covariance = errors.covariance[:, :3, :3]
        variance = np.einsum("ni,nij,nj->n", sensitivity, covariance, sensitivity)
        return np.asarray(variance * (self.scale / self.noise) ** 2)

    def mean_share(self, weights: Sequence[Array]) -> float:
        """Mean share of the motion's errors in the variance, over samples with nonzero weight."""
        ratio = self._ratios(weights)
        return float(np.mean(ratio / (1.0 + ratio))) if len(ratio) else 0.0

    def variance_share(self, weights: Sequence[Array]) -> float:
        """Share of the motion's errors in the mean variance of samples with nonzero weight.

        It is never smaller than `mean_share`, and much larger if few samples have large errors.
        """
        ratio = self._ratios(weights)
        mean = float(np.mean(ratio)) if len(ratio) else 0.0
        return mean / (1.0 + mean)

    def _ratios(self, weights: Sequence[Array]) -> Array:
        """Variance ratio of each sample with nonzero weight, all runs in one array."""
        return np.concatenate([self.variance_ratio(i)[w > 0.0] for i, w in enumerate(weights)])


@dataclass(frozen=True, eq=False)
class Whitening:
    """Filter that whitens residuals with errors of the motion, for given weights of the samples.

    Attributes
    ----------
    core
        Filters of the runs, for noise of unit standard deviation.
    weights
        Weight of each sample, 0 to 1, one array per run; samples without weight are excluded.
    noise, by_delay
        As in `ErrorsInMotion`.
    """

    core: MotionWhitening
    weights: tuple[Array, ...]
    noise: float
    by_delay: tuple[Array, ...] | None

    @cached_property
    def _included(self) -> list[npt.NDArray[np.intp]]:
        """Indices of the samples with a weight, one array per run."""
        return [np.flatnonzero(w) for w in self.weights]

    def stacked(
        self,
        residuals: Sequence[Array],
        jacobian: Sequence[Array],
        selection: Sequence[int] | None = None,
        bases: Sequence[Basis] | None = None,
    ) -> tuple[Array, Array]:
        """Whitened residuals of standard deviation `noise` and their Jacobian, of all runs.

        The arguments are residuals (n,) and their derivatives (n, k), one array per run, in the
        unit of the force, and optionally the indices of the runs to use and the random effects of
        these. The result has the residuals (m,) and the Jacobian (m, k) of the samples with a
        weight, all runs in one array.
        """
        runs = list(range(len(residuals)) if selection is None else selection)
        columns = []
        for i in runs:
            parts = [residuals[i], jacobian[i]]
            if self.by_delay is not None:
                parts.append(self.by_delay[i])
            columns.append(np.column_stack(parts))
        blocks = self.whitened(columns, runs)
        if bases is not None:
            blocks = [basis.whitened(block) for basis, block in zip(bases, blocks, strict=True)]
        stacked = np.concatenate(blocks)
        if self.by_delay is not None:
            delay = stacked[:, -1]
            slopes = delay @ stacked[:, :-1] / max(float(delay @ delay), 1e-300)
            stacked = stacked[:, :-1] - np.outer(delay, slopes)
        return stacked[:, 0], stacked[:, 1:]

    def whitened(self, columns: Sequence[Array], runs: Sequence[int]) -> list[Array]:
        """Whitened columns (n, k) of the runs with these indices, at the samples with a weight."""
        whitened = self.core.whiten(list(columns), list(runs))
        pairs = zip(runs, whitened, strict=True)
        return [white.take(self._included[i], axis=0) for i, white in pairs]

    def innovations(self, residuals: Sequence[Array]) -> list[Array]:
        """Whitened residuals of standard deviation `noise`, one array per run.

        Values at samples without weight are zero.
        """
        runs = range(len(residuals))
        return [white[:, 0] for white in self.core.whiten([r[:, None] for r in residuals], runs)]

    def deviance(self, residuals: Sequence[Array]) -> float:
        """Minus twice the log likelihood of the residuals, up to an additive constant."""
        squares = sum(float(r @ r) for r in self.innovations(residuals))
        return squares / self.noise**2 + self.log_determinant

    @property
    def log_determinant(self) -> float:
        """Logarithm of the determinant of the covariance of the residuals."""
        count = sum(map(len, self._included))
        return self.core.log_determinant + 2.0 * count * float(np.log(self.noise))
