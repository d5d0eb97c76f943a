"""Where a search for the least squares ended."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from jbf.estimation.noise import Noise
from jbf.estimation.samples import Samples

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Solution:
    """Parameter values of a model, and what follows from them.

    Attributes
    ----------
    values
        Parameter values, shape (k,).
    residuals
        Record minus prediction, N, one array a run.
    jacobian
        Derivative of the prediction with respect to each search variable, one (n, k) a run. Where
        samples are many, both are made when they are asked for.
    cost
        `n log(mean square innovation)` over weighted samples.
    samples
        Those that the model at these values leaves: fewer than the campaign's where an effect moves
        the instants of jumps.
    systematic
        Systematic error of each search variable, shape (k,): its change with a motion that is
        smoothed less, and between fits of similar likelihood. None where the errors of the motion
        are neglected.
    """

    effects: tuple[str, ...]
    values: Array
    residuals: Sequence[Array]
    jacobian: Sequence[Array]
    noise: Noise
    cost: float
    converged: bool
    message: str
    samples: Samples
    systematic: Array | None = None

    @property
    def free(self) -> int:
        """Number of parameters that were fitted."""
        return self.jacobian[0].shape[1] if self.jacobian else len(self.values)

    @cached_property
    def rms_n(self) -> float:
        """Root mean square of the residuals over the samples that count, N."""
        return self.samples.rms(self.residuals)

    def stacked(self) -> tuple[Array, Array]:
        """Innovations of the residuals and of the derivatives, over weighted samples."""
        return self.samples.stacked(self.residuals, self.jacobian, self.noise)
