"""Which samples count, how much, and in which run and block: decided once for a model, and taken by
its likelihood, its score tests and every test of what remains.

A record does not tell the sign of the friction within a few samples of a reversal, nor anything
where its path and its speed contradict one another: those samples count nowhere. A model may set
more of them aside (`jumps`). A fit gives each sample its weight; a test looks at those that count.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from jbf.estimation.noise import Noise, innovation_cost
from jbf.estimation.prepared import Prepared

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]
T = TypeVar("T", bound=np.generic)


@dataclass(frozen=True, eq=False)
class Samples:
    """The samples of some runs; every tuple has one entry a run.

    Attributes
    ----------
    runs
        Names of the runs.
    steps_s
        The usual step of each, s.
    counted
        True at the samples that tests, RMS and noise look at, shape (n,).
    weight
        What a fit gives each sample, 0 to 1, shape (n,): 1 where it counts, and less beside a
        jump whose instant is itself fitted.
    """

    runs: tuple[str, ...]
    steps_s: tuple[float, ...]
    counted: tuple[Mask, ...]
    weight: tuple[Array, ...]

    @classmethod
    def of(cls, prepared: Iterable[Prepared]) -> Samples:
        """Those at which the runs tell the sign of the friction."""
        prepared = tuple(prepared)
        counted = tuple(p.motion.sign_known for p in prepared)
        return cls(
            tuple(p.run.name for p in prepared),
            tuple(p.step_s for p in prepared),
            counted,
            tuple(c.astype(float) for c in counted),
        )

    @property
    def count(self) -> int:
        """How many count, in all runs."""
        return sum(int(c.sum()) for c in self.counted)

    # ---- parts ------------------------------------------------------------------------------

    def only(self, which: Sequence[int]) -> Samples:
        """The samples of some of the runs."""
        return Samples(
            tuple(self.runs[i] for i in which),
            tuple(self.steps_s[i] for i in which),
            tuple(self.counted[i] for i in which),
            tuple(self.weight[i] for i in which),
        )

    def within(self, masks: Sequence[Mask]) -> Samples:
        """Those of them that lie within masks, one a run."""
        return Samples(
            self.runs,
            self.steps_s,
            tuple(c & m for c, m in zip(self.counted, masks, strict=True)),
            tuple(w * m for w, m in zip(self.weight, masks, strict=True)),
        )

    def tested(self) -> Samples:
        """The same, those that do not count without weight in a fit."""
        weight = tuple(np.where(c, w, 0.0) for c, w in zip(self.counted, self.weight, strict=True))
        return Samples(self.runs, self.steps_s, self.counted, weight)

    def halves(self) -> tuple[Samples, Samples]:
        """The first and the second half of each run, to take turns in being left out."""
        first = [np.arange(len(c)) < len(c) // 2 for c in self.counted]
        return self.within(first), self.within([~half for half in first])

    # ---- sizes ------------------------------------------------------------------------------

    def flat(self, values: Sequence[npt.NDArray[T]]) -> npt.NDArray[T]:
        """One value a sample that counts, all runs in a row."""
        return np.concatenate([v[c] for v, c in zip(values, self.counted, strict=True)])

    def rms(self, residuals: Sequence[Array]) -> float:
        """Root mean square of residuals over the samples that count, N."""
        total = sum(float(np.sum(r[c] ** 2)) for r, c in zip(residuals, self.counted, strict=True))
        return float(np.sqrt(total / max(self.count, 1)))

    def square(self, residuals: Sequence[Array]) -> float:
        """Sum of squares of weighted residuals, N^2."""
        return sum(float(np.sum((r * w) ** 2)) for r, w in zip(residuals, self.weight, strict=True))

    # ---- likelihood -------------------------------------------------------------------------

    def stacked(
        self,
        residuals: Sequence[Array],
        jacobian: Sequence[Array],
        noise: Noise,
        which: Sequence[int] | None = None,
    ) -> tuple[Array, Array]:
        """One vector of weighted innovations, and one matrix of their derivatives (of some runs).

        A sample without weight is a gap: a zero there drives nothing.
        """
        r, j = [], []
        for i in range(len(residuals)) if which is None else which:
            w, step = self.weight[i], self.steps_s[i]
            keep = w > 0.0
            r.append(noise.innovations(residuals[i] * w, step)[keep])
            j.append(noise.innovations(jacobian[i] * w[:, None], step)[keep])
        return np.concatenate(r), np.concatenate(j)

    def cost(self, residuals: Sequence[Array], noise: Noise) -> float:
        """`n log(mean square innovation)`: minus twice the log likelihood, up to a constant."""
        weighted = [r * w for r, w in zip(residuals, self.weight, strict=True)]
        return innovation_cost(noise, weighted, self.steps_s, [w > 0.0 for w in self.weight])

    def weighted_innovations(self, residuals: Sequence[Array], noise: Noise) -> list[Array]:
        """Innovations of weighted residuals, one array a run; zero where there is no weight."""
        return [
            noise.innovations(r * w, step) * (w > 0.0)
            for r, w, step in zip(residuals, self.weight, self.steps_s, strict=True)
        ]

    def innovations(self, residuals: Sequence[Array], noise: Noise) -> list[Array]:
        """Innovations for tests, one array a run; zero where a sample does not count."""
        return [
            noise.innovations(r * c, step) * c
            for r, c, step in zip(residuals, self.counted, self.steps_s, strict=True)
        ]


def least_weights(a: Samples, b: Samples) -> Samples:
    """The samples of two models of the same runs, each with the smaller of its weights."""
    if a is b:
        return a
    return Samples(
        a.runs,
        a.steps_s,
        tuple(c & d for c, d in zip(a.counted, b.counted, strict=True)),
        tuple(np.minimum(v, w) for v, w in zip(a.weight, b.weight, strict=True)),
    )
