"""One round of the selection: every candidate is tested in addition to the present effects.

The tests are, in order of computing cost, a score test, an approximate fit, and a converged fit.
The candidate with the largest evidence is added if held-out runs confirm it. A candidate without
evidence is added if independent units confirm it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from jbf.arrays import Names
from jbf.diagnosis.candidates import Candidates
from jbf.diagnosis.evidence import (
    effect_may_describe_motion_errors,
    evidence,
    evidence_on_common_samples,
    full_gain,
    is_due_to_smoothing,
)
from jbf.diagnosis.ledger import Outcome, Trial
from jbf.diagnosis.policy import Policy
from jbf.estimation.approach import many_peaks
from jbf.estimation.likelihood import likelihood_gain, next_step_gain
from jbf.estimation.solution import Solution

Follow = Literal["promising", "shown", "all"]

LESS = 0.95
"""Ratio of RMS values, with to without a candidate, from which the ledger reports a better fit."""
CHANCE = "no significant gain"
SLIGHT = "significant, but within the margin for recording artefacts"
OF_MOTION_ERRORS = "explains no more than errors of the acceleration or of time stamps could"
OF_SMOOTHING = "not significant with a motion that is smoothed less"
SMOOTH = "fits better, but the residual is so strongly correlated that this may be chance"


@dataclass(frozen=True)
class Ranked:
    """Evidence and solution of a candidate effect in addition to a model.

    Attributes
    ----------
    evidence
        Evidence for the candidate.
    effect
        Name of the candidate.
    solution
        The solution with this evidence.
    limit
        Upper limit of the evidence if the fit was not continued; infinite otherwise.
    """

    evidence: float
    effect: str
    solution: Solution
    limit: float = np.inf


@dataclass(frozen=True)
class Round:
    """Result of one round: each candidate tried in addition to a model, and the one to add.

    Attributes
    ----------
    trials
        The candidates tried, largest evidence first.
    leader
        The effect to add; None where none is accepted.
    refused
        Candidates with evidence that held-out runs do not confirm, or that is due to the smoothing
        of the motion. They do not replace other effects.
    """

    trials: tuple[Trial, ...]
    leader: str | None
    refused: frozenset[str] = frozenset()


def try_candidates(candidates: Candidates, present: Names, follow: Follow = "promising") -> Round:
    """Test every candidate in addition to the present effects, and select the one to add.

    `follow` selects the candidates to fit: those with a sufficient score (`shown`), of these only
    the ones that may still lead or tie after a few steps (`promising`), or all. For a strong
    effect, the score at its null may be uninformative.
    """
    base, policy = candidates.converge(present), candidates.policy
    unit = candidates.campaign.rig.quantities.force
    ranked = _rank(candidates, present, base, follow)
    best, trials = 0.0, []
    unconfirmed: set[str] = set()
    of_smoothing: set[str] = set()
    bare = base.rms
    least = min((r.solution.rms for r in ranked if r.evidence > 0), default=bare)
    # A wrong model has a smooth error, which resembles coloured noise. A candidate with a far
    # smaller RMS than all candidates with evidence is therefore tested by units first.
    far_better = [r for r in ranked if policy.selection.max_rms_ratio * r.solution.rms < least]
    leader = _by_units(candidates, present, far_better)
    if leader is not None:
        richer = candidates.converge((*present, leader))
        least, best = richer.rms, full_gain(candidates, richer, base)
    for candidate in sorted(ranked, key=lambda r: _has_larger_rms(r, least, policy)):
        name, gain = candidate.effect, candidate.evidence
        rms = min(candidate.solution.rms, bare)
        outcome: Outcome
        outcome = "no gain"
        reason = SMOOTH if rms < LESS * bare else CHANCE
        if gain > candidates.level.critical - candidates.price(1):
            reason = SLIGHT
        if gain <= 0.0 and gain > candidates.level.significant - candidates.price(1):
            outcome = "negligible"
            reason = f"significant, but reduces the error by only {1.0 - rms / bare:.1%}"
        enough = likelihood_gain(candidate.solution, base) > candidates.price(1)
        if enough and effect_may_describe_motion_errors(candidates, candidate.solution, base):
            reason = OF_MOTION_ERRORS
        if np.isfinite(candidate.limit):
            outcome = "rejected"
            reason = (
                f"skipped: its largest possible evidence is {max(candidate.limit, 0.0):.0f}, "
                "too little to tie with the leader"
            )
        elif gain > 0 and leader is None:
            alone = evidence_on_common_samples(candidates, candidate.solution, base)
            if alone <= 0.0:
                gain, reason = alone, "the gain comes from the samples that it excludes"
            elif is_due_to_smoothing(candidates, candidate.solution, base):
                outcome, reason = "rejected", OF_SMOOTHING
                of_smoothing.add(name)
            elif (confirmation := candidates.confirmation(present, name)).confirms(gain, policy):
                if _gain_is_from_local_minimum(candidates, present, name, base):
                    return try_candidates(candidates, present, follow)
                leader, best = name, gain
                outcome, reason = "added", f"largest evidence; {confirmation.describe(unit)}"
            else:
                outcome = "rejected"
                held_out = confirmation.describe_gain(unit)
                reason = f"fits better, but does not predict held-out runs better ({held_out})"
                unconfirmed.add(name)
        elif gain > 0 and _has_larger_rms(candidate, least, policy):
            outcome, reason = "rejected", f"leaves an RMS of {rms:.3g} {unit}, more than {leader}"
        elif gain > max(0.0, best - policy.selection.tie):
            outcome, reason = "ties", f"fits as well as {leader}"
        elif gain > 0:
            outcome = "rejected"
            reason = f"evidence is {best - gain:.0f} below that of {leader}"
        trials.append(Trial(name, rms, float(gain), outcome, reason, name in unconfirmed))
    least = max(best - policy.selection.tie, 0.0)
    if max((r.limit for r in ranked if np.isfinite(r.limit)), default=-np.inf) > least:
        # The leader that these candidates were compared with was not accepted.
        return try_candidates(candidates, present, "shown")
    if leader is None:
        tried = [r for r in ranked if r.effect not in unconfirmed | of_smoothing]
        leader = _by_units(candidates, present, tried)
    trials = [_added_by_units(candidates, present, t) if t.effect == leader else t for t in trials]
    ordered = tuple(sorted(trials, key=lambda t: -t.evidence))
    return Round(ordered, leader, frozenset(unconfirmed | of_smoothing))


def _by_units(candidates: Candidates, present: Names, ranked: Sequence[Ranked]) -> str | None:
    """Select the candidate with the largest likelihood gain that independent units confirm.

    In a correlated residual few samples are independent, and a slow or constant effect has little
    evidence. Runs or strokes (the units) are independent even then. Errors due to the smoothing of
    the motion may repeat in every unit. None if no candidate is confirmed.
    """
    base = candidates.converge(present)
    gains = {
        r.effect: full_gain(candidates, r.solution, base)
        for r in ranked
        if not np.isfinite(r.limit)
    }
    for name in sorted(gains, key=lambda name: -gains[name])[: candidates.policy.search.leaders]:
        if gains[name] <= 0.0:
            break
        if candidates.confirmation(present, name).units_confirm(candidates.level):
            richer = candidates.converge((*present, name))
            if not is_due_to_smoothing(candidates, richer, base):
                return name
    return None


def _added_by_units(candidates: Candidates, present: Names, trial: Trial) -> Trial:
    """Mark the trial of the leader as added; without evidence, the units are the reason."""
    if trial.outcome == "added":
        return trial
    confirmation = candidates.confirmation(present, trial.effect)
    better = f"{confirmation.units} units are predicted better, p = {confirmation.chance:.1g}"
    unit = candidates.campaign.rig.quantities.force
    return replace(trial, outcome="added", reason=f"{better}; {confirmation.describe(unit)}")


def _gain_is_from_local_minimum(
    candidates: Candidates, present: Names, name: str, base: Solution
) -> bool:
    """Whether the gain of an effect is due to a local minimum of the fit without it.

    The model without the effect is refitted from the parameter values of the fit with the effect.
    If its likelihood increases, the gain is not due to the effect.
    """
    better = candidates.refit_from(present, (*present, name))
    return likelihood_gain(better, base) > candidates.policy.search.rank_margin


def _has_larger_rms(candidate: Ranked, least_n: float, policy: Policy) -> bool:
    """Whether a candidate's RMS exceeds that of the best candidate, `least_n`, too far."""
    return candidate.solution.rms > policy.selection.max_rms_ratio * least_n


