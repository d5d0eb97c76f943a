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

import numpy as np
import numpy.typing as npt

from jbf._core import whiten_motion_errors
from jbf.records.motion.estimated_motion import MotionErrors

Array = npt.NDArray[np.float64]


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

    def stacked(
        self,
        residuals: Sequence[Array],
        jacobian: Sequence[Array],
        weights: Sequence[Array],
        selection: Sequence[int] | None = None,
    ) -> tuple[Array, Array]:
        """Whitened residuals of standard deviation `noise` and their Jacobian, of all runs.

        Parameters
        ----------
        residuals, jacobian
            Residuals (n,) and their derivatives (n, k), one array per run, in the unit of the
            force.
        weights
            Weight of each sample, 0 to 1; samples without weight are excluded.
        selection
            Indices of the runs to use; None for all runs.

        Returns
        -------
        tuple
            Residuals (m,) and Jacobian (m, k) of the samples with a weight, all runs in one array.
        """
        runs = list(range(len(residuals)) if selection is None else selection)
        columns = []
        for i in runs:
            parts = [residuals[i], jacobian[i]]
            if self.by_delay is not None:
                parts.append(self.by_delay[i])
            columns.append(np.column_stack(parts))
        used = [weights[i] for i in runs]
        whitened = self._whitened(runs, columns, used)
        white = [rows[w > 0.0] for (rows, _), w in zip(whitened, used, strict=True)]
        stacked = np.concatenate(white)
        if self.by_delay is not None:
            delay = stacked[:, -1]
            slopes = delay @ stacked[:, :-1] / max(float(delay @ delay), 1e-300)
            stacked = stacked[:, :-1] - np.outer(delay, slopes)
        return stacked[:, 0], stacked[:, 1:]

    def innovations(self, residuals: Sequence[Array], weights: Sequence[Array]) -> list[Array]:
        """Whitened residuals of standard deviation `noise`, one array per run.

        Values at samples without weight are zero.
        """
        whitened = self._whitened(range(len(residuals)), [r[:, None] for r in residuals], weights)
        return [white[:, 0] * (w > 0.0) for (white, _), w in zip(whitened, weights, strict=True)]

    def deviance(self, residuals: Sequence[Array], weights: Sequence[Array]) -> float:
        """Minus twice the log likelihood of the residuals, up to an additive constant."""
        whitened = self._whitened(range(len(residuals)), [r[:, None] for r in residuals], weights)
        squares = sum(float(np.sum(white**2)) for white, _ in whitened)
        return squares / self.noise**2 + sum(determinant for _, determinant in whitened)

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
        ratios = [self.variance_ratio(i)[w > 0.0] for i, w in enumerate(weights)]
        ratio = np.concatenate(ratios)
        return float(np.mean(ratio / (1.0 + ratio))) if len(ratio) else 0.0

    def _whitened(
        self, runs: Sequence[int], columns: Sequence[Array], weights: Sequence[Array]
    ) -> list[tuple[Array, float]]:
        """Whitened columns of each run, and the log determinants of the covariances."""
        with np.errstate(divide="ignore"):
            variances = [np.where(w > 0.0, (self.noise / w) ** 2, np.inf) for w in weights]
        chains = [None if (errors := self.errors[i]) is None else errors.chain for i in runs]
        known = [k for k, chain in enumerate(chains) if chain is not None]
        whitened = whiten_motion_errors(
            [chain for chain in chains if chain is not None],
            [self.scale * self.sensitivity[runs[k]] for k in known],
            [variances[k] for k in known],
            [columns[k] for k in known],
        )
        results = {
            k: (self.noise * white, log_determinant)
            for k, (white, log_determinant) in zip(known, whitened, strict=True)
        }
        return [
            results[k] if k in results else (c * w[:, None], float(np.sum(np.log(v[w > 0.0]))))
            for k, (c, w, v) in enumerate(zip(columns, weights, variances, strict=True))
        ]
