"""Stepwise selection: rounds that add an effect with evidence and review the effects present.

In a round every candidate is tested in addition to the present effects, in order of computing cost:
a score test, an approximate fit, a converged fit. The candidate with the largest evidence is added
if held-out runs confirm it. The other effects are then reviewed: an unnecessary effect is removed,
and an effect is replaced by another one that has more evidence.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from scipy import special

from jbf.diagnosis.candidates import Candidates
from jbf.diagnosis.drive import OFFSET, TERMS, machine_of
from jbf.diagnosis.evidence import (
    evidence,
    evidence_on_common_samples,
    full_gain,
    price_of,
    swap_costs,
)
from jbf.diagnosis.ledger import Outcome, Trial
from jbf.diagnosis.policy import Policy
from jbf.estimation.likelihood import likelihood_gain, next_step_gain
from jbf.estimation.minimum import many_peaks
from jbf.estimation.solution import Solution
from jbf.models.catalogue import can_be_added, can_be_removed

Names = tuple[str, ...]
Follow = Literal["promising", "shown", "all"]

LESS = 0.95
"""Ratio of RMS values, with to without a candidate, from which the ledger reports a better fit.

It affects the text only.
"""
CHANCE = "no significant gain"
SLIGHT = "significant, but within the margin for recording artefacts"
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
    unconfirmed
        Candidates with more evidence than the leader, but not confirmed by held-out runs.
    """

    trials: tuple[Trial, ...]
    leader: str | None
    unconfirmed: frozenset[str] = frozenset()


def try_candidates(candidates: Candidates, present: Names, follow: Follow = "promising") -> Round:
    """Test every candidate in addition to the present effects, and select the one to add.

    Parameters
    ----------
    candidates, present
        Cached fits, and the effects of the present model.
    follow
        Candidates to fit: those with a sufficient score (`shown`), of these only the ones that may
        still lead after a few steps (`promising`), or all. For a strong effect, the score at its
        null may be uninformative.
    """
    base, policy = candidates.converge(present), candidates.policy
    unit = candidates.campaign.rig.quantities.force
    ranked = _rank(candidates, present, base, follow)
    leader, best, trials = None, 0.0, []
    unconfirmed: set[str] = set()
    bare = base.rms
    least = min((r.solution.rms for r in ranked if r.evidence > 0), default=bare)
    for candidate in sorted(ranked, key=lambda r: _has_larger_rms(r, least, policy)):
        name, gain = candidate.effect, candidate.evidence
        rms = min(candidate.solution.rms, bare)
        outcome: Outcome
        outcome = "no gain"
        reason = SMOOTH if rms < LESS * bare else CHANCE
        if gain > candidates.level.critical - price_of(candidates, 1):
            reason = SLIGHT
        if gain <= 0.0 and gain > candidates.level.significant - price_of(candidates, 1):
            outcome = "negligible"
            reason = f"significant, but reduces the error by only {1.0 - rms / bare:.1%}"
        if np.isfinite(candidate.limit):
            outcome = "rejected"
            reason = (
                f"skipped: its largest possible evidence is {max(candidate.limit, 0.0):.0f}, "
                "too little to lead"
            )
        elif gain > 0 and leader is None:
            confirmation = candidates.confirmation(present, name)
            alone = evidence_on_common_samples(candidates, candidate.solution, base)
            if alone <= 0.0:
                gain, reason = alone, "the gain comes from the samples that it excludes"
            elif confirmation.confirms(gain, bare**2 - rms**2, policy):
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
    if max((r.limit for r in ranked if np.isfinite(r.limit)), default=-np.inf) > best:
        # The leader that these candidates were compared with was not accepted.
        return try_candidates(candidates, present, "shown")
    if leader is None:
        tried = [r for r in ranked if r.effect not in unconfirmed]
        leader, trials = _by_units(candidates, present, tried, trials)
    ordered = tuple(sorted(trials, key=lambda t: -t.evidence))
    return Round(ordered, leader, frozenset(unconfirmed))