def _rank(candidates: Candidates, present: Names, base: Solution, follow: Follow) -> list[Ranked]:
    """Compute the evidence of each candidate in addition to the present effects, largest first.

    The fits of competitive candidates are converged.
    """
    policy = candidates.policy
    rivals = candidates.addable(present)
    scores = candidates.score_all(present, rivals, base)
    candidates.calibrate(present)
    share = candidates.independent_share(base)
    least = policy.search.min_score_share * candidates.price(1)
    # In a correlated residual a sample is less informative, and any candidate has a small gain.
    shown = [name for name in rivals if follow == "all" or scores[name] * share > least]
    approximate, skipped = _rank_in_groups(candidates, present, shown, base, follow)
    ranked = _converge_competitive(candidates, present, approximate, base, follow)
    for name in rivals:
        if name in skipped:
            solution = candidates.look((*present, name), base).current_solution()
            gain = evidence(candidates, solution, base)
            ranked.append(Ranked(gain, name, solution, skipped[name]))
        elif name not in approximate:
            ranked.append(Ranked(-candidates.price(1), name, base))
    # At the null an effect does not change the model, which gives a lower bound of the evidence.
    ranked = [
        replace(
            r,
            evidence=max(r.evidence, -candidates.price(_parameters(candidates, present, r.effect))),
        )
        for r in ranked
    ]
    ranked.sort(key=lambda r: -r.evidence)
    # Search other maxima of the likelihood for competitive candidates.
    for i, r in enumerate(ranked):
        effects = (*present, r.effect)
        likely = max(policy.search.min_peaks_fraction * ranked[0].evidence, 0.0)
        if many_peaks(effects) and r.evidence > likely and not np.isfinite(r.limit):
            solution = candidates.search_peaks(effects)
            ranked[i] = Ranked(evidence(candidates, solution, base), r.effect, solution)
    # Of two indistinguishable effects, prefer the later stage of the measuring chain.
    order = {name: i for i, name in enumerate(rivals)}
    return sorted(ranked, key=lambda r: (-round(r.evidence, 1), -order[r.effect]))


