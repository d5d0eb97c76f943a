"""Log predictive density of samples that were held out of a fit.

A prediction error counts against a model to the extent that the model claims precision. The
uncertainty of the parameters after a fit to the other runs makes a prediction uncertain in the
directions of its derivatives. An error in these directions has little weight. The model pays for
this uncertainty by the determinant of its covariance (Geisser & Eddy 1979; Bjornstad 1990).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from jbf.estimation.left_out import HeldOutPart
from jbf.estimation.noise import Noise
from jbf.estimation.samples import Samples
from jbf.estimation.solution import Solution

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]


def mean_square(solution: Solution, samples: Samples, noise: Noise) -> tuple[float, int]:
    """Mean square of the innovations of the fit, N^2, and their number."""
    empty = [np.zeros((len(r), 0)) for r in solution.residuals]
    r, _ = samples.stacked(solution.residuals, empty, noise)
    return float(r @ r) / max(len(r), 1), len(r)


@dataclass(frozen=True)
class _Rows:
    """Sums over held-out samples that determine their predictive density.

    They are the squared errors, the products of errors and derivatives, and the products of the
    derivatives.
    """

    square: float
    pull: Array
    products: Array
    determined: Mask

    @classmethod
    def of(cls, part: HeldOutPart, solution: Solution, samples: Samples, noise: Noise) -> _Rows:
        own = [solution.jacobian[i] for i in part.runs]
        e, j = samples.only(part.runs).stacked(part.residuals, own, noise)
        # Select after the whitening: the first innovation of a half depends on the sample before
        # it.
        weight = [samples.weight[i] > 0.0 for i in part.runs]
        left = np.concatenate([m[w] for m, w in zip(part.left, weight, strict=True)])
        e, j = e[left], j[left]
        return cls(float(e @ e), j.T @ e, j.T @ j, part.determined)


def surprise(
    solution: Solution,
    parts: Sequence[HeldOutPart],
    samples: Samples,
    noise: Noise,
    variance: float,
) -> float:
    """Minus twice the log predictive density of all parts, up to a constant common to all models.

    Parameters
    ----------
    solution
        Solution whose derivatives are used.
    parts
        Held-out parts of fits near the solution; each sample is in one of them.
    samples, noise
        Weights of the samples, and the noise model for whitening, common to all compared models.
    variance
        Variance of the innovations, N^2.
    """
    rows = [_Rows.of(part, solution, samples, noise) for part in parts]
    whole = np.sum([own.products for own in rows], axis=0)
    size = np.sqrt(np.diag(whole))
    size[size <= 0.0] = 1.0
    least = samples.settings.held_out.min_information
    return sum(_of(own, whole, size, variance, least) for own in rows)


def _of(rows: _Rows, whole: Array, size: Array, variance: float, least: float) -> float:
    determined = rows.determined
    scale = np.outer(size[determined], size[determined])
    # A parameter that no other run determines has a prior of a hundred times its final error.
    known = whole[np.ix_(determined, determined)] / scale + least * np.eye(len(scale))
    before = known - rows.products[np.ix_(determined, determined)] / scale
    pull = rows.pull[determined] / size[determined]
    square = rows.square - float(pull @ np.linalg.solve(known, pull))
    _, after_det = np.linalg.slogdet(known)
    _, before_det = np.linalg.slogdet(before)
    return square / variance + float(after_det - before_det)
