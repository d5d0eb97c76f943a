"""The log predictive density of samples that were left out of a fit.

An error of a prediction tells against a model as far as the model claims to know better. What the
other runs leave open of the parameters makes a prediction uncertain, in directions that the
derivatives name: an error along them tells little, and a model pays for being so uncertain by the
determinant of its covariance (Geisser & Eddy 1979; Bjornstad 1990).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from jbf.estimation.left_out import INSENSITIVE, LeftOut
from jbf.estimation.noise import Noise
from jbf.estimation.samples import Samples
from jbf.estimation.solution import Solution

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]


def mean_square(solution: Solution, samples: Samples, noise: Noise) -> tuple[float, int]:
    """Of the innovations in the fit, N^2; and how many there are."""
    empty = [np.zeros((len(r), 0)) for r in solution.residuals]
    r, _ = samples.stacked(solution.residuals, empty, noise)
    return float(r @ r) / max(len(r), 1), len(r)


@dataclass(frozen=True)
class _Rows:
    """What samples that were left out say: the squares of their errors, what those have of each
    derivative, and the derivatives' own products; in few numbers of many rows."""

    square: float
    pull: Array
    products: Array
    told: Mask

    @classmethod
    def of(cls, part: LeftOut, solution: Solution, samples: Samples, noise: Noise) -> _Rows:
        own = [solution.jacobian[i] for i in part.runs]
        e, j = samples.only(part.runs).stacked(part.residuals, own, noise)
        # Cut after the whitening: a half's first innovation knows the sample before it.
        weight = [samples.weight[i] > 0.0 for i in part.runs]
        left = np.concatenate([m[w] for m, w in zip(part.left, weight, strict=True)])
        e, j = e[left], j[left]
        return cls(float(e @ e), j.T @ e, j.T @ j, part.told)


def surprise(
    solution: Solution,
    parts: Sequence[LeftOut],
    samples: Samples,
    noise: Noise,
    variance: float,
) -> float:
    """Minus twice the log predictive density of all parts, up to what is the same of every model
    of these samples.

    Parameters
    ----------
    parts
        What was left out of fits near the solution, whose derivatives are taken; each sample in one
        of them.
    samples, noise
        The weight of each sample, and what whitens residuals: those of all models compared.
    variance
        Of the innovations, N^2.
    """
    rows = [_Rows.of(part, solution, samples, noise) for part in parts]
    whole = np.sum([own.products for own in rows], axis=0)
    size = np.sqrt(np.diag(whole))
    size[size <= 0.0] = 1.0
    return sum(_of(own, whole, size, variance) for own in rows)


def _of(rows: _Rows, whole: Array, size: Array, variance: float) -> float:
    told = rows.told
    scale = np.outer(size[told], size[told])
    # What nobody else knows is known to a hundred times its error in the end.
    known = whole[np.ix_(told, told)] / scale + INSENSITIVE * np.eye(len(scale))
    before = known - rows.products[np.ix_(told, told)] / scale
    pull = rows.pull[told] / size[told]
    square = rows.square - float(pull @ np.linalg.solve(known, pull))
    _, after_det = np.linalg.slogdet(known)
    _, before_det = np.linalg.slogdet(before)
    return square / variance + float(after_det - before_det)
