"""The log predictive density of samples that were left out of a fit.

An error of a prediction tells against a model as far as the model claims to know better. What the
other runs leave open of the parameters makes a prediction uncertain, in directions that the
derivatives name: an error along them tells little, and a model pays for being so uncertain by the
determinant of its covariance (Geisser & Eddy 1979; Bjornstad 1990).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from jbf.estimation.left_out import INSENSITIVE, LeftOut
from jbf.estimation.noise import Noise
from jbf.estimation.samples import Samples
from jbf.estimation.solution import Solution

Array = npt.NDArray[np.float64]


def mean_square(solution: Solution, samples: Samples, noise: Noise) -> tuple[float, int]:
    """Of the innovations in the fit, N^2; and how many there are."""
    empty = [np.zeros((len(r), 0)) for r in solution.residuals]
    r, _ = samples.stacked(solution.residuals, empty, noise)
    return float(r @ r) / max(len(r), 1), len(r)


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
        What was left out of fits near the solution, whose derivatives are taken.
    samples, noise
        The weight of each sample, and what whitens residuals: those of all models compared.
    variance
        Of the innovations, N^2.
    """
    own = [solution.jacobian[i] for i in range(len(solution.residuals))]
    _, j = samples.stacked(solution.residuals, own, noise)
    size = np.linalg.norm(j, axis=0)
    size[size <= 0.0] = 1.0
    whole = (j / size).T @ (j / size)
    return sum(_of(part, own, size, whole, samples, noise, variance) for part in parts)


def _of(
    part: LeftOut,
    jacobian: Sequence[Array],
    size: Array,
    whole: Array,
    samples: Samples,
    noise: Noise,
    variance: float,
) -> float:
    # The mask cuts after the whitening: a half's first innovation knows the sample before it.
    e, j = samples.only(part.runs).stacked(part.residuals, [jacobian[i] for i in part.runs], noise)
    weight = [samples.weight[i] > 0.0 for i in part.runs]
    left = np.concatenate([m[w] for m, w in zip(part.left, weight, strict=True)])
    e, j = e[left], (j / size)[left][:, part.told]
    # What nobody knows is known to a hundred times its error in the end.
    known = whole[np.ix_(part.told, part.told)] + INSENSITIVE * np.eye(int(part.told.sum()))
    before = known - j.T @ j
    pull = j.T @ e
    square = float(e @ e - pull @ np.linalg.solve(known, pull))
    _, after_det = np.linalg.slogdet(known)
    _, before_det = np.linalg.slogdet(before)
    return square / variance + float(after_det - before_det)
