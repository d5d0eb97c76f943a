"""Rounds of selection, one effect after another, until no candidate leads."""

from __future__ import annotations

import itertools
from dataclasses import dataclass, replace

import numpy as np

from jbf.diagnosis.candidates import Candidates
from jbf.diagnosis.deviations import allowing_for, deviation
from jbf.diagnosis.evidence import evidence, evidence_alone, full_gain, price_of
from jbf.diagnosis.ledger import Extrapolation, Remainder, Step, Trial
from jbf.diagnosis.selection import (
    Follow,
    Names,
    Round,
    reconsider,
    start_model,
    still_needed,
    try_candidates,
)
from jbf.diagnosis.shifted import DELAY
from jbf.estimation.campaign import Campaign
from jbf.estimation.left_out import errors_by_run
from jbf.estimation.likelihood import likelihood_gain
from jbf.estimation.run_start import settled_again
from jbf.estimation.samples import least_weights
from jbf.models.catalogue import may_come


@dataclass(frozen=True)
class Selected:
    """What rounds of selection led to.

    Attributes
    ----------
    present, steps, refused
        The effects added, the ledger, and what was refused.
    again
        The campaign as what was found so far shows it, where selection is to go on with that: with
        a deviation of its runs allowed for, which the data ask for more than for any effect, or
        without samples at which the film of the effects present is not settled.
    """

    present: Names
    steps: list[Step]
    refused: tuple[Remainder, ...] = ()
    again: Campaign | None = None


def select(
    candidates: Candidates,
    noise_n: float,
    start: Selected | None = None,
    follow: Follow = "promising",
) -> Selected:
    """Rounds until no candidate leads, from the law with its machine or from effects that were
    there; in the first of them `follow` says which candidates are fitted."""
    steps: list[Step] = []
    if start is not None and start.present:
        present = still_needed(candidates, start.present)
        steps = start.steps[:-1]
    else:
        present = start_model(candidates)
    visited = {frozenset(present)}
    while True:
        candidates.converge(present)
        candidates.reached.candidates, candidates.reached.present = candidates, present
        settled = settled_again(candidates.fitted(present).problem, candidates.converge(present))
        if settled is not None:
            steps.append(step(candidates, present, noise_n, ()))
            return Selected(present, steps, again=settled)
        found = try_candidates(candidates, present, follow)
        every = follow == "all"
        follow = "promising"
        steps.append(step(candidates, present, noise_n, found.trials))
        if every and found.leader is None:
            together = _pair(candidates, present, found)
            if frozenset(together) not in visited:
                visited.add(frozenset(together))
                present = together
                continue
        differ = _differ_more(candidates, present, found)
        if differ is not None:
            return Selected(present, steps, again=differ)
        if found.leader is None:
            return Selected(present, steps, _refused(candidates, present))
        if len(present) >= candidates.policy.most_effects:
            return Selected(present, steps, (_one_more(candidates, present, found.leader),))
        grown = _grown(candidates, present, found)
        if frozenset(grown) in visited:
            return Selected(present, steps)
        visited.add(frozenset(grown))
        present = grown


def _grown(candidates: Candidates, present: Names, found: Round) -> Names:
    """The model with the leading candidate, and without what that makes needless; with one that is
    tied with it, if that leaves fewer effects."""
    tied = [t.effect for t in found.trials if t.outcome == "ties"]
    best: Names | None = None
    for name in (found.leader, *tied) if present else (found.leader,):
        assert name is not None
        candidates.search_peaks((*present, name))
        grown = reconsider(candidates, (*present, name), found.unconfirmed)
        if best is None or (
            len(grown) < len(best)
            # A tied candidate has not been confirmed by runs left out.
            and candidates.left_out_rms(grown) <= candidates.left_out_rms(best)
        ):
            best = grown
    assert best is not None
    return best


def _pair(candidates: Candidates, present: Names, found: Round) -> Names:
    """The model with the pair of effects that explains most, if it is needed.

    Beside a model that lacks two effects, neither may have evidence alone: what remains is smooth.
    """
    policy = candidates.policy
    if len(present) + 2 > policy.most_effects:
        return present
    ahead = [t.effect for t in sorted(found.trials, key=lambda t: t.rms_n)[: policy.paired]]
    pairs = [(*present, *pair) for pair in itertools.combinations(ahead, 2)]
    pairs += [
        (*present, name, other)
        for name in ahead[:2]
        for other in _promising(candidates, (*present, name))
    ]
    pairs = [
        pair for pair in pairs if may_come(pair[-2], present) and may_come(pair[-1], pair[:-1])
    ]
    if not pairs:
        return present
    base = candidates.converge(present)
    candidates.rank_all(pairs, base)
    best = max(pairs, key=lambda pair: likelihood_gain(candidates.rank(pair), base))
    whole = candidates.converge(best)
    if candidates.left_out_rms(best) > candidates.left_out_rms(present) / policy.no_worse:
        return present
    if evidence(candidates, whole, base) <= 0.0 and full_gain(candidates, whole, base) <= 0.0:
        return present
    return reconsider(candidates, still_needed(candidates, best))


