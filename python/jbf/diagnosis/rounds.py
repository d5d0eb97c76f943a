"""Rounds of selection that add one effect at a time, until no candidate is accepted."""

from __future__ import annotations

import itertools
from dataclasses import dataclass, field, replace

import numpy as np

from jbf.arrays import Names
from jbf.diagnosis.candidates import Candidates
from jbf.diagnosis.evidence import evidence, evidence_on_common_samples, full_gain
from jbf.diagnosis.ledger import SEARCH, Extrapolation, Remainder, Step, Trial
from jbf.diagnosis.residual_structure import find_residual_structure
from jbf.diagnosis.review import reconsider, start_model, still_needed
from jbf.diagnosis.selection import OF_SMOOTHING, Follow, Round, try_candidates
from jbf.diagnosis.terms import best_term_update, re_estimated_motion
from jbf.errors import Unfinished
from jbf.estimation.held_out import errors_by_run
from jbf.estimation.likelihood import likelihood_gain
from jbf.estimation.noise_floor import noise_floor
from jbf.estimation.samples import common_samples
from jbf.estimation.transients import without_further_transients
from jbf.models.catalogue import can_be_added
from jbf.models.delayed_reading import DELAY


@dataclass(frozen=True)
class Selected:
    """Result of the stepwise selection of effects and terms.

    Attributes
    ----------
    candidates
        Fits to the campaign with the accepted terms of the observation model.
    present
        Accepted effects.
    steps
        The ledger, one step per round.
    remainders
        Reported in addition to the residual structure: an effect that fits better but does not
        improve the held-out predictions, the limit on the number of effects, or the reason why the
        selection did not finish.
    not_tried
        Effects that were not tested in addition to `present`, because the selection did not finish,
        with the reason.
    """

    candidates: Candidates
    present: Names
    steps: list[Step]
    remainders: tuple[Remainder, ...] = ()
    not_tried: dict[str, str] = field(default_factory=dict)


FURTHER = "further effects and recording artefacts"
"""Name of what a selection omitted where the tests of no single effect are missing."""


def select(candidates: Candidates) -> Selected:
    """Add effects and terms of the observation model in rounds, the largest evidence first.

    The selection ends when no further effect or term is accepted. It starts with the law and the
    machine terms of a drive. If no effect is accepted and the residual has structure, all
    candidates and then pairs of them are fitted, since the score of a strong effect at its null may
    be small.

    Raises
    ------
    Unfinished
        The first round exceeds the budget or the time limit. If a later one exceeds it, the
        selection ends with the last model whose candidates were tested.
    """
    completed: list[Selected] = []
    try:
        return _select(candidates, completed)
    except Unfinished as stop:
        if not completed:
            raise
        work = completed[-1].candidates.campaign.work
        work.renew()
        with work.untimed():
            return _ended_early(completed[-1], stop)


def _ended_early(last: Selected, stop: Unfinished) -> Selected:
    """Return the last completed model as the result of an unfinished selection."""
    candidates, present, steps = last.candidates, last.present, list(last.steps)
    otherwise = FURTHER
    if steps[-1].effects != present:
        steps.append(step(candidates, present, ()))
    else:
        # The model with the leading effect was not completed.
        trials = list(steps[-1].trials)
        for i, trial in enumerate(trials):
            if trial.outcome == "added":
                reason = f"leads, but was not added: {stop.reason}"
                trials[i] = replace(trial, outcome="rejected", reason=reason)
                otherwise = f"models with {trial.effect}"
        steps[-1] = replace(steps[-1], trials=tuple(trials))
    tested = {trial.effect for trial in steps[-1].trials}
    untested = [name for name in candidates.addable(present) if name not in tested]
    where = f"{stop.reason}; not all further effects were tested"
    not_tried = dict.fromkeys(untested or [otherwise], stop.reason)
    return Selected(candidates, present, steps, (Remainder(SEARCH, where, 0.0),), not_tried)


