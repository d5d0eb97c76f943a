"""Selection and weights of samples for a model, by run.

The likelihood, the score tests and all tests of the residual structure of a model use the same
selection and weights. A sample is excluded in four cases. Within a few samples of a reversal, the
record does not determine the sign of the friction. Position and speed may contradict each other. At
rest, friction balances the force of the drive up to the breakaway level, and a law predicts no
value. The state of a contact or a film at the start of a run may be unknown. A model may exclude
more (`uncertain_samples`). A fit uses the weight of each sample; a test uses the included samples
only (`counted`).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from jbf.arrays import Array, Mask
from jbf.estimation.errors_in_motion import ErrorsInMotion, Whitening
from jbf.estimation.noise import WHITE, Noise, innovation_cost
from jbf.estimation.prepared import Prepared
from jbf.estimation.random_effects import Basis, RandomEffects
from jbf.estimation.settings import DEFAULT, Settings

T = TypeVar("T", bound=np.generic)


@dataclass(frozen=True, eq=False)
class Samples:
    """Included samples of a set of runs, with their weights; every tuple has one entry per run.

    Attributes
    ----------
    runs
        Names of the runs.
    steps_s
        Typical sampling interval of each run, s.
    counted
        True at the samples that tests, RMS and noise use, shape (n,).
    weight
        Weight of each sample in a fit, 0 to 1, shape (n,). The weight is 1 for an ordinary sample.
        It is smaller next to a jump whose time is fitted, and for a sample with larger noise.
    between
        Random effects of the runs; None if none are known.
    level
        Ratio of the smallest noise level to that of the sample, 0 to 1, shape (n,). It is one
        factor of `weight`; the others are for jumps and heavy-tailed noise. None for homoscedastic
        noise.
    motion
        Errors of the motion in the residuals; None where they are neglected.
    settings
        Settings of the statistics of these samples.
    """

    runs: tuple[str, ...]
    steps_s: tuple[float, ...]
    counted: tuple[Mask, ...]
    weight: tuple[Array, ...]
    between: RandomEffects | None = None
    level: tuple[Array, ...] | None = None
    motion: ErrorsInMotion | None = None
    settings: Settings = DEFAULT

    @classmethod
    def of(cls, prepared: Iterable[Prepared], settings: Settings = DEFAULT) -> Samples:
        """Select the samples with a known direction of sliding and a usable reading.

        Samples that depend on an unrecorded state (`Prepared.excluded`) are not selected.
        """
        prepared = tuple(prepared)
        counted = tuple(
            p.selectable if p.excluded is None else p.selectable & ~p.excluded for p in prepared
        )
        return cls(
            tuple(p.run.name for p in prepared),
            tuple(p.step_s for p in prepared),
            counted,
            tuple(c.astype(float) for c in counted),
            settings=settings,
        )

    @property
    def count(self) -> int:
        """Number of included samples in all runs."""
        return sum(int(c.sum()) for c in self.counted)

    # ---- parts ------------------------------------------------------------------------------

    def only(self, selection: Sequence[int]) -> Samples:
        """Return the samples of the runs with these indices."""
        return Samples(
            tuple(self.runs[i] for i in selection),
            tuple(self.steps_s[i] for i in selection),
            tuple(self.counted[i] for i in selection),
            tuple(self.weight[i] for i in selection),
            None if self.between is None else self.between.only(selection),
            None if self.level is None else tuple(self.level[i] for i in selection),
            None if self.motion is None else self.motion.only(selection),
            self.settings,
        )

    def within(self, masks: Sequence[Mask]) -> Samples:
        """Restrict the included samples to those that are True in the masks, one mask per run."""
        return replace(
            self,
            counted=tuple(c & m for c, m in zip(self.counted, masks, strict=True)),
            weight=tuple(w * m for w, m in zip(self.weight, masks, strict=True)),
        )

    def with_factors(self, factors: Sequence[Array], *, of_level: bool) -> Samples:
        """Return a copy with the weights multiplied by factors, one (n,) array per run.

        With `of_level`, a factor is proportional to 1 / (standard deviation of the noise) and also
        multiplies `level`. Otherwise it is a robust weight for heavy-tailed noise.
        """
        weight = tuple(w * f for w, f in zip(self.weight, factors, strict=True))
        level = self.level or tuple(np.ones(len(w)) for w in weight)
        if of_level:
            level = tuple(a * b for a, b in zip(level, factors, strict=True))
        return replace(self, weight=weight, level=level)

    def counted_only(self) -> Samples:
        """Return a copy with zero weight at the excluded samples, some of which a fit uses."""
        weight = tuple(np.where(c, w, 0.0) for c, w in zip(self.counted, self.weight, strict=True))
        return replace(self, weight=weight)

    # ---- sizes ------------------------------------------------------------------------------

    def flat(self, values: Sequence[npt.NDArray[T]]) -> npt.NDArray[T]:
        """Values of the included samples of all runs, concatenated."""
        return np.concatenate([v[c] for v, c in zip(values, self.counted, strict=True)])

    def rms(self, residuals: Sequence[Array]) -> float:
        """Root mean square of residuals over the included samples, N."""
        total = sum(float(np.sum(r[c] ** 2)) for r, c in zip(residuals, self.counted, strict=True))
        return float(np.sqrt(total / max(self.count, 1)))

    def square(self, residuals: Sequence[Array]) -> float:
        """Sum of squares of weighted residuals, N^2; whitened if the motion has errors."""
        if self.motion is not None:
            residuals = self._whitening.innovations(residuals)
            return sum(float(np.sum(r**2)) for r in residuals)
        return sum(float(np.sum((r * w) ** 2)) for r, w in zip(residuals, self.weight, strict=True))

    # ---- likelihood -------------------------------------------------------------------------

    @cached_property
    def _whitening(self) -> Whitening:
        """Filter of residuals with errors of the motion, which must be known."""
        assert self.motion is not None
        return self.motion.whitening(self.weight)

    def stacked(
        self,
        residuals: Sequence[Array],
        jacobian: Sequence[Array],
        noise: Noise,
        selection: Sequence[int] | None = None,
    ) -> tuple[Array, Array]:
        """Weighted innovations of all runs as one vector, and their Jacobian as one matrix.

        `selection` has the indices of the runs. A sample without weight is a gap: a zero is passed
        to the noise filter there.
        """
        runs = list(range(len(residuals)) if selection is None else selection)
        if self.motion is not None:
            bases = None if self.between is None else [self.basis(i, noise) for i in runs]
            return self._whitening.stacked(residuals, jacobian, runs, bases)
        r, j = [], []
        for i in runs:
            rows = [self._innovations_of(i, values[i], noise) for values in (residuals, jacobian)]
            if self.between is not None:
                basis = self.basis(i, noise)
                rows = [basis.whitened(values) for values in rows]
            r.append(rows[0])
            j.append(rows[1])
        return np.concatenate(r), np.concatenate(j)

    @property
    def _sigma_n(self) -> float:
        """Standard deviation of the innovations next to random effects, which are in the model."""
        assert self.between is not None
        return self.between.sigma_n if self.motion is None else self.motion.noise

    def _innovations_of(self, run: int, values: Array, noise: Noise) -> Array:
        """Weighted innovations of values (n,) or (n, k) of a run, at the samples with a weight."""
        weight = self.weight[run]
        if self.motion is not None:
            columns = values if values.ndim == 2 else values[:, None]
            (white,) = self._whitening.whitened([columns], [run])
            return white if values.ndim == 2 else white[:, 0]
        weighted = values * (weight if values.ndim == 1 else weight[:, None])
        return noise.innovations(weighted, self.steps_s[run])[weight > 0.0]

    def basis(self, run: int, noise: Noise) -> Basis:
        """Random effects of a run in its innovations; `between` must not be None."""
        assert self.between is not None
        known = self._bases.get(run)
        if known is None or (self.motion is None and known[0] != noise):
            direction = self._innovations_of(run, self.between.directions[run], noise)
            known = self._bases[run] = noise, Basis.of(direction / self._sigma_n)
        return known[1]

    @cached_property
    def _bases(self) -> dict[int, tuple[Noise, Basis]]:
        """Last noise model of each run, and the random effects in its innovations (`basis`)."""
        return {}

    def log_determinant_between(self, noise: Noise) -> float:
        """Log determinant of the correlation of all runs due to their random effects."""
        if self.between is None:
            return 0.0
        return sum(self.basis(i, noise).log_determinant for i in range(len(self.runs)))

    def whitened(
        self, residuals: Sequence[Array], noise: Noise, selection: Sequence[int] | None = None
    ) -> Array:
        """Weighted innovations as one vector, without a Jacobian (`stacked`)."""
        empty = [np.zeros((len(w), 0)) for w in self.weight]
        return self.stacked(residuals, empty, noise, selection)[0]

    def cost(self, residuals: Sequence[Array], noise: Noise) -> float:
        """Cost of residuals: ``n log(mean square innovation)``, -2 x log likelihood + constant."""
        if self.between is not None or self.motion is not None:
            r = self.whitened(residuals, noise)
            return len(r) * float(np.log(max(float(r @ r), 1e-300) / max(len(r), 1)))
        weighted = [r * w for r, w in zip(residuals, self.weight, strict=True)]
        return innovation_cost(noise, weighted, self.steps_s, [w > 0.0 for w in self.weight])

    def deviance(self, residuals: Sequence[Array]) -> float:
        """Minus twice the log likelihood with errors of the motion, up to an additive constant.

        The noise and the scale of these errors are given, and no delay is projected out.
        """
        assert self.motion is not None
        undelayed = replace(self, motion=replace(self.motion, by_delay=None))
        r = undelayed.whitened(residuals, WHITE)
        square = float(r @ r) / self.motion.noise**2
        return square + self._whitening.log_determinant + self.log_determinant_between(WHITE)

    def without_deviations(self, residuals: Sequence[Array], noise: Noise) -> list[Array]:
        """Residuals without the predicted random effects of their runs, N, one array per run."""
        if self.between is None:
            return list(residuals)
        without = []
        for i, r in enumerate(residuals):
            innovations = self._innovations_of(i, r, noise) / self._sigma_n
            sizes = self.basis(i, noise).predicted(innovations)
            without.append(r - self.between.directions[i] @ sizes)
        return without

    def weighted_innovations(self, residuals: Sequence[Array], noise: Noise) -> list[Array]:
        """Innovations of weighted residuals, one array per run; zero at samples without weight."""
        return self._innovations(residuals, noise, self.weight, [w > 0.0 for w in self.weight])

    def innovations(self, residuals: Sequence[Array], noise: Noise) -> list[Array]:
        """Innovations for tests, one array per run, scaled to the smallest noise level.

        They are zero at excluded samples.
        """
        weights = [c * w for c, w in zip(self.counted, self.weight, strict=True)]
        return self._innovations(residuals, noise, weights, self.counted)

    def plain_innovations(self, residuals: Sequence[Array], noise: Noise) -> list[Array]:
        """Innovations for tests of outliers: like `innovations`, but without robust weights."""
        level = [np.ones(len(c)) for c in self.counted] if self.level is None else self.level
        weights = [c * s for c, s in zip(self.counted, level, strict=True)]
        return self._innovations(residuals, noise, weights, self.counted)

    def _innovations(
        self,
        residuals: Sequence[Array],
        noise: Noise,
        weights: Sequence[Array],
        masks: Sequence[Mask],
    ) -> list[Array]:
        """Innovations of weighted residuals, one array per run; zero outside the masks."""
        residuals = self.without_deviations(residuals, noise)
        if self.motion is not None:
            same = weights is self.weight
            whitening = self._whitening if same else self.motion.whitening(weights)
            return whitening.innovations(residuals)
        return [
            noise.innovations(r * w, step) * m
            for r, w, m, step in zip(residuals, weights, masks, self.steps_s, strict=True)
        ]


def common_samples(a: Samples, b: Samples) -> Samples:
    """Combine the samples of two models of the same runs, with the smaller of their weights."""
    if a is b:
        return a
    return replace(
        a,
        counted=tuple(c & d for c, d in zip(a.counted, b.counted, strict=True)),
        weight=tuple(np.minimum(v, w) for v, w in zip(a.weight, b.weight, strict=True)),
    )