def _by_units(
    candidates: Candidates, present: Names, ranked: Sequence[Ranked], trials: list[Trial]
) -> tuple[str | None, list[Trial]]:
    """Select the candidate with the largest likelihood gain that independent units confirm.

    In a correlated residual few samples are independent, and a slow or constant effect has little
    evidence. Runs or strokes (the units) are independent even then. Returns its name, or None, and
    the updated trials.
    """
    base = candidates.converge(present)
    gains = {
        r.effect: full_gain(candidates, r.solution, base)
        for r in ranked
        if not np.isfinite(r.limit)
    }
    for name in sorted(gains, key=lambda name: -gains[name])[: candidates.policy.search.leaders]:
        if gains[name] > 0.0 and units_confirm(candidates, present, name):
            confirmation = candidates.confirmation(present, name)
            unit = candidates.campaign.rig.quantities.force
            better = (
                f"{confirmation.units} units are predicted better, p = {confirmation.chance:.1g}"
            )
            reason = f"{better}; {confirmation.describe(unit)}"
            added = [
                replace(t, outcome="added", reason=reason) if t.effect == name else t
                for t in trials
            ]
            return name, added
    return None, trials


def units_confirm(candidates: Candidates, rest: Names, name: str) -> bool:
    """Whether an effect of at least the minimum size improves predictions of independent units."""
    level = candidates.level
    return candidates.confirmation(rest, name).units_confirm(level.chance, level.min_share)


def needed(candidates: Candidates, current: Names, name: str, simpler: Solution) -> bool:
    """Whether an effect of the current model has evidence or is confirmed by held-out runs.

    If another effect is missing, the residual may be so correlated that no effect has evidence. An
    effect is needed even then if independent units confirm it, or if the held-out error is larger
    without it.
    """
    full = candidates.converge(current)
    if evidence(candidates, full, simpler) >= 0.0:
        return True
    if full_gain(candidates, full, simpler) <= 0.0:
        return False
    rest = tuple(e for e in current if e != name)
    if units_confirm(candidates, rest, name):
        return True
    least = candidates.policy.held_out.no_worse_ratio * candidates.held_out_rms(current)
    return candidates.held_out_rms(rest) > least


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
    gains = candidates.score_all([(*present, n) for n in rivals], base)
    scores = dict(zip(rivals, gains, strict=True))
    candidates.calibrate(present)
    share = candidates.independent_share(base)
    least = policy.search.min_score_share * price_of(candidates, 1)
    # In a correlated residual a sample is less informative, and any candidate has a small gain.
    shown = [name for name in rivals if follow == "all" or scores[name] * share > least]
    approximate = dict.fromkeys(rivals, -np.inf)
    limits = _limits_below_leader(candidates, present, shown, base) if follow == "promising" else {}
    followed = [name for name in shown if name not in limits]
    candidates.rank_all([(*present, name) for name in followed], base)
    for name in followed:
        approximate[name] = evidence(candidates, candidates.rank((*present, name)), base)
    line = (
        policy.search.rank_fraction * max(max(approximate.values(), default=0.0), 0.0)
        - policy.search.rank_margin
    )
    ranked: list[Ranked] = []
    for name in rivals:
        effects = (*present, name)
        if name in limits:
            solution = candidates.look(effects, base).current_solution()
        elif approximate[name] == -np.inf:
            solution = base
        else:
            solution = candidates.rank(effects)
            promised = (
                approximate[name]
                + policy.search.step_gain_factor * next_step_gain(solution) * share
            )
            if approximate[name] > line and promised > 0.0:
                solution = candidates.converge(effects)
        # At the null an effect does not change the model, which gives a lower bound of the
        # evidence.
        more = len(candidates.fitted(effects).problem.open) - base.free
        gain = max(evidence(candidates, solution, base), -price_of(candidates, more))
        ranked.append(Ranked(gain, name, solution, limits.get(name, np.inf)))
    ranked.sort(key=lambda r: -r.evidence)
    # Search other maxima of the likelihood for competitive candidates.
    for i, r in enumerate(ranked):
        effects = (*present, r.effect)
        likely = max(policy.search.min_peaks_fraction * ranked[0].evidence, 0.0)
        if many_peaks(effects) and r.evidence > likely and r.effect not in limits:
            solution = candidates.search_peaks(effects)
            ranked[i] = Ranked(evidence(candidates, solution, base), r.effect, solution)
    # Of two indistinguishable effects, prefer the later stage of the measuring chain.
    order = {name: i for i, name in enumerate(rivals)}
    return sorted(ranked, key=lambda r: (-round(r.evidence, 1), -order[r.effect]))


