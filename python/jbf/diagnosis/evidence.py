"""Evidence: what a model gains over another, less what it must gain to be kept (`level`).

In twice the log likelihood.
"""

from __future__ import annotations

from jbf.diagnosis.candidates import RANKING_EVALUATIONS, Candidates, many_peaks
from jbf.estimation.campaign import SMOOTHS_FORCE, Campaign
from jbf.estimation.likelihood import (
    effective_share,
    gain_of_most,
    likelihood_gain,
    next_step_gain,
    share_of_gain,
)
from jbf.estimation.noise_at import noise_at
from jbf.estimation.samples import least_weights
from jbf.estimation.search import search
from jbf.estimation.solution import Solution


def price_of(candidates: Candidates, parameters: int) -> float:
    """What so many parameters must gain in a campaign."""
    return candidates.level.price(parameters, candidates.campaign.samples.count)


def evidence(
    candidates: Candidates, richer: Solution, simpler: Solution, *, anywhere: bool = False
) -> float:
    """Evidence for the richer of two models.

    Where even the richer one leaves an error that is smooth, samples count for less. For an effect
    that the fit left at its null there is none: what is gained beside it is the search's.

    Parameters
    ----------
    anywhere
        A gain counts that comes and goes, too: it tells of structure, and not of this effect.
    """
    gain = likelihood_gain(richer, simpler)
    if gain > 0.0 and _within_steps(candidates.campaign, richer, simpler):
        gain = 0.0
    if gain > 0.0:
        gain *= effective_share(richer) if anywhere else share_of_gain(richer, simpler)
    if set(candidates.idle(richer)) - set(simpler.effects):
        gain = min(gain, 0.0)
    price = price_of(candidates, richer.free - simpler.free)
    if gain > price:
        # What a few samples alone ask for may be no more than what is wrong with them.
        of_most = gain_of_most(richer, simpler)
        gain = gain if of_most > price else max(of_most, 0.0)
    if _filters_motion(candidates, richer, simpler):
        gain = min(gain, price)
    return gain - price


def full_gain(candidates: Candidates, richer: Solution, simpler: Solution) -> float:
    """Gain of the richer of two models if all samples were independent, less what it must gain; for
    a model that is confirmed by independent units."""
    if set(candidates.idle(richer)) - set(simpler.effects):
        return 0.0
    if _within_steps(candidates.campaign, richer, simpler):
        return 0.0
    if _filters_motion(candidates, richer, simpler):
        return 0.0
    gain = min(likelihood_gain(richer, simpler), gain_of_most(richer, simpler))
    return gain - price_of(candidates, richer.free - simpler.free)


def _filters_motion(candidates: Candidates, richer: Solution, simpler: Solution) -> bool:
    """Whether the richer of two models adds an effect that filters a force or a motion, and
    explains no more than the errors of the motion contribute."""
    if not SMOOTHS_FORCE & (set(richer.effects) - set(simpler.effects)):
        return False
    samples = least_weights(richer.samples, simpler.samples)
    explained = samples.rms(simpler.residuals) ** 2 - samples.rms(richer.residuals) ** 2
    share = candidates.policy.least_share(candidates.campaign.motion_share)
    return bool(explained < share * samples.rms(simpler.residuals) ** 2)


def _within_steps(campaign: Campaign, richer: Solution, simpler: Solution) -> bool:
    """Whether two models differ by no more than a converter's steps move a mean reading."""
    samples = least_weights(richer.samples, simpler.samples)
    ways = [b - a for a, b in zip(richer.residuals, simpler.residuals, strict=True)]
    return bool(samples.rms(ways) < campaign.steps_rms_n(simpler.rms_n))


def evidence_alone(
    candidates: Candidates, richer: Solution, simpler: Solution, *, anywhere: bool = False
) -> float:
    """Evidence for the richer of two models, the other fitted to the same samples.

    An effect that moves jumps sets the samples beside them aside, and with them what may have led
    the model without it astray, or have made its noise look larger or smoother than it is: that
    gain is not the effect's.
    """
    gain = evidence(candidates, richer, simpler, anywhere=anywhere)
    if richer.samples is simpler.samples or gain <= 0.0:
        return gain
    problem, samples = candidates.fitted(simpler.effects).problem, richer.samples
    values = search(problem, samples, simpler.values, simpler.noise, RANKING_EVALUATIONS).values
    there = problem.solution(values, samples, noise_at(problem, samples, values))
    return min(gain, evidence(candidates, richer, there, anywhere=anywhere))


def swap_cost(
    candidates: Candidates, effects: tuple[str, ...], whole: Solution, near: Solution
) -> float:
    """How much evidence is lost when these effects stand in place of those of `whole`.

    Parameters
    ----------
    near
        The model without the effect that is exchanged.
    """

    # As for evidence: where even the whole leaves a smooth error, samples count for less.
    share = effective_share(whole)

    def cost(solution: Solution) -> float:
        lost = share * likelihood_gain(whole, solution)
        return lost + price_of(candidates, solution.free) - price_of(candidates, whole.free)

    policy = candidates.policy
    score = candidates.score_test(effects, near)
    shows = policy.least_score * price_of(candidates, 1)
    # Where the law has a step of its own to make yet, that is no promise of the effect's.
    least = policy.least_swap * likelihood_gain(whole, near)
    if score <= shows or score - next_step_gain(near) <= least:
        return cost(near)
    if not many_peaks(effects):
        # Of one peak among many no step tells where another one is.
        looked = candidates.look(effects, near)
        could_gain = policy.foreseen * looked.promised - likelihood_gain(looked.found(), near)
        if cost(looked.found()) - share * could_gain >= policy.contender:
            return cost(looked.found())
    first = cost(candidates.rank(effects, near))
    if first >= policy.contender:
        return first
    solution = candidates.converge(effects, near)
    if solution.rms_n > policy.leader_rms * whole.rms_n:
        # Where the model is wrong, what is whitest is not what leaves least.
        return float("inf")
    # What is worth nothing beside the rest stands for nothing: it may fit the fewer samples that
    # it leaves.
    return cost(solution if evidence_alone(candidates, solution, near) > 0.0 else near)
