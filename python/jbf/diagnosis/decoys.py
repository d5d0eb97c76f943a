"""Decoy candidates: circularly shifted signatures that the true friction cannot contain.

The signature of a candidate is shifted circularly by a random lag along each run. It keeps its
spectrum but not its phase. Its gain on the residual is therefore due to chance, even if the runs
contain recording artefacts. The fraction of draws in which any candidate would have been named is
the false-name rate on the data of the user (target-decoy search: Elias & Gygi 2007; surrogates:
Theiler et al. 1992).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
from scipy import fft, special

if TYPE_CHECKING:
    from jbf.diagnosis.directions import Directions

Array = npt.NDArray[np.float64]

DRAWS = 200
"""Number of decoy campaigns; not used in a verdict."""
SURE = 0.95
"""Confidence level of the reported upper limit of the rate; not used in a verdict."""


def decoy_gains(directions: Sequence[Directions]) -> list[Array]:
    """Gain of each decoy candidate in each of `DRAWS` random shifts.

    Parameters
    ----------
    directions
        Score directions of the candidates.

    Returns
    -------
    list of arrays
        Gains in twice the log likelihood, one array of shape (`DRAWS`,) per candidate.
    """
    random = np.random.default_rng(DRAWS)
    return [_gains(one, random) for one in directions]


def _gains(one: Directions, random: np.random.Generator) -> Array:
    """Gains of one candidate in twice the log likelihood, for random shifts, shape (`DRAWS`,)."""
    scores = np.zeros((DRAWS, one.basis.shape[1]))
    for column, noise in zip(
        np.split(one.basis, one.run_starts), np.split(one.innovations, one.run_starts), strict=True
    ):
        n = len(noise)
        if n == 0:
            continue
        # Compute all shifts together: a circular correlation is a product in the frequency domain.
        products = fft.rfft(noise)[:, None] * np.conj(fft.rfft(column, axis=0))
        by_shift = fft.irfft(products, n, axis=0)
        scores += by_shift[random.integers(0, n, DRAWS)]
    gains: Array = np.sum(scores**2 * one.shares, axis=1)
    return gains


def rate_below(named: int, draws: int) -> float:
    """Upper confidence limit of a rate of `named` in `draws` draws (Clopper & Pearson 1934)."""
    return float(special.betaincinv(named + 1, draws - named, SURE)) if named < draws else 1.0