def _rank_in_groups(
    candidates: Candidates, present: Names, shown: Sequence[str], base: Solution, follow: Follow
) -> tuple[dict[str, float], dict[str, float]]:
    """Fit candidates approximately, in groups in descending order of their largest possible gain.

    The evidence of a candidate is at most its likelihood gain, which is assumed not to exceed
    `linear_gain_factor` times the gain of the linear model after a few evaluations. If `follow` is
    `promising`, a candidate is skipped if this limit is too small for a tie with the largest
    evidence of earlier groups. An effect with many maxima of the likelihood has no such limit.

    Returns
    -------
    dict, dict
        Evidence after the approximate fit, and upper limit of the evidence of each skipped
        candidate, by name.
    """
    policy, sets = candidates.policy, {name: (*present, name) for name in shown}
    limits = dict.fromkeys(shown, np.inf)
    if follow == "promising":
        candidates.look_all([*sets.values()], base)
        factor = policy.search.linear_gain_factor
        for name in shown:
            if not many_peaks((name,)):
                limits[name] = factor * candidates.look(sets[name], base).promised
    order = sorted(shown, key=lambda name: -limits[name])
    approximate: dict[str, float] = {}
    size = policy.search.group_size
    for start in range(0, len(order), size):
        least = max([0.0, *approximate.values()]) - policy.selection.tie
        group = [name for name in order[start : start + size] if limits[name] > least]
        candidates.rank_all([sets[name] for name in group], base)
        approximate |= {n: evidence(candidates, candidates.rank(sets[n]), base) for n in group}
    return approximate, {name: limits[name] for name in order if name not in approximate}


def _converge_competitive(
    candidates: Candidates,
    present: Names,
    approximate: dict[str, float],
    base: Solution,
    follow: Follow,
) -> list[Ranked]:
    """Converge the approximate fits that may have evidence.

    If `follow` is `promising`, only those that may also lead, or tie with the leader.
    """
    policy, share = candidates.policy, candidates.independent_share(base)
    limits = {}
    for name, gain in approximate.items():
        next_step = next_step_gain(candidates.rank((*present, name))) * share
        limits[name] = gain + policy.search.step_gain_factor * next_step
    least, ranked = 0.0, []
    for name in sorted(limits, key=lambda name: -limits[name]):
        solution, gain, limit = candidates.rank((*present, name)), approximate[name], np.inf
        if limits[name] > least:
            solution = candidates.converge((*present, name))
            gain = evidence(candidates, solution, base)
        elif gain <= 0.0 < limits[name]:
            limit = limits[name]
        if follow == "promising":
            least = max(least, gain - policy.selection.tie)
        ranked.append(Ranked(gain, name, solution, limit))
    return ranked


def _parameters(candidates: Candidates, present: Names, name: str) -> int:
    """Number of parameters that an effect adds to the present model."""
    fitted, base = candidates.fitted((*present, name)), candidates.fitted(present)
    return len(fitted.problem.open) - len(base.problem.open)
