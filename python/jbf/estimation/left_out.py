"""The left-out error: prediction of runs that had no part in the fit, each left out once; of many
runs several at a time."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from jbf.estimation.campaign import Campaign
from jbf.estimation.minimum import search
from jbf.estimation.problem import Problem
from jbf.estimation.solution import Solution

Array = npt.NDArray[np.float64]

EVALUATIONS = 12
"""A refit that starts one Gauss-Newton step from the whole campaign's solution is close."""
MOST_FITS = 12
"""Fits without a run; of more runs groups are left out: so many folds of a cross-validation."""
INSENSITIVE = 1e-4
"""Runs say nothing of a parameter where they hold less than this share of what is known of it."""


def left_out_rms(problem: Problem, solution: Solution, *, apart: bool = False) -> float:
    """RMS of `left_out_by_run`, N."""
    left = np.concatenate(left_out_by_run(problem, solution, apart=apart))
    return float(np.sqrt(np.sum(left**2) / max(len(left), 1)))


def left_out_residuals(problem: Problem, solution: Solution) -> Array:
    """`left_out_by_run`, all runs in a row."""
    return np.concatenate(left_out_by_run(problem, solution))


def left_out_by_run(problem: Problem, solution: Solution, *, apart: bool = False) -> list[Array]:
    """Residuals, N, at the samples that count of runs left out of the fit, one at a time or, of
    more than `MOST_FITS`, in so many groups.

    Parameters
    ----------
    apart
        Less what a run's own deviations from the others explain, where runs are known to have them:
        for models to be compared, since no model predicts those.

    A parameter that the remaining runs say nothing of goes back to its null (or its starting
    value): what only the left-out run could know must not leak into its prediction. With one run
    there is nothing to leave out, and the halves of the run take turns.
    """
    campaign, samples = problem.campaign, solution.samples
    count = len(campaign.prepared)
    if count == 1:
        return _halves(problem, solution)
    left: dict[int, Array] = {}
    for group in _groups([p.run.name for p in campaign.prepared]):
        rest = [k for k in range(count) if k not in group]
        part = _of(problem, campaign.only(rest))
        kept = samples.only(rest)
        start = _without_leak(problem, solution, rest)
        if np.array_equal(start, solution.values):
            # A law that misses the data badly is no place to extrapolate from.
            step = _one_step(problem, solution, rest)
            start = min((step, start), key=lambda v: part.square(v, kept))
        values, _, _ = search(part, kept, start, solution.noise, EVALUATIONS)
        residuals = problem.residuals(values, group)
        if apart:
            residuals = samples.only(group).without_deviations(residuals, solution.noise)
        left |= {i: r[samples.counted[i]] for i, r in zip(group, residuals, strict=True)}
    return [left[i] for i in range(count)]


def _groups(names: list[str]) -> list[list[int]]:
    """Runs that are left out together: neighbours by name are not, and in whatever order runs are
    given, groups are the same."""
    by_name = sorted(range(len(names)), key=lambda i: names[i])
    return [by_name[k::MOST_FITS] for k in range(min(MOST_FITS, len(names)))]


def _of(problem: Problem, campaign: Campaign) -> Problem:
    """The same problem on other runs."""
    return Problem(campaign, problem.law, problem.clock, problem.effects, problem.fixed)


def _without_leak(problem: Problem, solution: Solution, rest: list[int]) -> Array:
    """The whole solution, less what only runs other than the rest know."""
    values: Array = solution.values.copy()
    known = np.array(
        [
            np.sum(jacobian[counted] ** 2, axis=0)
            for jacobian, counted in zip(solution.jacobian, solution.samples.counted, strict=True)
        ]
    )
    whole = known.sum(axis=0)
    pages = list(problem.parameters.values())
    for k, i in enumerate(problem.open):
        page = pages[i]
        if known[rest, k].sum() < INSENSITIVE * whole[k]:
            null = page.null if page.null is not None and np.isfinite(page.null) else None
            values[i] = page.starts[0] if null is None else null
    return values


def _one_step(problem: Problem, solution: Solution, rest: list[int]) -> Array:
    """The Gauss-Newton step to the rest of the runs, from derivatives that are there already."""
    r, j = solution.samples.stacked(solution.residuals, solution.jacobian, solution.noise, rest)
    step, *_ = np.linalg.lstsq(j, r, rcond=1e-12)
    return problem.decode(problem.encode(solution.values) + step, solution.values)


def _halves(problem: Problem, solution: Solution) -> list[Array]:
    """Each half of a single run predicted from a fit to the other."""
    residuals = []
    first, second = solution.samples.halves()
    for kept, left in ((first, second), (second, first)):
        values, _, _ = search(problem, kept, solution.values, solution.noise, EVALUATIONS)
        residuals.append(problem.residuals(values)[0][left.counted[0]])
    return [np.concatenate(residuals)]
