"""Test whether the level of the friction is the same in all strokes.

With a surface that wears, sheds debris or is relubricated, each stroke has its own level, which no
parameter of a law describes.

The test is an analysis of variance. Between strokes of a run it uses the ratio of recorded and
predicted friction; within strokes, the difference between their two halves. For a correct model,
and for a wrong model with equal errors in all strokes, both estimate the same variance, whatever
the memory of the noise. Their ratio has Fisher's F distribution.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import numpy.typing as npt
from scipy import special

from jbf.diagnosis.ledger import Remainder
from jbf.diagnosis.policy import Policy
from jbf.estimation.problem import Problem
from jbf.estimation.solution import Solution
from jbf.estimation.units import Strokes, stroke_of

Array = npt.NDArray[np.float64]


def find_stroke_levels(problem: Problem, solution: Solution, policy: Policy) -> list[Remainder]:
    """Report that the level of the friction differs between strokes, where it does."""
    friction = problem.predict(solution.values)
    left = solution.samples.without_deviations(solution.residuals, solution.noise)
    between = within = moved = 0.0
    of_between = of_within = 0
    least = policy.strokes.min_samples
    for p, f, r, counted in zip(
        problem.campaign.prepared, friction, left, solution.samples.counted, strict=True
    ):
        halves = np.array(list(_halves(stroke_of(p), f, r, counted, least))).reshape(-1, 2, 2)
        if len(halves) < policy.strokes.min_strokes:
            continue
        weight, pull = halves[..., 0], halves[..., 1]
        level = pull / weight
        whole = np.sum(pull, axis=1) / np.sum(weight, axis=1)
        off = whole - np.sum(pull) / np.sum(weight)
        between += float(np.sum(weight.sum(axis=1) * off**2))
        of_between += len(off) - 1
        apart = level[:, 1] - level[:, 0]
        apart -= np.average(apart, weights=np.prod(weight, axis=1) / np.sum(weight, axis=1))
        within += float(np.sum(np.prod(weight, axis=1) / np.sum(weight, axis=1) * apart**2))
        of_within += len(off) - 1
        moved += float(np.sum(weight))
    square = sum(float(r[c] @ r[c]) for r, c in zip(left, solution.samples.counted, strict=True))
    if not of_between or within <= 0.0 or square <= 0.0:
        return []
    ratio = (between / of_between) / (within / of_within)
    share = (between - within * of_between / of_within) / square
    if share < policy.patterns.min_share:
        return []
    if special.fdtrc(of_between, of_within, ratio) > policy.constancy.chance:
        return []
    size = 100.0 * float(np.sqrt(share * square / moved))
    where = (
        f"friction as high in no stroke as in the next: by {size:.2g} % from stroke to stroke "
        f"({ratio:.0f} times as much as within one)"
    )
    return [Remainder("stroke", where, min(share, 1.0))]


def _halves(
    stroke: Strokes, friction: Array, residual: Array, counted: npt.NDArray[np.bool_], least: int
) -> Iterator[list[list[float]]]:
    """Sums for the two halves of each stroke.

    Strokes with fewer than `least` samples a half are skipped. Each half has the sum of squares of
    the friction, N^2, and the sum of its products with the residual.
    """
    for k in range(int(np.max(stroke, initial=-1)) + 1):
        rows = np.flatnonzero((stroke == k) & counted)
        if len(rows) < 2 * least:
            continue
        halves = np.array_split(rows, 2)
        own = [[float(friction[h] @ friction[h]), float(friction[h] @ residual[h])] for h in halves]
        if min(own[0][0], own[1][0]) > 0.0:
            yield own
