"""Evidence: log-likelihood gain of a model over another, less the acceptance threshold (`level`).

All values are in twice the log likelihood.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

from jbf.diagnosis.candidates import RANKING_EVALUATIONS, Candidates
from jbf.estimation.campaign import DISTORTS_FORCE, FILTERS_FORCE, Campaign
from jbf.estimation.generalised_least_squares import gain_with_less_smoothing
from jbf.estimation.identifiability import idle_effects
from jbf.estimation.likelihood import (
    likelihood_gain,
    noise_at,
    robust_gain,
    share_of_gain,
)
from jbf.estimation.noise import WHITE
from jbf.estimation.samples import Samples, common_samples
from jbf.estimation.search import search
from jbf.estimation.solution import Solution


def evidence(
    candidates: Candidates, richer: Solution, simpler: Solution, *, count_local_gain: bool = False
) -> float:
    """Log-likelihood gain of a richer model over a simpler one, less the acceptance threshold.

    The gain is multiplied by the share of independent samples. The share is that of the residual of
    `richer` or that of the residual of the model with all candidates (`RichestResidual`), whichever
    is larger, and at most that of the score (`share_of_gain`). An effect with its parameters at the
    null has no positive evidence: its gain is due to the search.

    A gain that occurs in a part of the record only is evidence of residual structure, but not of
    this effect; it is not reduced with `count_local_gain`.
    """
    gain = likelihood_gain(richer, simpler)
    if gain > 0.0 and _differ_by_less_than_quantisation(candidates.campaign, richer, simpler):
        gain = 0.0
    if gain > 0.0:
        share = candidates.independent_share(richer)
        gain *= share if count_local_gain else share_of_gain(richer, simpler, share)
    if _adds_idle_effect(candidates, richer, simpler):
        gain = min(gain, 0.0)
    price = candidates.price(richer.free - simpler.free)
    if gain > price:
        # A gain from a few samples may be due to outliers.
        robust = robust_gain(richer, simpler)
        gain = gain if robust > price else max(robust, 0.0)
    if effect_may_describe_motion_errors(candidates, richer, simpler):
        gain = min(gain, 0.0)
    return gain - price


def full_gain(candidates: Candidates, richer: Solution, simpler: Solution) -> float:
    """Gain of the richer model less the threshold, if all samples are treated as independent.

    It is in twice the log likelihood of white noise, and is used for a model that independent units
    confirm. Coloured noise contains the slow part of an effect that another model lacks.
    """
    if (
        _adds_idle_effect(candidates, richer, simpler)
        or _differ_by_less_than_quantisation(candidates.campaign, richer, simpler)
        or effect_may_describe_motion_errors(candidates, richer, simpler)
    ):
        return 0.0
    richer, simpler = replace(richer, noise=WHITE), replace(simpler, noise=WHITE)
    samples = common_samples(richer.samples, simpler.samples)
    before, after = (samples.cost(s.residuals, WHITE) for s in (simpler, richer))
    gain = min(before - after, robust_gain(richer, simpler))
    return gain - candidates.price(richer.free - simpler.free)


def _adds_idle_effect(candidates: Candidates, richer: Solution, simpler: Solution) -> bool:
    """Whether an added effect has no influence: all its parameters have their null values."""
    problem = candidates.fitted(richer.effects).problem
    idle = idle_effects(problem.effects, problem.parameters, richer.values.tolist())
    return bool(set(idle) - set(simpler.effects))


def effect_may_describe_motion_errors(
    candidates: Candidates, richer: Solution, simpler: Solution
) -> bool:
    """Whether an effect that was added to `simpler` may describe errors of the motion only."""
    added = DISTORTS_FORCE & (set(richer.effects) - set(simpler.effects))
    if not added:
        return False
    samples = common_samples(richer.samples, simpler.samples)
    rms, rms_without = (samples.rms(s.residuals) for s in (richer, simpler))
    return may_describe_motion_errors(candidates, added, rms, rms_without, samples)


def may_describe_motion_errors(
    candidates: Candidates,
    added: Collection[str],
    rms: float,
    rms_without: float,
    samples: Samples,
) -> bool:
    """Whether added effects that distort the force may describe errors of the motion only.

    Such an effect filters the predicted force, and with it the errors of the motion. The whitening
    assumes unfiltered errors, and the likelihood of the effect may be too large. The effect must
    reduce the mean square by more than the share of these errors. One that filters in time must
    reduce it by at least `min_filter_share`, since errors of time stamps, loads and corners of the
    motion are not in the likelihood. False for a bearing: a diagnosis does not estimate the errors
    of its motion.

    Parameters
    ----------
    candidates
        Fits to the campaign.
    added
        Names of the effects.
    rms, rms_without
        RMS of the residuals with and without the effect, N.
    samples
        The samples, with the errors of the motion.
    """
    if candidates.campaign.rig.bearing is not None:
        return False
    motion, filters = samples.motion, FILTERS_FORCE.intersection(added)
    share = candidates.policy.motion.min_filter_share if filters else 0.0
    if motion is not None:
        share = max(share, motion.variance_share(samples.weight))
    elif not filters:
        return False
    return rms**2 > (1.0 - share) * rms_without**2


def _differ_by_less_than_quantisation(
    campaign: Campaign, richer: Solution, simpler: Solution
) -> bool:
    """Whether two models differ by less (RMS) than the quantisation error of the force."""
    samples = common_samples(richer.samples, simpler.samples)
    differences = [b - a for a, b in zip(richer.residuals, simpler.residuals, strict=True)]
    return bool(samples.rms(differences) < campaign.steps_rms(simpler.rms))


def evidence_on_common_samples(
    candidates: Candidates, richer: Solution, simpler: Solution, *, count_local_gain: bool = False
) -> float:
    """Evidence for the richer of two models, after a refit of the simpler one to the same samples.

    An effect that shifts friction jumps excludes the samples next to them. These samples may have
    biased the simpler model, or have made its noise appear larger or smoother. That gain is not
    attributed to the effect.
    """
    gain = evidence(candidates, richer, simpler, count_local_gain=count_local_gain)
    if richer.samples is simpler.samples or gain <= 0.0:
        return gain
    problem, samples = candidates.fitted(simpler.effects).problem, richer.samples
    values = search(problem, samples, simpler.values, simpler.noise, RANKING_EVALUATIONS).values
    refit = problem.solution(values, samples, noise_at(problem, samples, values))
    return min(gain, evidence(candidates, richer, refit, count_local_gain=count_local_gain))


def is_due_to_smoothing(candidates: Candidates, richer: Solution, simpler: Solution) -> bool:
    """Whether the gain of the richer model is below the threshold if the motion is smoothed less.

    False if the likelihood does not contain errors of the motion. The gain is not reduced for
    correlated innovations. See `gain_with_less_smoothing`.
    """
    if richer.samples.motion is None:
        return False
    problems = [candidates.fitted(s.effects).problem for s in (richer, simpler)]
    gain = gain_with_less_smoothing(problems[0], richer, problems[1], simpler)
    return gain <= candidates.price(richer.free - simpler.free)
