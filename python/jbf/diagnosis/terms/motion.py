"""Term of the observation model: errors of the estimated motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import numpy as np

from jbf.arrays import Array
from jbf.diagnosis.terms.proposal import Model, Proposal, price_of_term
from jbf.estimation.campaign import Campaign
from jbf.estimation.errors_in_motion import ErrorsInMotion
from jbf.estimation.generalised_least_squares import (
    fit_without_motion_corrections,
    with_motion_errors,
)
from jbf.estimation.held_out import held_out_parts
from jbf.estimation.held_out_comparison import predictive_deviance
from jbf.estimation.noise import WHITE
from jbf.estimation.posterior_motions import kept_readings
from jbf.estimation.problem import Problem
from jbf.estimation.samples import Samples
from jbf.estimation.solution import Solution


def errors_of_motion(model: Model) -> Proposal | None:
    """Propose errors of the motion and a common delay re-estimated with the effects of a model.

    They may have been negligible, or the delay wrong, next to the error of a model with fewer
    effects. The gain is relative to the reference model with the present errors of the motion, and
    the threshold is reduced by those of effects that the model lacks. None for a bearing, or if the
    errors are negligible.
    """
    campaign, reference = model.campaign, model.reference
    if campaign.rig.bearing is not None:
        return None
    again, after = with_motion_errors(
        *fit_without_motion_corrections(model.problem, model.solution)
    )
    before, motion = campaign.samples.motion, after.samples.motion
    if before is None and motion is None:
        return None
    # Either likelihood may be that of a recording without errors of the motion.
    old, new = before or _without_errors(reference), motion or _without_errors(after)
    # If the delay changed, the samples of `again` differ from those of `campaign`.
    with_errors = replace(again.campaign, samples=replace(again.campaign.samples, motion=motion))
    weights_before, weights_after = _common_weights((campaign, reference), (again.campaign, after))
    gain = _samples(reference, old, weights_before).deviance(reference.residuals)
    gain -= _samples(after, new, weights_after).deviance(after.residuals)

    @cache
    def held_out_gain() -> float:
        """Increase of twice the log density of held-out runs, computed once if it is needed."""
        deviance = _held_out_deviance(model.reference_problem, reference, old, weights_before)
        return deviance - _held_out_deviance(again, after, new, weights_after)

    lacking = len(model.reference_problem.effects) - len(again.effects)
    price = price_of_term(model.policy, 2) - lacking * model.price_of_effect
    return Proposal(with_errors, again, after, gain, price, held_out_gain)


def _held_out_deviance(
    problem: Problem, solution: Solution, motion: ErrorsInMotion, weights: Sequence[Array]
) -> float:
    """Minus twice the log predictive density of held-out runs, with given errors of the motion."""
    samples = _samples(solution, motion, weights)
    parts = held_out_parts(problem, solution)
    log_determinant = motion.whitening(weights).log_determinant
    log_determinant += samples.log_determinant_between(WHITE)
    variance = motion.noise**2
    return predictive_deviance(solution, parts, samples, WHITE, variance) + log_determinant


def _samples(solution: Solution, motion: ErrorsInMotion, weights: Sequence[Array]) -> Samples:
    """Samples of a solution with other errors of the motion and other weights."""
    return replace(solution.samples, weight=tuple(weights), motion=motion)


def _without_errors(solution: Solution) -> ErrorsInMotion:
    """Return errors of the motion that are zero, with the noise of a solution."""
    runs = len(solution.residuals)
    sensitivity = tuple(np.zeros((len(r), 3)) for r in solution.residuals)
    return ErrorsInMotion((None,) * runs, sensitivity, max(solution.rms, 1e-150))


def _common_weights(
    before: tuple[Campaign, Solution], after: tuple[Campaign, Solution]
) -> tuple[list[Array], list[Array]]:
    """Weights of two fits, each set to zero at samples that the other fit does not use.

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
        kept = kept_readings(p, q)
        common = np.where(used > 0.0, weight[kept], 0.0)
        whole = np.zeros(len(weight))
        whole[kept] = common
        all_before.append(whole)
        all_after.append(common)
    return all_before, all_after
