"""Strength from which an effect is distinguishable from every other effect.

The unexplained part of an effect is the change of the record that a rival's parameters cannot
reproduce. Its sum of squares, in units of the noise variance, is the expected difference between
the two gains. The difference of the gains is
normally distributed with a variance of four times its mean. An effect is identified alone where it
is detected and no rival comes close to its gain.

Where one of the two effects moves jumps, the samples next to these jumps do not distinguish them.
Both effects are then compared on the samples that both use.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt
from scipy import optimize, special

from jbf.diagnosis.strength import RunsAtHand
from jbf.estimation.likelihood import spanned

Array = npt.NDArray[np.float64]

EVERY = slice(None)
NEVER = 30.0
"""Multiple of the detectable strength from which two effects count as indistinguishable.

It enters no verdict.
"""
MOST = 9.0
"""Limit of the squared change of one sample, in units of the noise variance.

A single larger change is no evidence of a law. It is an outlier, or the uncertain instant of a
reversal. It enters no verdict.
"""


def bounded_square(left: Array) -> float:
    """Sum of squares of the unexplained part of a change, in units of the noise variance.

    The contribution of each sample is limited to `MOST`.
    """
    # Limit before squaring: with almost no noise the square would overflow.
    return float(np.sum(np.minimum(np.abs(left), np.sqrt(MOST)) ** 2))


@dataclass(frozen=True, eq=False)
class Change:
    """Change of the record by an effect of given strength, and its parameter derivatives.

    Attributes
    ----------
    ways
        Change in N, one (n, 2 + k) array per run. The columns are the change, the change at a
        larger strength, and the derivative with respect to each parameter. Samples next to jumps
        that the effect moves are scaled by their weights.
    shares
        Weights of the samples, one (n,) array per run; None where the effect does not change them.
    shown
        The part of `ways` that the rest of the model cannot reproduce, in units of the noise.
    """

    ways: list[Array]
    shares: list[Array] | None
    shown: Array

    @cached_property
    def span(self) -> Array:
        """Orthonormal columns that span `shown`."""
        return spanned(self.shown)

    def on_shared_samples(self, other: Change, runs: RunsAtHand, columns: slice = EVERY) -> Array:
        """`shown` on the samples that another effect also uses, for selected columns."""
        if other.shares is None:
            return self.shown[:, columns]
        own = [np.ones(len(s)) for s in other.shares] if self.shares is None else self.shares
        less = [
            np.divide(np.minimum(a, b), a, out=np.zeros_like(a), where=a > 0.0)
            for a, b in zip(own, other.shares, strict=True)
        ]
        return runs.shown(
            [w[:, columns] * s[:, None] for w, s in zip(self.ways, less, strict=True)]
        )


def distinguishable_size(own: Change, rival: Change, runs: RunsAtHand) -> float:
    """Size of the part of an effect that a rival cannot reproduce, in units of the noise."""
    change = own.on_shared_samples(rival, runs, slice(1))[:, 0]
    span = rival.span if own.shares is None else spanned(rival.on_shared_samples(own, runs))
    return float(np.sqrt(bounded_square(change - span @ (span.T @ change))))


def distinction_probability(left: float, least: float) -> float:
    """Probability that the gain of an effect exceeds that of a rival by more than `least`.

    Parameters
    ----------
    left
        Size of the part of the effect that the rival cannot reproduce, in units of the noise.
    least
        Required difference of the gains.
    """
    if left <= 0.0:
        return 0.0
    return float(special.ndtr((left**2 - least) / (2.0 * left)))


def detection_probability(price: float | Array, parameters: int, non_centrality: float) -> Array:
    """Probability that a noncentral chi-square variable exceeds each of the given thresholds."""
    return np.asarray(1.0 - special.chndtr(price, parameters, non_centrality), dtype=np.float64)


def distinction_factor(
    price: float,
    parameters: int,
    non_centrality: float,
    rivals: Mapping[str, tuple[float, float]],
    chance: float,
) -> float:
    """Factor on the strength from which an effect is detected and distinguished from all rivals.

    Parameters
    ----------
    non_centrality
        Non-centrality at the present strength; it grows with the square of the strength.
    rivals
        For each rival, the part of the effect that it cannot reproduce, in units of the noise, and
        the required difference of the gains.
    chance
        Required probability of detection and distinction.

    Returns
    -------
    float
        The factor, at least 1; infinite where it would exceed `NEVER`.
    """

    def surplus(times: float) -> float:
        # Close rivals leave the same part unexplained: only the closest one matters.
        told = min(
            (distinction_probability(times * left, least) for left, least in rivals.values()),
            default=1.0,
        )
        found = float(detection_probability(price, parameters, times**2 * non_centrality))
        return found * told - chance

    if surplus(1.0) >= 0.0:
        return 1.0
    if surplus(NEVER) < 0.0:
        return np.inf
    return float(optimize.brentq(surplus, 1.0, NEVER, xtol=1e-3))
