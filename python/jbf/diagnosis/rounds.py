"""Rounds of selection that add one effect at a time, until no candidate is accepted."""

from __future__ import annotations

import itertools
from dataclasses import dataclass, field, replace

import numpy as np

from jbf.arrays import Names
from jbf.diagnosis.candidates import Candidates
from jbf.diagnosis.evidence import evidence, full_gain, is_due_to_smoothing
from jbf.diagnosis.fit_state import INSTEAD_OF_ERRORS
from jbf.diagnosis.ledger import SEARCH, Extrapolation, Remainder, Step, Trial
from jbf.diagnosis.remainders import remainder_of, remainders_of_selection
from jbf.diagnosis.review import reconsider, start_model, still_needed
from jbf.diagnosis.selection import Follow, Round, try_candidates
from jbf.diagnosis.terms import Leader, Update, best_term_update, re_estimated_motion
from jbf.errors import Unfinished
from jbf.estimation.held_out import errors_by_run
from jbf.estimation.likelihood import likelihood_gain
from jbf.estimation.noise_floor import noise_floor
from jbf.estimation.transients import without_further_transients
from jbf.models.catalogue import can_be_added


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
    selection = _Selection(candidates)
    try:
        return selection.run()
    except Unfinished as stop:
        if not selection.completed:
            raise
        last = selection.completed[-1]
        work = last.candidates.campaign.work
        work.renew()
        with work.untimed():
            return _ended_early(last, stop)


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