def _select(candidates: Candidates, completed: list[Selected]) -> Selected:
    """Select effects and terms, and append each tested and each extended model to `completed`.

    Each pass of the loop tests the candidates of the present model once and ends in one of four
    ways: with a changed observation model, with another set of effects to test, with more
    candidates to fit (`follow`), or with the result. The models in `visited` were tested with the
    present observation model; the selection does not return to them.
    """
    policy = candidates.policy
    present, steps = start_model(candidates), []
    follow: Follow = "promising"
    visited = {frozenset(present)}
    reviewed: set[frozenset[str]] = set()
    updates = 0
    while True:
        # Exclude samples at which this model shows a further initial-state transient.
        settled = without_further_transients(
            candidates.fitted(present).problem, candidates.converge(present)
        )
        if settled is not None:
            candidates = candidates.with_campaign(settled)
            present = still_needed(candidates, present)
            visited, reviewed = {frozenset(present)}, set()
        candidates.reached.candidates, candidates.reached.present = candidates, present
        # Test every candidate in addition to the present effects.
        trial_round = try_candidates(candidates, present, follow)
        steps.append(step(candidates, present, trial_round.trials))
        completed.append(Selected(candidates, present, list(steps)))
        may_update = updates < policy.terms.max_updates
        update, extended = None, present
        candidates.tell("reviewing the model", 0, 0)
        # Some terms of the observation model compete with the leading effect.
        if trial_round.leader is not None:
            least = _evidence_of_leader(candidates, present, trial_round)
            update = best_term_update(candidates, present, least) if may_update else None
            if update is None and len(present) < policy.selection.max_effects:
                # The errors of the motion, estimated without the effect, contain its force.
                leader = trial_round.leader
                re_estimated = re_estimated_motion(candidates, (*present, leader))
                if re_estimated is not None and leader in re_estimated.effects:
                    candidates = candidates.with_campaign(*re_estimated)
                    present = tuple(n for n in present if n in re_estimated.effects)
                    visited, reviewed = {frozenset(present)}, set()
                elif may_update:
                    update = re_estimated  # the leader is `time_delay`: its delay is corrected
                if update is None:
                    extended = _with_leader(candidates, present, trial_round)
        # If no effect is added, terms are added one by one, the largest evidence first. A term
        # that competes with the leader is added alone.
        ended = update is None and frozenset(extended) in visited
        if ended and follow == "promising" and may_update:
            update = best_term_update(candidates, present)
        if update is not None:
            before = present
            while update is not None:
                updates += 1
                candidates = candidates.with_campaign(*update)
                kept = [n for n in present if n in update.effects]
                added = [n for n in update.effects if n not in present]
                present = still_needed(candidates, (*kept, *added))
                more = ended and updates < policy.terms.max_updates
                update = best_term_update(candidates, present) if more else None
            visited, reviewed, follow = {frozenset(present)}, set(), "promising"
            # Without a further effect, the next step replaces this one.
            if set(present) <= set(before):
                steps.pop()
            continue
        # If neither an effect nor a term is added, effects may be exchanged or removed, once per
        # model. The selection does not return to a model that was tested already.
        if ended and frozenset(present) not in reviewed:
            reviewed.add(frozenset(present))
            revised = reconsider(candidates, present, trial_round.refused)
            if frozenset(revised) not in visited:
                visited.add(frozenset(revised))
                present, follow = revised, "promising"
                continue
        # With residual structure, candidates with a small score are fitted, then pairs of them.
        if ended and follow == "promising" and remainder_of(candidates, present):
            follow = "all"
            steps.pop()
            continue
        if ended and follow == "all":
            extended = _pair(candidates, present, trial_round)
        if frozenset(extended) in visited:
            if trial_round.leader is not None and len(present) >= policy.selection.max_effects:
                remainders: tuple[Remainder, ...] = (
                    _effect_limit_reached(candidates, present, trial_round.leader),
                )
            else:
                remainders = _unconfirmed_candidate(candidates, present, trial_round)
            return Selected(candidates, present, steps, remainders)
        visited.add(frozenset(extended))
        present, follow = extended, "promising"
        completed.append(Selected(candidates, present, list(steps)))


