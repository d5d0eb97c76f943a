"""Which samples count, how much, and in which run and block: decided once for a model, and taken by
its likelihood, its score tests and every test of what remains.

A record does not tell the sign of the friction within a few samples of a reversal, nor anything
where its path and its speed contradict one another: those samples count nowhere. At rest friction
balances whatever the drive holds, up to the breakaway level: a law predicts no value there, and
those samples do not count either. A model may set more of them aside (`jumps`). A fit gives each
sample its weight; a test looks at those that count.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from jbf.estimation.between_runs import BetweenRuns
from jbf.estimation.errors_in_motion import ErrorsInMotion
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
        jump whose instant is itself fitted, or where the noise is larger than usual.
    between
        What differs from run to run; None where nothing is known to.
    level
        How much smaller than here the noise is where it is least, 0 to 1, shape (n,): a part of
        `weight`, whose rest is of jumps and of heavy tails. None where the noise is even.
    motion
        Errors of the motion in the residuals; None where they are neglected.
    """

    runs: tuple[str, ...]
    steps_s: tuple[float, ...]
    counted: tuple[Mask, ...]
    weight: tuple[Array, ...]
    between: BetweenRuns | None = None
    level: tuple[Array, ...] | None = None
    motion: ErrorsInMotion | None = None

    @classmethod
    def of(cls, prepared: Iterable[Prepared]) -> Samples:
        """Select the samples that slide in a known direction and have a usable reading."""
        prepared = tuple(prepared)
        counted = tuple(p.slides & p.examined.usable for p in prepared)
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
            None if self.between is None else self.between.only(which),
            None if self.level is None else tuple(self.level[i] for i in which),
            None if self.motion is None else self.motion.only(which),
        )

    def within(self, masks: Sequence[Mask]) -> Samples:
        """Those of them that lie within masks, one a run."""
        return replace(
            self,
            counted=tuple(c & m for c, m in zip(self.counted, masks, strict=True)),
            weight=tuple(w * m for w, m in zip(self.weight, masks, strict=True)),
        )

    def weighed(
        self,
        level: Sequence[Array],
        robust: Sequence[Array],
        between: BetweenRuns | None,
    ) -> Samples:
        """The same with the noise's own level at each sample, a share against heavy tails, and with
        what differs from run to run."""
        weight = tuple(w * s * h for w, s, h in zip(self.weight, level, robust, strict=True))
        before = [np.ones(len(w)) for w in weight] if self.level is None else self.level
        whole = tuple(a * b for a, b in zip(before, level, strict=True))
        return replace(self, weight=weight, between=between, level=whole)

    def with_known_motion(self) -> Samples:
        """The samples at which the variance by the motion's errors is at most that of the noise."""
        if self.motion is None:
            return self
        return self.within([self.motion.variance_ratio(i) <= 1.0 for i in range(len(self.runs))])

    def tested(self) -> Samples:
        """The same, those that do not count without weight in a fit."""
        weight = tuple(np.where(c, w, 0.0) for c, w in zip(self.counted, self.weight, strict=True))
        return replace(self, weight=weight)

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
        if self.motion is not None:
            return self.motion.stacked(residuals, jacobian, self.weight, which)
        r, j = [], []
        for i in range(len(residuals)) if which is None else which:
            w, step = self.weight[i], self.steps_s[i]
            keep = w > 0.0
            own = [
                noise.innovations(residuals[i] * w, step)[keep],
                noise.innovations(jacobian[i] * w[:, None], step)[keep],
            ]
            if self.between is not None:
                own = self.between.whitened(i, own, w, step, noise)
            r.append(own[0])
            j.append(own[1])
        return np.concatenate(r), np.concatenate(j)

    def cost(self, residuals: Sequence[Array], noise: Noise) -> float:
        """`n log(mean square innovation)`: minus twice the log likelihood, up to a constant."""
        if self.between is not None or self.motion is not None:
            empty = [np.zeros((len(r), 0)) for r in residuals]
            r, _ = self.stacked(residuals, empty, noise)
            return len(r) * float(np.log(max(float(r @ r), 1e-300) / max(len(r), 1)))
        weighted = [r * w for r, w in zip(residuals, self.weight, strict=True)]
        return innovation_cost(noise, weighted, self.steps_s, [w > 0.0 for w in self.weight])

    def weighted_innovations(self, residuals: Sequence[Array], noise: Noise) -> list[Array]:
        """Innovations of weighted residuals, one array a run; zero where there is no weight."""
        left = self.without_deviations(residuals, noise)
        if self.motion is not None:
            return self.motion.innovations(left, self.weight)
        return [
            noise.innovations(r * w, step) * (w > 0.0)
            for r, w, step in zip(left, self.weight, self.steps_s, strict=True)
        ]

    def without_deviations(self, residuals: Sequence[Array], noise: Noise) -> list[Array]:
        """Residuals less what the deviations of their runs predict, N."""
        if self.between is None:
            return list(residuals)
        return [
            r - self.between.predicted(i, r, self.weight[i], self.steps_s[i], noise)
            for i, r in enumerate(residuals)
        ]

    def innovations(self, residuals: Sequence[Array], noise: Noise) -> list[Array]:
        """Innovations for tests, one array a run, as large everywhere as where the noise is least;
        zero where a sample does not count."""
        left = self.without_deviations(residuals, noise)
        if self.motion is not None:
            pairs = zip(self.counted, self.weight, strict=True)
            return self.motion.innovations(left, [c * w for c, w in pairs])
        return [
            noise.innovations(r * (c * w), step) * c
            for r, c, w, step in zip(left, self.counted, self.weight, self.steps_s, strict=True)
        ]

    def plain_innovations(self, residuals: Sequence[Array], noise: Noise) -> list[Array]:
        """The same, large ones as large as they are: for tests of those very ones."""
        left = self.without_deviations(residuals, noise)
        level = [np.ones(len(r)) for r in left] if self.level is None else self.level
        if self.motion is not None:
            pairs = zip(self.counted, level, strict=True)
            return self.motion.innovations(left, [c * s for c, s in pairs])
        return [
            noise.innovations(r * (c * s), step) * c
            for r, c, s, step in zip(left, self.counted, level, self.steps_s, strict=True)
        ]


def least_weights(a: Samples, b: Samples) -> Samples:
    """The samples of two models of the same runs, each with the smaller of its weights."""
    if a is b:
        return a
    return replace(
        a,
        counted=tuple(c & d for c, d in zip(a.counted, b.counted, strict=True)),
        weight=tuple(np.minimum(v, w) for v, w in zip(a.weight, b.weight, strict=True)),
    )
