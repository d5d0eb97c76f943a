"""Evaluation of a signal chain along the motions of runs.

The core may receive more instants than a run has samples, such as those of a hypothetical motion
before it. Readings are returned at the samples only.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from jbf import _core
from jbf.arrays import Array
from jbf.models.user_chain import UserChain


@dataclass(frozen=True)
class Driven:
    """Motion in the form of the core; `kept` has the indices of a run's samples in it."""

    motion: _core.Motion
    kept: npt.NDArray[np.intp] | None = None

    def at_samples(self, values: Array) -> Array:
        """Select the values at the samples of the run from those at all instants of the core."""
        return values if self.kept is None else values.take(self.kept, axis=0)


class DrivenChain:
    """Signal chain, with or without user-defined effects, evaluated for `Driven` motions."""

    def __init__(self, core: _core.Chain | UserChain) -> None:
        self.core = core

    @property
    def parameter_names(self) -> list[str]:
        """Dotted names of the parameters, in the order of `parameters`."""
        return self.core.parameter_names

    def predict(self, parameters: Array, driven: Sequence[Driven]) -> list[Array]:
        """Friction readings, N, one array per run."""
        readings = self.core.predict(parameters, [d.motion for d in driven])
        return [d.at_samples(f) for d, f in zip(driven, readings, strict=True)]

    def jacobian(
        self, parameters: Array, driven: Sequence[Driven], which: Sequence[int]
    ) -> list[tuple[Array, Array]]:
        """Friction readings, and their derivatives with respect to the parameters `which`."""
        rows = self.core.jacobian(parameters, [d.motion for d in driven], which)
        return [(d.at_samples(f), d.at_samples(j)) for d, (f, j) in zip(driven, rows, strict=True)]

    def inner_steps(self, parameters: Array, driven: Sequence[Driven]) -> float:
        """Number of integration steps of a prediction along these motions."""
        return self.core.inner_steps(parameters, [d.motion for d in driven])

    def film_rate_1_s(self, parameters: Array, driven: Sequence[Driven]) -> float:
        """Largest relaxation rate of the film along these motions, 1/s."""
        return self.core.film_rate_1_s(parameters, [d.motion for d in driven])
