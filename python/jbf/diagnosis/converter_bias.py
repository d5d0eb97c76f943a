"""The bias of readings that come in coarse steps, taken off by the model's own force.

Which mean reading belongs to a force, the converter decides; no sample averages that out, and a
curve of the force that is not the machine's is bought by any effect that bends over the force.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt
from scipy import optimize

from jbf.diagnosis.policy import Policy
from jbf.estimation.campaign import Campaign
from jbf.estimation.converter import bias_n, origin_n
from jbf.estimation.problem import Problem
from jbf.estimation.search import search
from jbf.estimation.solution import Solution

Array = npt.NDArray[np.float64]

EVALUATIONS = 8
"""Steps of a fit to readings whose bias has changed a little,"""
MOST_TURNS = 8
"""and how often there is one."""
NO_BIAS = 0.8
"""Noise, in steps, beside which there is none."""


def without_bias(problem: Problem, solution: Solution, policy: Policy) -> Campaign | None:
    """The campaign with the bias of its steps taken off the readings; None where it is off already.

    Without it the model fits another force, which has another bias: off and on, until it stays.
    """
    found = None
    for _ in range(MOST_TURNS):
        again = _once(problem, solution, policy)
        if again is None:
            break
        found = again
        problem = Problem(again, problem.law, problem.clock, problem.effects, problem.fixed)
        samples, noise = problem.samples_at(solution.values), solution.noise
        end = search(problem, samples, solution.values, noise, EVALUATIONS)
        solution = problem.solution(end.values, samples, noise, end.converged, end.message)
    return found


def _once(problem: Problem, solution: Solution, policy: Policy) -> Campaign | None:
    """The same by one solution.

    How much of it the noise before the converter leaves, the residual says: a model that is wrong
    by a good part of a step does not know where in a step its force lies, and shows none.
    """
    campaign = problem.campaign
    steps = {f.run: f.size for f in campaign.findings if f.kind == "steps"}
    if not steps:
        return None
    # The mean readings that the model expects; what is off already is in its residual.
    expected = [
        p.friction_n - e for p, e in zip(campaign.prepared, solution.residuals, strict=True)
    ]
    raw = [p.readings_n for p in campaign.prepared]
    flat = solution.samples.flat
    left = flat([r - f for r, f in zip(raw, expected, strict=True)])

    def bias(noise: float) -> list[Array]:
        return [
            bias_n(step, noise * step, f - origin_n(step, r)) if step else np.zeros(len(r))
            for step, f, r in zip(
                (steps.get(p.run.name, 0.0) for p in campaign.prepared), expected, raw, strict=True
            )
        ]

    def cost(noise: float) -> float:
        e = left - flat(bias(noise))
        return float(e @ e)

    noise = float(optimize.minimize_scalar(cost, bounds=(0.0, NO_BIAS), method="bounded").x)
    corrected = [r - b for r, b in zip(raw, bias(noise), strict=True)]
    moved = [p.friction_n - c for p, c in zip(campaign.prepared, corrected, strict=True)]
    if solution.samples.rms(moved) < policy.bias_moves * campaign.step_n:
        return None
    return replace(
        campaign,
        prepared=tuple(
            replace(p, friction_n=c) for p, c in zip(campaign.prepared, corrected, strict=True)
        ),
    )
