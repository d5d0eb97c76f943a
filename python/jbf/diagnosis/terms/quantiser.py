"""Quantisation bias of the mean reading of a converter with steps as large as the noise.

The difference between the mean reading and the force is a periodic function of the force (Widrow
1956). Averaging does not remove it.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy import optimize

from jbf.arrays import Array
from jbf.diagnosis.policy import Policy
from jbf.diagnosis.terms.proposal import Model, Proposal, independent_fraction, price_of_term
from jbf.estimation.campaign import Campaign
from jbf.estimation.likelihood import noise_at
from jbf.estimation.problem import Problem
from jbf.estimation.quantisation import quantisation_bias, zero_offset
from jbf.estimation.search import search
from jbf.estimation.solution import Solution

EVALUATIONS = 8
"""Number of evaluations of each fit to corrected readings. It limits the effort only."""
MOST_ITERATIONS = 8
"""Largest number of corrections and fits. It limits the effort only."""


def quantiser(model: Model) -> Proposal | None:
    """Propose a correction of the force for the quantisation bias of its converter.

    Returns None if the quantisation is fine, or if the bias changes by less than the limit of the
    policy.
    """
    solution = model.solution
    corrected = without_bias(model.problem, solution, model.policy)
    if corrected is None:
        return None
    campaign, again, after = corrected
    after = again.solution(
        after.values, after.samples, noise_at(again, after.samples, after.values)
    )
    gain = after.samples.cost(solution.residuals, solution.noise) - after.cost
    share = independent_fraction(after, solution)
    price = price_of_term(model.policy)
    return Proposal(campaign, again, after, share * gain, price)


def without_bias(
    problem: Problem, solution: Solution, policy: Policy
) -> tuple[Campaign, Problem, Solution] | None:
    """Return the campaign corrected for quantisation bias, and the model fitted to it.

    Since the bias depends on the predicted force, correction and fit are repeated until the bias no
    longer changes. None if no correction is necessary.
    """
    corrected = None
    for _ in range(MOST_ITERATIONS):
        campaign = _corrected(problem, solution, policy)
        if campaign is None:
            break
        problem = Problem(campaign, problem.law, problem.clock, problem.effects, problem.fixed)
        samples, noise = problem.samples_at(solution.values), solution.noise
        end = search(problem, samples, solution.values, noise, EVALUATIONS)
        solution = problem.solution(end.values, samples, noise, end.converged, end.message)
        corrected = campaign, problem, solution
    return corrected


def _corrected(problem: Problem, solution: Solution, policy: Policy) -> Campaign | None:
    """Correct the force once for the quantisation bias; None if the correction changes little.

    The noise before the converter is estimated by least squares.
    """
    campaign = problem.campaign
    steps = {f.run: f.size for f in campaign.findings if f.kind == "steps"}
    if not steps:
        return None
    # Predicted mean readings; the residual contains the earlier correction.
    expected = [p.friction - e for p, e in zip(campaign.prepared, solution.residuals, strict=True)]
    raw = [p.readings_n for p in campaign.prepared]
    flat = solution.samples.flat
    deviation = flat([r - f for r, f in zip(raw, expected, strict=True)])

    def bias(noise: float) -> list[Array]:
        """Quantisation bias of each sample for noise of this standard deviation, N, by run."""
        return [
            quantisation_bias(step, noise * step, f - zero_offset(step, r))
            if step
            else np.zeros(len(r))
            for step, f, r in zip(
                (steps.get(p.run.name, 0.0) for p in campaign.prepared), expected, raw, strict=True
            )
        ]

    def square(noise: float) -> float:
        """Sum of squares of the residual after the correction for given noise."""
        e = deviation - flat(bias(noise))
        return float(e @ e)

    noise = float(
        optimize.minimize_scalar(
            square, bounds=(0.0, policy.quantisation.unbiased_noise), method="bounded"
        ).x
    )
    corrected = [r - b for r, b in zip(raw, bias(noise), strict=True)]
    moved = [p.friction - c for p, c in zip(campaign.prepared, corrected, strict=True)]
    if solution.samples.rms(moved) < policy.quantisation.min_bias_change * campaign.step_n:
        return None
    return replace(
        campaign,
        prepared=tuple(
            replace(p, friction=c) for p, c in zip(campaign.prepared, corrected, strict=True)
        ),
    )