def _evidence_of_leader(candidates: Candidates, present: Names, trial_round: Round) -> float:
    """Evidence for the effect selected in a round, or its full gain if confirmed by units."""
    leader = next(t for t in trial_round.trials if t.effect == trial_round.leader)
    if leader.evidence > 0.0:
        return leader.evidence
    richer = candidates.converge((*present, leader.effect))
    return max(full_gain(candidates, richer, candidates.converge(present)), 0.0)


def remainder_of(candidates: Candidates, present: Names) -> tuple[Remainder, ...]:
    """Residual structure of the model with the present effects."""
    problem, solution = candidates.fitted(present).problem, candidates.converge(present)
    return find_residual_structure(problem, solution, candidates.policy)


def _with_leader(candidates: Candidates, present: Names, trial_round: Round) -> Names:
    """Return the model with the effect selected in a round, without unnecessary effects.

    A candidate that is tied with the leader is used instead if the resulting model has fewer
    effects or parameters and predicts held-out runs equally well. Where the errors of the motion
    are a part of the held-out errors, so is the difference that is allowed between them.
    """
    tied = [t.effect for t in trial_round.trials if t.outcome == "ties"]
    models: list[Names] = []
    # Without other effects, no candidate makes one unnecessary.
    for name in (trial_round.leader, *tied) if present else (trial_round.leader,):
        assert name is not None
        candidates.search_peaks((*present, name))
        models.append(still_needed(candidates, (*present, name)))
    errors = [candidates.held_out_rms(model) for model in models]
    # A tied candidate has not been confirmed by held-out runs.
    share = candidates.policy.least_share(candidates.campaign.motion_share)
    ratio = max(candidates.policy.laws.same_ratio, (1.0 + share) ** 0.5)
    equal = [
        model for model, error in zip(models, errors, strict=True) if error <= ratio * errors[0]
    ]
    return min(equal, key=lambda model: (len(model), candidates.converge(model).free))


def _pair(candidates: Candidates, present: Names, trial_round: Round) -> Names:
    """Add the pair of effects with the largest gain, if it has evidence.

    If two effects are missing, the residual with either one remains correlated, and neither may
    have evidence alone.
    """
    policy = candidates.policy
    if len(present) + 2 > policy.selection.max_effects:
        return present
    ahead = [
        t.effect for t in sorted(trial_round.trials, key=lambda t: t.rms)[: policy.search.paired]
    ]
    pairs = [(*present, *pair) for pair in itertools.combinations(ahead, 2)]
    pairs += [
        (*present, name, other)
        for name in ahead[:2]
        for other in _promising(candidates, (*present, name))
    ]
    pairs = [
        pair
        for pair in pairs
        if can_be_added(pair[-2], present) and can_be_added(pair[-1], pair[:-1])
    ]
    if not pairs:
        return present
    base = candidates.converge(present)
    candidates.rank_all(pairs, base)
    best = max(pairs, key=lambda pair: likelihood_gain(candidates.rank(pair), base))
    richer = candidates.converge(best)
    if (
        candidates.held_out_rms(best)
        > candidates.held_out_rms(present) / policy.held_out.no_worse_ratio
    ):
        return present
    if evidence(candidates, richer, base) <= 0.0 and full_gain(candidates, richer, base) <= 0.0:
        return present
    return still_needed(candidates, best)


def _promising(candidates: Candidates, present: Names) -> list[str]:
    """Candidate effects with the largest score statistics relative to the present model."""
    near = candidates.converge(present)
    names = candidates.addable(present)
    scores = candidates.score_all(present, names, near)
    finite = [name for name in names if np.isfinite(scores[name])]
    return sorted(finite, key=lambda name: -scores[name])[: candidates.policy.search.paired]


