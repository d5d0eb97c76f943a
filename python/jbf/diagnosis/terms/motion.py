"""Errors of the estimated motion in the likelihood of a drive."""

from __future__ import annotations

from dataclasses import replace

from jbf.diagnosis.terms.proposal import Model, Proposal, price_of_term
from jbf.estimation.generalised_least_squares import with_motion_errors_again


def errors_of_motion(model: Model) -> Proposal | None:
    """Propose motion errors re-estimated (noise, scale, smoothness) with the present effects.

    The gain is relative to the likelihood with the present motion errors. None if the noise has not
    decreased by the minimum ratio of the policy since they were estimated.
    """
    before = model.campaign.samples.motion
    if before is None:
        return None
    solution = model.solution
    again, after = with_motion_errors_again(model.problem, solution)
    motion = after.samples.motion
    assert motion is not None
    if motion.noise * model.policy.motion.min_noise_ratio > before.noise:
        return None
    weights = solution.samples.weight
    gain = before.deviance(solution.residuals, weights) - motion.deviance(after.residuals, weights)
    samples = replace(model.campaign.samples, motion=motion)
    campaign = replace(again.campaign, samples=samples)
    price = price_of_term(model.policy, 2)
    return Proposal(campaign, again, after, gain, price)