def _limits_below_leader(
    candidates: Candidates, present: Names, shown: Sequence[str], base: Solution
) -> dict[str, float]:
    """Upper limits of the gain, and thus evidence, of candidates that cannot lead, by name."""
    policy = candidates.policy
    candidates.look_all([(*present, name) for name in shown], base)
    looked = {name: candidates.look((*present, name), base) for name in shown}
    most = {
        name: policy.search.linear_gain_factor * fitted.promised for name, fitted in looked.items()
    }
    gained = {name: likelihood_gain(looked[name].current_solution(), base) for name in shown}
    ahead = sorted(shown, key=lambda name: -gained[name])[: policy.search.leaders]
    leads = max(
        (evidence(candidates, looked[n].current_solution(), base) for n in ahead), default=0.0
    )
    line = policy.search.rank_fraction * max(leads, 0.0) - policy.search.rank_margin
    return {name: gain for name, gain in most.items() if gain < line}


def still_needed(candidates: Candidates, effects: Sequence[str]) -> Names:
    """Remove effects that have no evidence after a change of the sample weights or the campaign."""
    current = tuple(effects)
    for name in effects:
        if not can_be_removed(name, current):
            continue
        rest = tuple(e for e in current if e != name)
        simpler = candidates.refit_from(rest, current)
        if not needed(candidates, current, name, simpler):
            current = rest
    return current


def start_model(candidates: Candidates) -> Names:
    """Select the machine terms of a drive that the runs require, estimated jointly with the law.

    The fit with each term starts from the fit without it, since a search from the starting values
    of all terms may end at a weight of zero.
    """
    present: Names = ()
    for name in machine_of(candidates.campaign.rig, [n for n in TERMS if n in candidates.names]):
        near = candidates.converge(present)
        present = (*present, name)
        candidates.look(present, near)
        candidates.converge(present)
    return still_needed(candidates, present)


def reconsider(
    candidates: Candidates, present: Names, unconfirmed: frozenset[str] = frozenset()
) -> Names:
    """Remove unnecessary effects, and replace an effect if another one has more evidence.

    The review is repeated until the model no longer changes, since a replacement may make further
    effects unnecessary.

    Parameters
    ----------
    unconfirmed
        Effects that held-out runs did not confirm in this round; not used as replacements.
    """
    seen = [present]
    while (current := _reviewed_once(candidates, seen[-1], unconfirmed)) not in seen:
        seen.append(current)
    return current


def _reviewed_once(candidates: Candidates, present: Names, unconfirmed: frozenset[str]) -> Names:
    """Review each effect once: keep, remove or replace it, and return the resulting effects."""
    current = present
    for name in present:
        if len(current) < 2 or name not in current or not can_be_removed(name, current):
            continue
        rest = tuple(e for e in current if e != name)
        candidates.search_peaks(rest)
        simpler = candidates.refit_from(rest, current)
        full = candidates.converge(current)
        if not needed(candidates, current, name, simpler):
            current = rest
            continue
        if name in machine_of(candidates.campaign.rig, current) and name != OFFSET:
            continue  # inertia and weight do not imitate an effect; an offset may
        others = [
            other
            for other in candidates.names
            if not (other in current or other in unconfirmed) and can_be_added(other, rest)
        ]
        costs = swap_costs(candidates, rest, others, full, simpler)
        best = min(costs, key=costs.__getitem__, default=name)
        if best != name and costs[best] < -candidates.policy.selection.tie:
            current = tuple(best if e == name else e for e in current)
    return current


def weights(candidates: Candidates, present: Names) -> dict[str, dict[str, float]]:
    """Posterior weights of each effect and its alternatives, at equal prior odds, by name.

    The alternatives of an effect are the candidates that have at least the minimum weight if
    compared with this effect only (Kass & Raftery 1995). The effect is first, the others follow by
    weight. An effect without alternatives has weight one.
    """
    full = candidates.converge(present)
    posterior: dict[str, dict[str, float]] = {}
    for name in present:
        rest = tuple(e for e in present if e != name)
        simpler = candidates.converge(rest)
        others = [n for n in candidates.names if n not in present and can_be_added(n, rest)]
        costs = swap_costs(candidates, rest, others, full, simpler)
        close = {
            other: cost for other, cost in costs.items() if cost < candidates.policy.selection.tie
        }
        order = [name, *sorted(close, key=lambda other: close[other])]
        share = special.softmax([-0.5 * close.get(other, 0.0) for other in order])
        posterior[name] = dict(zip(order, share.tolist(), strict=True))
    return posterior
