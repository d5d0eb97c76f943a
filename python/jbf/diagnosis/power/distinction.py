"""Strength from which an effect is distinguishable from every other effect.

The unexplained part of an effect is the change of the record that the parameters of a rival cannot
reproduce. Its sum of squares, in units of the noise variance, is the expected difference between
the two gains. The difference of the gains is normally distributed with a variance of four times its
mean. An effect is distinguishable if it is detected and its gain exceeds that of every rival by the
required difference.

An effect such as backlash shifts the instants at which friction jumps. Its model excludes the
samples next to these jumps, or reduces their weights. Two effects are compared with the smaller of
their weights at each sample, that is, on the samples that both models use.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import optimize, special

from jbf.arrays import Array
from jbf.diagnosis.power.strength import PresentRuns, Strength
from jbf.estimation.least_squares import spanned

ALL_COLUMNS = slice(None)
NEVER = 30.0
"""Multiple of the detectable strength from which two effects count as indistinguishable."""
MOST = 9.0
"""Largest squared change of one sample that is included, in units of the noise variance.

A single larger change is not evidence of a law. It is an outlier, or the uncertain instant of a
reversal. It enters no verdict.
"""
FURTHER = 2.0
"""Factor on the detectable strength at which the change by a rival is also evaluated.

The shape of its change is different there where it is not proportional to the strength. It enters
no verdict.
"""


def bounded_square(change: Array) -> float:
    """Sum of squares of a change, in units of the noise; each sample contributes at most `MOST`."""
    # Limit before squaring: with almost no noise the square would overflow.
    return float(np.sum(np.minimum(np.abs(change), np.sqrt(MOST)) ** 2))


@dataclass(frozen=True, eq=False)
class Change:
    """Change of the predicted friction by an effect of given strength, and its Jacobian.

    Attributes
    ----------
    columns
        Change in the unit of the force, one (n, 2 + k) array per run. The columns are the change,
        the change at `FURTHER` times the strength, and the derivative with respect to each
        parameter. Samples next to jumps that the effect moves are scaled by their weights.
    shares
        Weights of the samples, one (n,) array per run; None if the effect does not change them.
    unexplained
        The part of `columns` that the rest of the model cannot reproduce, in units of the noise.
    """

    columns: list[Array]
    shares: list[Array] | None
    unexplained: Array

    @classmethod
    def of(cls, runs: PresentRuns, model: Strength, times: float) -> Change:
        """Compute the change of the friction by an effect at a multiple of its typical strength."""
        shares, change = runs.shares(model, times), runs.change(model, times)
        slopes = runs.slopes_of(model, times)
        further = runs.change(model, FURTHER * times)
        columns = [np.column_stack(parts) for parts in zip(change, further, slopes, strict=True)]
        return cls(columns, shares, runs.unexplained(columns))

    @cached_property
    def span(self) -> Array:
        """Orthonormal basis of the columns of `unexplained`."""
        return spanned(self.unexplained)

    def on_shared_samples(
        self, other: Change, runs: PresentRuns, columns: slice = ALL_COLUMNS
    ) -> Array:
        """Selected columns of `unexplained` on the samples that another effect also uses."""
        if other.shares is None:
            return self.unexplained[:, columns]
        shares = [np.ones(len(s)) for s in other.shares] if self.shares is None else self.shares
        ratios = [
            np.divide(np.minimum(a, b), a, out=np.zeros_like(a), where=a > 0.0)
            for a, b in zip(shares, other.shares, strict=True)
        ]
        return runs.unexplained(
            [c[:, columns] * s[:, None] for c, s in zip(self.columns, ratios, strict=True)]
        )


def distinguishable_size(effect: Change, rival: Change, runs: PresentRuns) -> float:
    """Norm of the part of an effect that a rival cannot reproduce, in units of the noise."""
    change = effect.on_shared_samples(rival, runs, slice(1))[:, 0]
    span = rival.span if effect.shares is None else spanned(rival.on_shared_samples(effect, runs))
    return float(np.sqrt(bounded_square(change - span @ (span.T @ change))))


def distinction_probability(size: float, least: float) -> float:
    """Probability that the gain of an effect exceeds that of a rival by more than `least`.

    `size` is the norm of the part of the effect that the rival cannot reproduce, in units of the
    noise.
    """
    if size <= 0.0:
        return 0.0
    return float(special.ndtr((size**2 - least) / (2.0 * size)))


def detection_probability(
    price: float | Array, parameters: int, non_centrality: float | Array
) -> Array:
    """Probability that a gain exceeds its threshold `price`, in twice the log likelihood.

    The gain is a noncentral chi-square variable; `parameters` is its number of degrees of freedom.
    Arrays are evaluated element by element.
    """
    return np.asarray(1.0 - special.chndtr(price, parameters, non_centrality), dtype=np.float64)


def distinction_factor(
    price: float,
    parameters: int,
    non_centrality: float,
    rivals: Mapping[str, tuple[float, float]],
    chance: float,
) -> float:
    """Factor on the strength from which an effect is detected and distinguished from all rivals.

    The effect has the threshold `price`, a number of parameters, and a non-centrality at the
    present strength, which grows with the square of the strength. For each rival, `rivals` has the
    norm of the part of the effect that it cannot reproduce, in units of the noise, and the required
    difference of the gains. `chance` is the required probability of detection and distinction.

    The factor is at least 1, and infinite where it would exceed `NEVER`.
    """

    def surplus(times: float) -> float:
        """Excess of the joint probability at `times` the strength over the required one."""
        # The rivals that are hard to distinguish have a common unexplained part: only the least
        # distinguishable one is used.
        distinguished = min(
            (distinction_probability(times * size, least) for size, least in rivals.values()),
            default=1.0,
        )
        detected = float(detection_probability(price, parameters, times**2 * non_centrality))
        return detected * distinguished - chance

    if surplus(1.0) >= 0.0:
        return 1.0
    if surplus(NEVER) < 0.0:
        return np.inf
    return float(optimize.brentq(surplus, 1.0, NEVER, xtol=1e-3))
