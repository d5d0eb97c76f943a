"""Score directions of candidate effects; the residual that no candidate can explain; decoys.

An autocorrelated residual has two causes: correlated noise, and effects that the model lacks. Only
noise reduces the number of independent samples. The residual of the richest model, which contains
all candidates, is the best estimate of the noise.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import fft, special

from jbf.arrays import Array
from jbf.estimation.least_squares import unexplained
from jbf.estimation.likelihood import independent_share
from jbf.estimation.samples import Samples
from jbf.estimation.variance import Places, blocks_of, significant_inflation

DECOY_DRAWS = 200
"""Number of decoy campaigns; not used in a verdict."""
SURE = 0.95
"""Confidence level of the reported upper limit of the false-name rate; not used in a verdict."""


@dataclass(frozen=True, eq=False)
class Directions:
    """Part of the Jacobian of an effect that the rest of the model cannot reproduce.

    The rows are those of the whitened likelihood (innovations), the columns the score directions of
    the parameters of the effect.

    Attributes
    ----------
    basis
        Orthonormal basis of this part, orthogonal to the Jacobian of the model without the effect,
        shape (n, k).
    innovations
        Innovations of the model without the effect, scaled to unit variance, shape (n,).
    inflation
        Ratio of the long-run variance of each score to its variance in white noise, shape (k,).
    blocks
        First row of each block of the wild bootstrap.
    run_starts
        First row of each run but the first.
    share
        Ratio of the effective number of samples to the number of samples.
    """

    basis: Array
    innovations: Array
    inflation: Array
    blocks: Places
    run_starts: Places
    share: float = 1.0

    @property
    def shares(self) -> Array:
        """Factors on the squared scores, below one in autocorrelated noise, shape (k,)."""
        return np.minimum(self.share, 1.0 / self.inflation)

    @classmethod
    def of(
        cls, innovations: Array, effect: Array, law: Array, samples: Samples, share: float
    ) -> Directions:
        """Compute the score directions of an effect from the whitened rows of a likelihood.

        `innovations`, shape (n,), are those of the model without the effect at the `samples`.
        `effect` and `law` are the derivatives with respect to the parameters of the effect, shape
        (n, k), and to those of the model without it. `share` is the effective number of samples
        divided by their number.
        """
        part = unexplained(law, effect)
        length = np.linalg.norm(part, axis=0)
        independent = length > 1e-8 * np.maximum(np.linalg.norm(effect, axis=0), 1e-300)
        basis = np.linalg.qr(part[:, independent] / length[independent])[0]
        run_starts = _run_starts(samples)
        unit = innovations / np.sqrt(max(float(np.mean(innovations**2)), 1e-300))
        parts, settings = np.split(unit, run_starts), samples.settings.variance
        inflation = [
            significant_inflation(np.split(column, run_starts), parts, samples.steps_s, settings)
            for column in basis.T
        ]
        return cls(basis, unit, np.array(inflation), blocks_of(samples, share), run_starts, share)

    def by_block(self, innovations: Array, blocks: Places) -> Array:
        """Sums of the scores of given innovations over each block, shape (blocks, k).

        The innovations, shape (n,), are the residual without the part that candidates could
        explain; `blocks` has the first row of each block. Scores have unit variance in noise with
        the assumed autocorrelation.
        """
        scores: Array = np.add.reduceat(self.basis * innovations[:, None], blocks, axis=0)
        return scores * np.sqrt(self.shares)


def _run_starts(samples: Samples) -> Places:
    """First row of each run but the first, among the samples with nonzero weight."""
    counts = [int(np.count_nonzero(w > 0.0)) for w in samples.weight]
    return np.asarray(np.cumsum(counts)[:-1], dtype=np.intp)


def largest_common_group(directions: list[Directions]) -> list[Directions]:
    """Largest group of candidates whose score directions refer to the same number of samples.

    A candidate that excludes samples cannot be tested on the residual of the others.
    """
    counts = Counter(len(d.basis) for d in directions)
    usual = max(counts, key=lambda count: (counts[count], count), default=0)
    return [d for d in directions if len(d.basis) == usual]


@dataclass(frozen=True, eq=False)
class RichestResidual:
    """Innovations of a model without the part that its candidates together can explain.

    Attributes
    ----------
    innovations
        Innovations of unit variance, all runs in one array, shape (n,).
    share
        Effective number of independent samples divided by their number, 0 to 1.
    """

    innovations: Array
    share: float

    @classmethod
    def of(cls, directions: Sequence[Directions], samples: Samples) -> RichestResidual | None:
        """Remove the span of all score directions from the innovations; None without a direction.

        `samples` are those of the model to which the candidates were added.
        """
        tested = largest_common_group([d for d in directions if d.basis.size])
        if not tested:
            return None
        every = np.column_stack([d.basis for d in tested])
        noise = tested[0].innovations - _explained(every, tested[0].innovations)
        noise /= np.sqrt(max(float(np.mean(noise**2)), 1e-300))
        parts = np.split(noise, tested[0].run_starts)
        return cls(noise, independent_share(parts, samples.steps_s, samples.settings.noise))


def _explained(columns: Array, target: Array) -> Array:
    """Projection of `target` on the span of unit `columns`, which may be collinear."""
    size, axes = np.linalg.eigh(columns.T @ columns)
    resolved = size > 1e-12 * size[-1]
    step = axes[:, resolved] @ ((axes[:, resolved].T @ (columns.T @ target)) / size[resolved])
    explained: Array = columns @ step
    return explained


def decoy_gains(directions: Sequence[Directions]) -> list[Array]:
    """Gains of decoy candidates in twice the log likelihood, shape (`DECOY_DRAWS`,) for each.

    The signature of a candidate is shifted circularly by a random lag along each run. It keeps its
    spectrum but not its phase. Its gain on the residual is therefore due to chance, even if the
    runs contain recording artefacts. The fraction of draws in which any candidate would have been
    named is the false-name rate on the data of the user (target-decoy search: Elias & Gygi 2007;
    surrogates: Theiler et al. 1992).
    """
    random = np.random.default_rng(DECOY_DRAWS)
    gains = []
    for one in directions:
        scores = np.zeros((DECOY_DRAWS, one.basis.shape[1]))
        parts = (np.split(rows, one.run_starts) for rows in (one.basis, one.innovations))
        for column, noise in zip(*parts, strict=True):
            n = len(noise)
            if n == 0:
                continue
            # All shifts together: a circular correlation is a product in the frequency domain.
            products = fft.rfft(noise)[:, None] * np.conj(fft.rfft(column, axis=0))
            by_shift = fft.irfft(products, n, axis=0)
            scores += by_shift[random.integers(0, n, DECOY_DRAWS)]
        gains.append(np.sum(scores**2 * one.shares, axis=1))
    return gains


def rate_below(named: int, draws: int) -> float:
    """Upper confidence limit of a rate of `named` in `draws` draws (Clopper & Pearson 1934)."""
    return float(special.betaincinv(named + 1, draws - named, SURE)) if named < draws else 1.0
