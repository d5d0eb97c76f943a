"""Selection: rounds that add the effect the data ask for, and question those that are there.

In a round every candidate is tried beside what the model already holds, in order of cost: a score
test, a ranking, a converged fit. The leader is added if runs that it was not fitted to agree. Then
the other effects are questioned again: one that is no longer needed goes, one that another would
replace better is exchanged.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from scipy import special

from jbf.diagnosis.candidates import Candidates, many_peaks
from jbf.diagnosis.evidence import (
    evidence,
    evidence_alone,
    full_gain,
    price_of,
    swap_cost,
)
from jbf.diagnosis.ledger import Outcome, Trial
from jbf.diagnosis.machine import OFFSET, TERMS, machine_of
from jbf.diagnosis.policy import Policy
from jbf.estimation.likelihood import effective_share, likelihood_gain, next_step_gain
from jbf.estimation.solution import Solution
from jbf.models.catalogue import may_come, may_go

Names = tuple[str, ...]
Follow = Literal["promising", "shown", "all"]

AHEAD = 3
"""Candidates that gained most at a first look, of which one may lead."""
LESS = 0.95
"""Share of an RMS below which another is less for anybody who reads the ledger."""
CHANCE = "gains no more than chance would"
SLIGHT = "gains more than noise would, but no more than what recordings do to a record"
SMOOTH = "fits better, but by no more than so smooth a residual strays: too few independent samples"


@dataclass(frozen=True)
class Ranked:
    """A candidate beside a model: its evidence, and the solution that has it; where it was not
    followed, the most evidence that it could have."""

    evidence: float
    effect: str
    solution: Solution
    most: float = np.inf


@dataclass(frozen=True)
class Round:
    """One round of trials beside a model; `unconfirmed` are the candidates that had more evidence
    than the leader, and predicted runs left out no better."""

    trials: tuple[Trial, ...]
    leader: str | None
    unconfirmed: frozenset[str] = frozenset()


def try_candidates(candidates: Candidates, present: Names, follow: Follow = "promising") -> Round:
    """Fit every candidate beside the effects present, and say which should be added.

    Parameters
    ----------
    follow
        The candidates that are fitted: those that could lead by a first look, those that show in
        their score test, or all of them: of a strong effect the score at its null may say nothing.
    """
    base, policy = candidates.converge(present), candidates.policy
    unit = candidates.campaign.rig.quantities.force
    ranked = _rank(candidates, present, base, follow)
    leader, best, trials = None, 0.0, []
    unconfirmed: set[str] = set()
    bare = base.rms_n
    least = min((r.solution.rms_n for r in ranked if r.evidence > 0), default=bare)
    for found in sorted(ranked, key=lambda r: _leaves_more(r, least, policy)):
        name, gain = found.effect, found.evidence
        rms = min(found.solution.rms_n, bare)
        outcome: Outcome
        outcome = "no gain"
        reason = SMOOTH if rms < LESS * bare else CHANCE
        if gain > candidates.level.critical - price_of(candidates, 1):
            reason = SLIGHT
        if gain <= 0.0 and gain > candidates.level.significant - price_of(candidates, 1):
            outcome = "negligible"
            reason = f"possible, but it reduces the error by {1.0 - rms / bare:.1%} only"
        if np.isfinite(found.most):
            outcome = "rejected"
            reason = f"could have {max(found.most, 0.0):.0f} in evidence at most: not followed"
        elif gain > 0 and leader is None:
            out = candidates.confirmation(present, name)
            alone = evidence_alone(candidates, found.solution, base)
            if alone <= 0.0:
                gain, reason = alone, "gains by the samples that it sets aside, not by itself"
            elif out.confirms(gain, bare**2 - rms**2, policy):
                if _found_its_way(candidates, present, name, base):
                    return try_candidates(candidates, present, follow)
                leader, best = name, gain
                outcome, reason = "added", f"largest evidence; {out.said(unit)}"
            else:
                outcome = "rejected"
                reason = f"fits better but predicts left-out runs no better ({out.lacking(unit)})"
                unconfirmed.add(name)
        elif gain > 0 and _leaves_more(found, least, policy):
            outcome, reason = "rejected", f"leaves {rms:.3g} {unit} where {leader} does not"
        elif gain > 0 and gain > best - policy.tie:
            outcome, reason = "ties", f"fits as well as {leader}"
        elif gain > 0:
            outcome = "rejected"
            reason = f"{leader} leads by {best - gain:.0f} in evidence"
        trials.append(Trial(name, rms, float(gain), outcome, reason))
    behind = max((r.most for r in ranked if np.isfinite(r.most)), default=-np.inf)
    if behind > best:
        # What it was left behind for does not lead.
        return try_candidates(candidates, present, "shown")
    if leader is None:
        tried = [r for r in ranked if r.effect not in unconfirmed]
        leader, trials = _by_units(candidates, present, tried, trials)
    ordered = tuple(sorted(trials, key=lambda t: -t.evidence))
    return Round(ordered, leader, frozenset(unconfirmed))


def _by_units(
    candidates: Candidates, present: Names, ranked: Sequence[Ranked], trials: list[Trial]
) -> tuple[str | None, list[Trial]]:
    """The candidate with the largest gain by the likelihood alone that independent units confirm.

    Where the residual is smooth, few of its samples are independent, and a slow or constant effect
    has no evidence; runs or strokes are independent whatever the residual is.
    """
    base = candidates.converge(present)
    gains = {
        r.effect: full_gain(candidates, r.solution, base) for r in ranked if not np.isfinite(r.most)
    }
    for name in sorted(gains, key=lambda name: -gains[name])[:AHEAD]:
        if gains[name] > 0.0 and units_confirm(candidates, present, name):
            out = candidates.confirmation(present, name)
            unit = candidates.campaign.rig.quantities.force
            reason = (
                f"{out.units} units are predicted better, p = {out.chance:.1g}; {out.said(unit)}"
            )
            added = [
                replace(t, outcome="added", reason=reason) if t.effect == name else t
                for t in trials
            ]
            return name, added
    return None, trials


def units_confirm(candidates: Candidates, rest: Names, name: str) -> bool:
    """Whether independent units are predicted better with an effect than without, by more than
    chance."""
    return candidates.confirmation(rest, name).units_confirm(candidates.level.chance)


def needed(candidates: Candidates, current: Names, name: str, simpler: Solution) -> bool:
    """Whether an effect of a model has evidence, or is confirmed by independent units."""
    whole = candidates.converge(current)
    if evidence(candidates, whole, simpler) >= 0.0:
        return True
    rest = tuple(e for e in current if e != name)
    gains = full_gain(candidates, whole, simpler) > 0.0
    return gains and units_confirm(candidates, rest, name)


def _found_its_way(candidates: Candidates, present: Names, name: str, base: Solution) -> bool:
    """Whether the model without an effect fits better from where the fit with it ended: then the
    gain was that of a way past a valley, and not the effect's."""
    better = candidates.refit_from(present, (*present, name))
    return likelihood_gain(better, base) > candidates.policy.contender


