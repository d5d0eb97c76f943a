"""Errors of the estimated motion in the likelihood of a drive."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from jbf.diagnosis.terms.proposal import Model, Proposal, price_of_term
from jbf.estimation.campaign import Campaign
from jbf.estimation.generalised_least_squares import with_motion_errors_again
from jbf.estimation.solution import Solution

Array = npt.NDArray[np.float64]


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
    of_before, of_after = _common_weights((model.campaign, solution), (again.campaign, after))
    gain = before.deviance(solution.residuals, of_before)
    gain -= motion.deviance(after.residuals, of_after)
    # A problem with a shifted force has samples of its own.
    campaign = again.campaign
    campaign = replace(campaign, samples=replace(campaign.samples, motion=motion))
    price = price_of_term(model.policy, 2)
    return Proposal(campaign, again, after, gain, price)


def _common_weights(
    before: tuple[Campaign, Solution], after: tuple[Campaign, Solution]
) -> tuple[list[Array], list[Array]]:
    """Weights of the first solution, zero at samples that the second one does not use.

    They are returned for the samples of either: a delay of the force removes samples from the start
    or the end of a run.
    """
    all_before, all_after = [], []
    (campaign, solution), (shifted, other) = before, after
    for p, q, weight, used in zip(
        campaign.prepared,
        shifted.prepared,
        solution.samples.weight,
        other.samples.weight,
        strict=True,
    ):
        lost = len(weight) - len(used)
        at_start = lost > 0 and np.array_equal(p.readings_n[lost:], q.readings_n)
        kept = slice(lost, None) if at_start else slice(0, len(used))
        common = np.where(used > 0.0, weight[kept], 0.0)
        whole = np.zeros(len(weight))
        whole[kept] = common
        all_before.append(whole)
        all_after.append(common)
    return all_before, all_after