def _promising(candidates: Candidates, present: Names) -> list[str]:
    """The candidates with the largest scores next to a model."""
    near = candidates.converge(present)
    names = [n for n in candidates.names if n not in present and may_come(n, present)]
    candidates.score_all([(*present, name) for name in names], near)
    scores = {name: candidates.score_test((*present, name), near) for name in names}
    finite = [name for name in names if np.isfinite(scores[name])]
    return sorted(finite, key=lambda name: -scores[name])[: candidates.policy.paired]


def _one_more(candidates: Candidates, present: Names, leader: str) -> Remainder:
    """What a search that ends with a leader in hand leaves unsaid."""
    base, richer = candidates.converge(present), candidates.converge((*present, leader))
    unit = candidates.campaign.rig.quantities.force
    where = (
        f"{leader} would bring {base.rms_n:.3g} {unit} down to {richer.rms_n:.3g} {unit} beside "
        f"{len(present)} effects, and no more are searched for"
    )
    return Remainder("effects", where, max(1.0 - (richer.rms_n / base.rms_n) ** 2, 0.0))


def _differ_more(candidates: Candidates, present: Names, found: Round) -> Campaign | None:
    """The campaign with a deviation of its runs that has more evidence than the leading effect."""
    problem, solution = candidates.fitted(present).problem, candidates.converge(present)
    campaign, policy = candidates.campaign, candidates.policy
    # More than chance would, and more than any effect.
    least = price_of(candidates, 1) + max(
        (t.evidence for t in found.trials if t.evidence > 0.0), default=0.0
    )
    differ = deviation(problem, solution, campaign.samples, policy, least)
    if differ is None:
        return None
    allowed = allowing_for(campaign, differ)
    if found.leader is not None:
        # One number that says of all runs what each would say of itself.
        leads_n = candidates.converge((*present, found.leader)).rms_n
        apart = allowed.samples.without_deviations(solution.residuals, solution.noise)
        if _says_as_much(solution.rms_n, leads_n, solution.samples.rms(apart), policy.no_worse):
            return None
    return allowed


def _says_as_much(before_n: float, effect_n: float, apart_n: float, most: float) -> bool:
    """Whether an effect leaves as little as the deviations of the runs do, N RMS, and explains as
    much of what both may: where that is little beside the noise, all leave as little."""
    left, explained = effect_n**2 - apart_n**2, before_n**2 - apart_n**2
    return effect_n <= most * apart_n and left <= (most**2 - 1.0) * max(explained, 0.0)


def step(candidates: Candidates, effects: Names, noise_n: float, trials: tuple[Trial, ...]) -> Step:
    rms, left_out = candidates.converge(effects).rms_n, candidates.left_out_rms(effects)
    return Step(effects, rms, left_out, noise_n, trials, _extrapolations(candidates, effects))


def _extrapolations(candidates: Candidates, effects: Names) -> tuple[Extrapolation, ...]:
    """Errors of the runs beyond all others, predicted by a fit to those alone."""
    if not candidates.beyond:
        return ()
    unit, names = candidates.campaign.rig.quantities, candidates.campaign.samples.runs
    errors = errors_by_run(candidates.converge(effects), candidates.left_out(effects))
    found = []
    for beyond in candidates.beyond:
        own = errors.get(beyond.run, np.zeros(0))
        if len(own):
            size = f" {unit.speed}" if beyond.quantity == "speed" else ""
            own_range = f"{beyond.quantity} {beyond.value:.3g}{size}"
            where = f"{own_range}, others to {beyond.others:.3g}{size}"
            rms = float(np.sqrt(np.mean(own**2)))
            found.append(Extrapolation(names[beyond.run], rms, where))
    return tuple(found)


def _refused(candidates: Candidates, present: Names) -> tuple[Remainder, ...]:
    """What a candidate saw that helps where it was fitted, or in places, and not elsewhere.

    Beside the instants at which friction jumps it is none: a clock that is off by less than a
    sample, by another time in each run, makes those errors.
    """
    policy, fitted = candidates.policy, candidates.one_more(present)
    base = candidates.converge(present)
    # What a delay would move is set aside, as where it is fitted itself.
    delay = fitted.get(DELAY)
    away = base.samples if delay is None else delay.found().samples
    found = []
    for name, problem in fitted.items():
        richer = problem.found()
        samples = least_weights(richer.samples, away)
        with_it, without = (replace(s, samples=samples) for s in (richer, base))
        better = with_it.rms_n < policy.refused_rms * without.rms_n
        gains = evidence_alone(candidates, with_it, without, anywhere=True) > policy.weak
        if better and gains:
            found.append((richer.rms_n, name))
    if not found:
        return ()
    rms, name = min(found)
    share = max(1.0 - (rms / base.rms_n) ** 2, 0.0)
    if candidates.campaign.motion_uncertain and share < policy.motion_share:
        return ()
    unit = candidates.campaign.rig.quantities.force
    fits = f"{name} fits {base.rms_n:.3g} {unit} down to {rms:.3g} {unit}"
    where = f"{fits} but predicts runs left out no better"
    return (Remainder("run", where, share),)