def _leaves_more(found: Ranked, least_n: float, policy: Policy) -> bool:
    """Whether a candidate leaves much more than another that has evidence, too."""
    return found.solution.rms_n > policy.leader_rms * least_n


def _rank(candidates: Candidates, present: Names, base: Solution, follow: Follow) -> list[Ranked]:
    """Every candidate beside the effects present, most evidence first; those that could lead have
    converged."""
    policy = candidates.policy
    rivals = [n for n in candidates.names if n not in present and may_come(n, present)]
    share = effective_share(base)
    candidates.score_all([(*present, name) for name in rivals], base)
    scores = {name: candidates.score_test((*present, name), base) for name in rivals}
    candidates.calibrate(present)
    least = policy.least_score * price_of(candidates, 1)
    # Of a smooth error a sample tells less, and anything gains a little.
    shown = [name for name in rivals if follow == "all" or scores[name] * share > least]
    first = dict.fromkeys(rivals, -np.inf)
    behind = _left_behind(candidates, present, shown, base) if follow == "promising" else {}
    followed = [name for name in shown if name not in behind]
    candidates.rank_all([(*present, name) for name in followed], base)
    for name in followed:
        first[name] = evidence(candidates, candidates.rank((*present, name)), base)
    line = policy.close * max(max(first.values(), default=0.0), 0.0) - policy.contender
    found: list[Ranked] = []
    for name in rivals:
        effects = (*present, name)
        if name in behind:
            solution = candidates.look(effects, base).found()
        elif first[name] == -np.inf:
            solution = base
        else:
            solution = candidates.rank(effects)
            promised = first[name] + policy.promise * next_step_gain(solution) * share
            if first[name] > line and promised > 0.0:
                solution = candidates.converge(effects)
        # At its null an effect leaves the model as it was: no candidate is worse than that.
        more = len(candidates.fitted(effects).problem.open) - base.free
        gain = max(evidence(candidates, solution, base), -price_of(candidates, more))
        found.append(Ranked(gain, name, solution, behind.get(name, np.inf)))
    found.sort(key=lambda r: -r.evidence)
    # One that might lead from a higher peak gets its chance.
    for i, r in enumerate(found):
        effects = (*present, r.effect)
        likely = max(policy.peaks_share * found[0].evidence, 0.0)
        if many_peaks(effects) and r.evidence > likely and r.effect not in behind:
            solution = candidates.search_peaks(effects)
            found[i] = Ranked(evidence(candidates, solution, base), r.effect, solution)
    # Of two that are one in these runs the one nearer to the record supposes less of the machine.
    order = {name: i for i, name in enumerate(rivals)}
    return sorted(found, key=lambda r: (-round(r.evidence, 1), -order[r.effect]))