def _effect_limit_reached(candidates: Candidates, present: Names, leader: str) -> Remainder:
    """Report that the largest number of effects is reached although `leader` would be added."""
    base, richer = candidates.converge(present), candidates.converge((*present, leader))
    unit = candidates.campaign.rig.quantities.force
    where = (
        f"effect limit ({len(present)}) reached; {leader} would reduce the RMS from "
        f"{base.rms:.3g} to {richer.rms:.3g} {unit}"
    )
    return Remainder("effects", where, max(1.0 - (richer.rms / base.rms) ** 2, 0.0))


def step(candidates: Candidates, effects: Names, trials: tuple[Trial, ...]) -> Step:
    """Create the step of the ledger for a model: its errors, and the candidates tried with it."""
    solution = candidates.converge(effects)
    noise_rms = noise_floor(candidates.campaign.prepared, solution.samples)
    held_out_n = candidates.held_out_rms(effects)
    beyond = _extrapolations(candidates, effects)
    return Step(effects, solution.rms, held_out_n, noise_rms, trials, beyond)


def _extrapolations(candidates: Candidates, effects: Names) -> tuple[Extrapolation, ...]:
    """Prediction errors of runs whose speed or load is beyond the range of all other runs."""
    if not candidates.beyond:
        return ()
    unit, names = candidates.campaign.rig.quantities, candidates.campaign.samples.runs
    errors = errors_by_run(candidates.converge(effects), candidates.held_out_parts(effects))
    extrapolations = []
    for beyond in candidates.beyond:
        run_errors = errors.get(beyond.run, np.zeros(0))
        if len(run_errors):
            size = f" {unit.speed}" if beyond.quantity == "speed" else ""
            own_range = f"{beyond.quantity} {beyond.value:.3g}{size}"
            where = f"{own_range}, nearest other {beyond.others:.3g}{size}"
            rms = float(np.sqrt(np.mean(run_errors**2)))
            extrapolations.append(Extrapolation(names[beyond.run], rms, where))
    return tuple(extrapolations)


def _unconfirmed_candidate(
    candidates: Candidates, present: Names, trial_round: Round
) -> tuple[Remainder, ...]:
    """Report an unaccepted candidate that fits better but does not predict held-out runs better.

    Samples next to friction jumps are excluded, since a run-specific clock error of less than a
    sample can affect them.
    """
    policy = candidates.policy
    of_smoothing = {t.effect for t in trial_round.trials if t.reason == OF_SMOOTHING}
    fitted = {
        name: extension
        for name in candidates.names
        if name not in present
        and name not in of_smoothing
        and (extension := candidates.fitted((*present, name))).solution is not None
    }
    base = candidates.converge(present)
    # Exclude the samples next to jumps, as in the fit of a delay.
    delay = fitted.get(DELAY)
    away = base.samples if delay is None else delay.current_solution().samples
    refused = []
    for name, problem in fitted.items():
        richer = problem.current_solution()
        samples = common_samples(richer.samples, away)
        with_it, without = (replace(s, samples=samples) for s in (richer, base))
        better = with_it.rms < policy.selection.max_refused_rms_ratio * without.rms
        gains = (
            evidence_on_common_samples(candidates, with_it, without, count_local_gain=True)
            > policy.selection.weak_evidence
        )
        if better and gains:
            refused.append((richer.rms, name))
    if not refused:
        return ()
    rms, name = min(refused)
    share = max(1.0 - (rms / base.rms) ** 2, 0.0)
    if share < policy.least_share(candidates.campaign.motion_share):
        return ()
    unit = candidates.campaign.rig.quantities.force
    fits = f"{name} reduces the RMS from {base.rms:.3g} to {rms:.3g} {unit}"
    where = f"{fits}, but does not improve the held-out prediction"
    return (Remainder("run", where, share),)
