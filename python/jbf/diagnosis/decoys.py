"""Decoys: candidates in the wrong place, which nothing in the runs can ask for.

The shape in which a candidate would show is shifted at random along each run, its end put before
its beginning. It keeps its spectrum and loses its phase: what the residual of these very runs makes
it gain is chance, whatever the recording did to them. How often one of all the candidates would
have got a name so is the rate of false names on the user's own data (target-decoy search: Elias &
Gygi 2007; surrogates: Theiler et al. 1992).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
from scipy import fft, special

if TYPE_CHECKING:
    from jbf.diagnosis.level import Directions

Array = npt.NDArray[np.float64]

DRAWS = 200
"""Campaigns of decoys."""
SURE = 0.95
"""How sure the largest rate is that is said."""


def decoy_gains(directions: Sequence[Directions]) -> list[Array]:
    """What each candidate's decoys gain in twice the log likelihood, shape (`DRAWS`,)."""
    random = np.random.default_rng(DRAWS)
    return [_gains(one, random) for one in directions]


def _gains(one: Directions, random: np.random.Generator) -> Array:
    scores = np.zeros((DRAWS, one.ways.shape[1]))
    for way, noise in zip(
        np.split(one.ways, one.ends), np.split(one.innovations, one.ends), strict=True
    ):
        n = len(noise)
        if n == 0:
            continue
        # All shifts at once: the correlation with one is a product in the frequency domain.
        products = fft.rfft(noise)[:, None] * np.conj(fft.rfft(way, axis=0))
        by_shift = fft.irfft(products, n, axis=0)
        scores += by_shift[random.integers(0, n, DRAWS)]
    gains: Array = np.sum(scores**2 * one.counted, axis=1)
    return gains


def rate_below(named: int, draws: int) -> float:
    """The largest rate at which so few of so many still happen (Clopper & Pearson 1934)."""
    return float(special.betaincinv(named + 1, draws - named, SURE)) if named < draws else 1.0
