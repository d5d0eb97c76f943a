"""Prediction of runs that had no part in the fit: each run is left out once."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from jbf.estimation.fit import Problem, Solution

Array = npt.NDArray[np.float64]

EVALUATIONS = 12
"""A refit that starts one Gauss-Newton step from the whole campaign's solution is close."""


def holdout_rms(problem: Problem, solution: Solution) -> float:
    """RMS over trusted samples of runs left out of the fit one at a time, N.

    A parameter that the remaining runs say nothing of goes back to its null (or its starting
    value): what only the left-out run could know must not leak into its prediction. With one run
    there is nothing to leave out, and the halves of the run take turns.
    """
    problem = problem.on(solution.campaign)
    campaign = problem.campaign
    count = len(campaign.prepared)
    if count == 1:
        return _halves_rms(problem, solution)
    total, samples = 0.0, 0
    for i in range(count):
        rest = campaign.only([k for k in range(count) if k != i])
        part = Problem(rest, problem.law, problem.clock, problem.effects)
        start = _without_leak(problem, solution, i)
        if np.array_equal(start, solution.values):
            # A law that misses the data badly is no place to extrapolate from.
            start = min((_one_step(problem, solution, i), start), key=part.square)
        values, _, _ = part.search(start, solution.noise, EVALUATIONS)
        own = Problem(campaign.only([i]), problem.law, problem.clock, problem.effects)
        residual, p = own.residuals(values)[0], campaign.prepared[i]
        total += float(np.sum(residual[p.trusted] ** 2))
        samples += int(p.trusted.sum())
    return float(np.sqrt(total / max(samples, 1)))


def _without_leak(problem: Problem, solution: Solution, left_out: int) -> Array:
    """The whole solution, less what only the left-out run knows."""
    values: Array = solution.values.copy()
    felt = np.array(
        [
            np.sum(jacobian[p.trusted] ** 2, axis=0)
            for jacobian, p in zip(solution.jacobian, problem.campaign.prepared, strict=True)
        ]
    )
    whole = felt.sum(axis=0)
    for i, page in enumerate(problem.parameters.values()):
        if whole[i] - felt[left_out, i] < 1e-4 * whole[i]:
            null = page.null if page.null is not None and np.isfinite(page.null) else None
            values[i] = page.starts[0] if null is None else null
    return values


def _one_step(problem: Problem, solution: Solution, left_out: int) -> Array:
    """The Gauss-Newton step that leaves one run out, from derivatives that are there already."""
    rest = [i for i in range(len(problem.campaign.prepared)) if i != left_out]
    r, j = problem.stacked(solution.residuals, solution.jacobian, solution.noise, rest)
    step, *_ = np.linalg.lstsq(j, -r, rcond=1e-12)
    return problem.decode(problem.encode(solution.values) + step, solution.values)


def _halves_rms(problem: Problem, solution: Solution) -> float:
    """Each half of a single run predicted from a fit to the other."""
    only = problem.campaign.prepared[0]
    first = np.arange(len(only.run)) < len(only.run) // 2
    total, samples = 0.0, 0
    for half in (first, ~first):
        masked = replace(only, trusted=only.trusted & half, weight=only.weight * half)
        part = Problem(problem.campaign.of([masked]), problem.law, problem.clock, problem.effects)
        values, _, _ = part.search(solution.values, solution.noise, EVALUATIONS)
        seen = only.trusted & ~half
        total += float(np.sum(problem.residuals(values)[0][seen] ** 2))
        samples += int(seen.sum())
    return float(np.sqrt(total / max(samples, 1)))
