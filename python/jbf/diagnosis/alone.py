"""How strong an effect must be for no other one to stand in its place.

What an effect changes that a rival's parameters cannot make up for is, in squares of the noise, how
much more it gains than that rival on average; the difference of two gains is normal, with four
times its mean as variance. An effect is named alone where it is found, and no rival comes near.

Where one of the two moves jumps, samples beside those tell neither of them: both are compared by
the samples that both leave.
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
"""Times the strength that shows an effect from which on two effects are one in these runs."""
MOST = 9.0
"""Square, in noises, from which on a sample tells no more: one that stands out alone is no evidence
of a law but a bad sample, or an instant of reversal that nobody knows."""


def worth(left: Array) -> float:
    """What is told by what is left of a change, in units of the noise."""
    # Of what stands far above no noise at all the square would overflow.
    return float(np.sum(np.minimum(np.abs(left), np.sqrt(MOST)) ** 2))


@dataclass(frozen=True, eq=False)
class Change:
    """What an effect changes at some strength, and how that changes with its parameters.

    Attributes
    ----------
    ways
        N, one (n, 2 + k) a run: what it changes, what it changes when it is stronger, and what each
        of its parameters changes; the samples beside jumps that it moves with what they count.
    shares
        What samples count, one (n,) a run; None where the effect leaves them as they are.
    shown
        `ways` apart from what the rest of the model makes up for, in units of the noise.
    """

    ways: list[Array]
    shares: list[Array] | None
    shown: Array

    @cached_property
    def span(self) -> Array:
        """Orthonormal columns that span `shown`."""
        return spanned(self.shown)

    def beside(self, other: Change, runs: RunsAtHand, columns: slice = EVERY) -> Array:
        """`shown` by the samples that another effect leaves as well; of some of the ways."""
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


def left_apart(own: Change, rival: Change, runs: RunsAtHand) -> float:
    """What of an effect another one cannot make up for, in units of the noise."""
    change = own.beside(rival, runs, slice(1))[:, 0]
    span = rival.span if own.shares is None else spanned(rival.beside(own, runs))
    return float(np.sqrt(worth(change - span @ (span.T @ change))))


def chance_apart(left: float, least: float) -> float:
    """The chance that an effect gains so much more than a rival that leaves so much of it."""
    if left <= 0.0:
        return 0.0
    return float(special.ndtr((left**2 - least) / (2.0 * left)))


def chance_found(price: float | Array, parameters: int, non_centrality: float) -> Array:
    """The chance that a chi-square of that non-centrality exceeds a price, or each of some."""
    return np.asarray(1.0 - special.chndtr(price, parameters, non_centrality), dtype=np.float64)


def times_alone(
    price: float,
    parameters: int,
    non_centrality: float,
    rivals: Mapping[str, tuple[float, float]],
    chance: float,
) -> float:
    """How many times as strong an effect must be to be found and told from every rival so often;
    infinite where it never is.

    Parameters
    ----------
    non_centrality
        Of the effect as it is; it grows as the square.
    rivals
        What each leaves of the effect, and by how much the effect must gain more.
    """

    def lacking(times: float) -> float:
        # Rivals that leave little leave the same: where the nearest one is told, so are others.
        told = min(
            (chance_apart(times * left, least) for left, least in rivals.values()), default=1.0
        )
        found = float(chance_found(price, parameters, times**2 * non_centrality))
        return found * told - chance

    if lacking(1.0) >= 0.0:
        return 1.0
    if lacking(NEVER) < 0.0:
        return np.inf
    return float(optimize.brentq(lacking, 1.0, NEVER, xtol=1e-3))