def _left_behind(
    candidates: Candidates, present: Names, shown: Sequence[str], base: Solution
) -> dict[str, float]:
    """After a first look at every candidate: those that could not come near the leader, and the
    most evidence that each could have."""
    policy = candidates.policy
    candidates.look_all([(*present, name) for name in shown], base)
    looked = {name: candidates.look((*present, name), base) for name in shown}
    most = {name: policy.foreseen * fitted.promised for name, fitted in looked.items()}
    gained = {name: likelihood_gain(looked[name].found(), base) for name in shown}
    ahead = sorted(shown, key=lambda name: -gained[name])[:AHEAD]
    leads = max((evidence(candidates, looked[n].found(), base) for n in ahead), default=0.0)
    line = policy.close * max(leads, 0.0) - policy.contender
    return {name: gain for name, gain in most.items() if gain < line}


def still_needed(candidates: Candidates, effects: Sequence[str]) -> Names:
    """The effects that have evidence yet, now that the samples are seen in another light."""
    current = tuple(effects)
    for name in effects:
        if not may_go(name, current):
            continue
        rest = tuple(e for e in current if e != name)
        simpler = candidates.refit_from(rest, current)
        if not needed(candidates, current, name, simpler):
            current = rest
    return current


def start_model(candidates: Candidates) -> Names:
    """The terms of a drive's machine that these runs need, estimated together with the law.

    Each term starts from the fit without it: from their starting values all at once, a search may
    end at a weight of zero. A term without evidence stays if runs are predicted worse without it:
    where another effect is missing, the residual is so smooth that nothing has evidence.
    """
    present: Names = ()
    policy = candidates.policy
    for name in machine_of(candidates, [n for n in TERMS if n in candidates.names]):
        near = candidates.converge(present)
        present = (*present, name)
        candidates.look(present, near)
        candidates.converge(present)
    for name in present:
        rest = tuple(e for e in present if e != name)
        simpler = candidates.refit_from(rest, present)
        worse = candidates.left_out_rms(rest) > policy.no_worse * candidates.left_out_rms(present)
        if not (worse or needed(candidates, present, name, simpler)):
            present = rest
    return present


def reconsider(
    candidates: Candidates, present: Names, unconfirmed: frozenset[str] = frozenset()
) -> Names:
    """Take out effects that are no longer needed; exchange those that another replaces better;
    until nothing changes: what comes in another's place may make more of them needless.

    Parameters
    ----------
    unconfirmed
        Effects that runs left out have just spoken against: none of them comes in by the back door.
    """
    seen = [present]
    while (current := _questioned(candidates, seen[-1], unconfirmed)) not in seen:
        seen.append(current)
    return current


def _questioned(candidates: Candidates, present: Names, unconfirmed: frozenset[str]) -> Names:
    """Each of the effects in turn."""
    current = present
    for name in present:
        if len(current) < 2 or name not in current or not may_go(name, current):
            continue
        rest = tuple(e for e in current if e != name)
        candidates.search_peaks(rest)
        simpler = candidates.refit_from(rest, current)
        whole = candidates.converge(current)
        if not needed(candidates, current, name, simpler):
            current = rest
            continue
        if name in machine_of(candidates, current) and name != OFFSET:
            continue  # inertia and weight are no stand-ins for an effect; an offset may be
        best, gain = name, candidates.policy.tie
        for other in candidates.names:
            if other in current or other in unconfirmed or not may_come(other, rest):
                continue
            better = -swap_cost(candidates, (*rest, other), whole, simpler)
            if better > gain:
                best, gain = other, better
        if best != name:
            current = tuple(best if e == name else e for e in current)
    return current


def weights(candidates: Candidates, present: Names) -> dict[str, dict[str, float]]:
    """For each effect its posterior weight and those of the candidates that could stand in its
    place.

    At equal odds before, among those that have at least `least_weight` beside it alone (Kass &
    Raftery 1995); the effect first, the others as they weigh. An effect that nothing could replace
    weighs one.
    """
    whole = candidates.converge(present)
    found: dict[str, dict[str, float]] = {}
    for name in present:
        rest = tuple(e for e in present if e != name)
        simpler = candidates.converge(rest)
        costs = {
            other: swap_cost(candidates, (*rest, other), whole, simpler)
            for other in candidates.names
            if other not in present and may_come(other, rest)
        }
        close = {other: cost for other, cost in costs.items() if cost < candidates.policy.tie}
        order = [name, *sorted(close, key=lambda other: close[other])]
        share = special.softmax([-0.5 * close.get(other, 0.0) for other in order])
        found[name] = dict(zip(order, share.tolist(), strict=True))
    return found