class _Selection:
    """Stepwise selection: the present model, and the changes that lead to the next one.

    Attributes
    ----------
    candidates, present, steps
        As in `Selected`.
    completed
        The tested and the extended models, the last one being the result if the time ends.
    follow
        Candidates to fit in the next round.
    visited, reviewed
        Models that were tested, or reviewed, with the present observation model. The selection does
        not return to them.
    updates
        Number of changes of the observation model that were tried.
    """

    def __init__(self, candidates: Candidates) -> None:
        self.candidates, self.present = candidates, start_model(candidates)
        self.steps: list[Step] = []
        self.completed: list[Selected] = []
        self.follow: Follow = "promising"
        self.updates = 0
        self._forget()

    def _forget(self) -> None:
        """Forget which models were tested with an earlier observation model."""
        self.visited, self.reviewed = {frozenset(self.present)}, set[frozenset[str]]()

    def run(self) -> Selected:
        """Test the candidates of each model, and change it until no change is accepted.

        A leading effect is added first. Without one, terms are added, then effects exchanged or
        removed, then all candidates fitted, and finally pairs of effects added.
        """
        while True:
            self._exclude_transients()
            trial_round = self._test_candidates()
            self.candidates.tell("reviewing the model", 0, 0)
            changed = (
                self._add_leader(trial_round)
                or self._add_terms()
                or self._exchange(trial_round)
                or self._fit_all()
                or self._add_pair(trial_round)
            )
            if not changed:
                remainders = remainders_of_selection(self.candidates, self.present, trial_round)
                return Selected(self.candidates, self.present, self.steps, remainders)

    def _exclude_transients(self) -> None:
        """Exclude samples at which this model shows a further initial-state transient."""
        problem = self.candidates.fitted(self.present).problem
        settled = without_further_transients(problem, self.candidates.converge(self.present))
        if settled is not None:
            self.candidates = self.candidates.with_campaign(settled)
            self.present = still_needed(self.candidates, self.present)
            self._forget()

    def _test_candidates(self) -> Round:
        """Test every candidate in addition to the present effects."""
        candidates, present = self.candidates, self.present
        candidates.reached.candidates, candidates.reached.present = candidates, present
        trial_round = try_candidates(candidates, present, self.follow)
        self.steps.append(step(candidates, present, trial_round.trials))
        self.completed.append(Selected(candidates, present, list(self.steps)))
        return trial_round

    @property
    def _may_update(self) -> bool:
        """Whether the observation model may still be changed."""
        return self.updates < self.candidates.policy.terms.max_updates

    def _add_leader(self, trial_round: Round) -> bool:
        """Add the leading effect, or a term of the observation model that has more evidence."""
        leader, candidates = trial_round.leader, self.candidates
        if leader is None:
            return False
        accepted = Leader(leader, _evidence_of_leader(candidates, self.present, trial_round))
        update = best_term_update(candidates, self.present, accepted) if self._may_update else None
        if update is not None and self._update_terms(update, add_more=False):
            return True
        if len(self.present) >= candidates.policy.selection.max_effects:
            return False
        # The errors of the motion, estimated without the effect, contain its force.
        re_estimated = re_estimated_motion(candidates, (*self.present, leader))
        if re_estimated is not None and leader in re_estimated.effects:
            self.candidates = candidates.with_campaign(*re_estimated)
            self.present = tuple(n for n in self.present if n in re_estimated.effects)
            self._forget()
        elif re_estimated is not None and self._may_update:
            # The leader is `time_delay`: its delay is corrected.
            return self._update_terms(re_estimated, add_more=False)
        return self._extend(_with_leader(self.candidates, self.present, trial_round))

    def _add_terms(self) -> bool:
        """Add terms of the observation model one by one, the largest evidence first."""
        if self.follow != "promising" or not self._may_update:
            return False
        update = best_term_update(self.candidates, self.present)
        return update is not None and self._update_terms(update, add_more=True)

    def _update_terms(self, update: Update | None, *, add_more: bool) -> bool:
        """Change the observation model; with `add_more`, until no further term is accepted.

        An update may add an effect in place of errors of the motion. If this effect is not needed
        with the new errors, the update is discarded, and not proposed again for this model. Returns
        whether an update was applied.
        """
        before, changed = self.present, False
        while update is not None:
            self.updates += 1
            candidates = self.candidates.with_campaign(*update)
            kept = [n for n in self.present if n in update.effects]
            added = [n for n in update.effects if n not in self.present]
            present = still_needed(candidates, (*kept, *added))
            if set(added) <= set(present):
                self.candidates, self.present, changed = candidates, present, True
            else:
                self.candidates.fitted(self.present).proposals[INSTEAD_OF_ERRORS] = None
            more = add_more and self._may_update
            update = best_term_update(self.candidates, self.present) if more else None
        if not changed:
            return False
        self.follow = "promising"
        self._forget()
        # Without a further effect, the next step replaces this one.
        if set(self.present) <= set(before):
            self.steps.pop()
        return True

    def _exchange(self, trial_round: Round) -> bool:
        """Exchange or remove effects, once for each model."""
        if frozenset(self.present) in self.reviewed:
            return False
        self.reviewed.add(frozenset(self.present))
        revised = reconsider(self.candidates, self.present, trial_round.refused)
        if frozenset(revised) in self.visited:
            return False
        self.visited.add(frozenset(revised))
        self.present, self.follow = revised, "promising"
        return True

    def _fit_all(self) -> bool:
        """Fit candidates with a small score as well, if the residual has structure."""
        if self.follow != "promising" or not remainder_of(self.candidates, self.present):
            return False
        self.follow = "all"
        self.steps.pop()
        return True

    def _add_pair(self, trial_round: Round) -> bool:
        """Add two effects that have evidence only together."""
        if self.follow != "all":
            return False
        return self._extend(_pair(self.candidates, self.present, trial_round))

    def _extend(self, extended: Names) -> bool:
        """Continue with an extended model, unless it was tested already."""
        if frozenset(extended) in self.visited:
            return False
        self.visited.add(frozenset(extended))
        self.present, self.follow = extended, "promising"
        self.completed.append(Selected(self.candidates, extended, list(self.steps)))
        return True


def _evidence_of_leader(candidates: Candidates, present: Names, trial_round: Round) -> float:
    """Evidence for the effect selected in a round, or its full gain if confirmed by units."""
    leader = next(t for t in trial_round.trials if t.effect == trial_round.leader)
    if leader.evidence > 0.0:
        return leader.evidence
    richer = candidates.converge((*present, leader.effect))
    return max(full_gain(candidates, richer, candidates.converge(present)), 0.0)


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
    if is_due_to_smoothing(candidates, richer, base):
        return present
    return still_needed(candidates, best)


def _promising(candidates: Candidates, present: Names) -> list[str]:
    """Candidate effects with the largest score statistics relative to the present model."""
    near = candidates.converge(present)
    names = candidates.addable(present)
    scores = candidates.score_all(present, names, near)
    finite = [name for name in names if np.isfinite(scores[name])]
    return sorted(finite, key=lambda name: -scores[name])[: candidates.policy.search.paired]


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
            others = f"nearest other {beyond.others:.3g}{size}"
            if beyond.others == 0.0:
                others = "no other run moves in this direction"
            where = f"{own_range}, {others}"
            rms = float(np.sqrt(np.mean(run_errors**2)))
            extrapolations.append(Extrapolation(names[beyond.run], rms, where))
    return tuple(extrapolations)
