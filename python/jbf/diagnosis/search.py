"""The search for what is missing: try every effect, add what the data ask for, repeat, stop.

At each step every candidate is fitted beside what the model already holds. Its evidence is
twice the gain in log likelihood (of innovations, so that coloured noise buys nothing) less what
its parameters and the number of candidates tried would gain by chance. The leader is added if
runs that it was not fitted to agree. Then the other effects are questioned again: one that
is no longer needed goes, one that another would replace better is exchanged.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import numpy.typing as npt

from jbf.comparison.comparison import compare_prepared
from jbf.diagnosis.constancy import disagreement
from jbf.diagnosis.excitations import Limits
from jbf.diagnosis.experiment import Experiment, propose, propose_to_see, unseen
from jbf.diagnosis.holdout import holdout_rms
from jbf.diagnosis.remainder import find_remainder
from jbf.diagnosis.result import Diagnosis, Remainder, Step, Trial
from jbf.estimation.campaign import Campaign
from jbf.estimation.fit import Problem, Solution, finish, root_mean_square
from jbf.estimation.likelihood import costs, first_step_gain, independent, next_step_gain
from jbf.models.catalogue import effects as catalogue
from jbf.models.catalogue import find_effect
from jbf.models.chain import check_rig
from jbf.records.rig import Rig
from jbf.records.run import Run
from jbf.threads import one_blas_thread

Array = npt.NDArray[np.float64]
Progress = Callable[[str, int, int], None]

MARGIN = 20.0
"""Evidence that even a free candidate must bring: the prior odds against any one effect, and
room for noise that is not quite as described."""
TIE = 8.0
"""Candidates closer in evidence than this fit equally well; less than one parameter costs."""
TRACE = 10.0
"""Gain in twice the log likelihood, of a first step, below which an effect leaves no trace:
half of what the cheapest effect must bring in the end."""
SCREEN_EVALUATIONS = 8
"""Steps after which candidates are ranked; only those that could win go on."""
CONTENDER = 60.0
"""How far behind in evidence a candidate may be after screening and still go on,"""
CLOSE = 0.6
"""beyond this share of the leader's: what is far from converged may still be the truth."""
HOPE = 5.0
"""A search may gain so many times what its next step promises, not more."""
CHANCE = 0.5
"""Share of the leader's evidence from which on an effect whose likelihood has many peaks gets a
second look."""
MOST_EFFECTS = 5
"""A record that asks for more effects than this is telling something else."""
LEAST_FORESEEN = 0.5
"""Share of what a candidate gains where it is fitted that it must gain on runs left out, if its
evidence is weak; any gain will do where it is strong: one run alone may hold the rests, or the
reversals, that an effect needs."""
DOUBT = 60.0
"""Evidence of a candidate that fits and does not predict from which on something of its kind must
be there: noise does not reach it."""
CLEAR = 20.0
"""Effects beside which the runs ask for different parameters must have gained so many times what
that disagreement is worth, or they are stand-ins, too."""
LEAST_EXPLAINED = 0.8
"""Where structure remains, effects that explain less of the excess than this are stand-ins for
what is really there, and are not named."""


@dataclass
class Search:
    """A campaign under a law, and every fit made so far."""

    campaign: Campaign
    law: str
    clock: str
    progress: Progress | None = None
    solved: dict[frozenset[str], Solution] = field(default_factory=dict)
    glanced: dict[frozenset[str], float] = field(default_factory=dict)
    settled: set[frozenset[str]] = field(default_factory=set)
    held_out: dict[frozenset[str], float] = field(default_factory=dict)
    looked: set[frozenset[str]] = field(default_factory=set)

    @property
    def candidates(self) -> list[str]:
        """Effects that go with the law and that these records could show."""
        return [
            e.name
            for e in catalogue().values()
            if self.law not in e.refused and self.campaign.shows(e)
        ]

    @property
    def not_tried(self) -> dict[str, str]:
        """Effects that go with the law but that these records cannot show, and why."""
        pages = [e for e in catalogue().values() if self.law not in e.refused]
        reasons = {e.name: self.campaign.lacking(e) for e in pages}
        return {name: reason for name, reason in reasons.items() if reason is not None}

    def problem(self, effects: Sequence[str] | frozenset[str]) -> Problem:
        """The fitting problem of some effects."""
        return Problem(self.campaign, self.law, self.clock, tuple(effects))

    def screen(self, effects: frozenset[str], near: Solution | None = None) -> Solution:
        """Fit these effects well enough to rank them, from a smaller model's solution."""
        if effects not in self.solved:
            problem = self.problem(effects)
            seeds: list[Mapping[str, float]] = [{}]
            if near is not None:
                names = self.problem(near.effects).names
                law = dict(zip(names, near.values, strict=True))
                # A law that had to make up for a missing effect may be a poor start; of an effect
                # with many peaks the one that it had to climb is no start at all.
                anew = many_peaks(near.effects)
                kept = {} if anew else {n: v for n, v in law.items() if "." in n}
                seeds = [law, kept]
            least = self._least(near)
            each = near is not None and many_peaks(near.effects)
            self.solved[effects] = problem.approach(seeds, SCREEN_EVALUATIONS, least, each=each)
        return self.solved[effects]

    def _least(self, near: Solution | None) -> float:
        """The sum of squares from which on something beside a smaller model leaves a trace."""
        if near is None:
            return np.inf
        square = self.problem(near.effects).square(near.values)
        return square * float(np.exp(-TRACE / self.campaign.samples))

    def trace(self, effects: frozenset[str], near: Solution) -> float:
        """What the records show at first glance of an effect beside a smaller model.

        The score test: the gain in twice the log likelihood that one Gauss-Newton step promises,
        from the effect's null, the law free to move with it; the largest from any start. Infinite
        of an effect whose null is out of a step's reach.
        """
        if effects not in self.glanced:
            added = effects - set(near.effects)
            problem = self.problem(effects)
            pages = {
                name: page
                for name, page in problem.parameters.items()
                if name.split(".")[0] in added
            }
            nulls = {n: p.null for n, p in pages.items() if p.null is not None}
            if not nulls or not all(np.isfinite(null) for null in nulls.values()):
                self.glanced[effects] = np.inf
            else:
                known = dict(zip(self.problem(near.effects).names, near.values, strict=True))
                starts = problem.starts({**known, **nulls})
                gains = (first_step_gain(problem, start, near.noise) for start in starts)
                self.glanced[effects] = max(gains)
        return self.glanced[effects]

    def solve(self, effects: frozenset[str], near: Solution | None = None) -> Solution:
        """Fit these effects to convergence."""
        if effects not in self.settled:
            self.solved[effects] = self.problem(effects).settle(self.screen(effects, near))
            self.settled.add(effects)
        return self.solved[effects]

    def look_again(self, effects: frozenset[str]) -> None:
        """Look for a higher peak of the likelihood, now that these effects are together: what was
        missing before may have led the search to another. Once for each set of effects."""
        if effects in self.looked:
            return
        self.looked.add(effects)
        near = self.solve(effects)
        problem = self.problem(effects)
        found = problem.look_around(near)
        if len(effects) > 1 and many_peaks(effects):
            # As if nothing had been found before.
            fresh = problem.approach([{}], SCREEN_EVALUATIONS)
            if np.subtract(*costs(fresh, found)) < CONTENDER:
                fresh = problem.look_around(problem.settle(fresh))
                found = fresh if np.subtract(*costs(fresh, found)) < 0.0 else found
        self._replace(effects, found)

    def come_down(self, effects: frozenset[str], whole: Solution) -> None:
        """Fit fewer effects from where they are in a richer model, too: it may have found its way
        past a valley in which they are caught."""
        near, problem = self.solve(effects), self.problem(effects)
        known = dict(zip(self.problem(whole.effects).names, whole.values, strict=True))
        start = np.array([known[name] for name in problem.names])
        sure = problem.without_doubt(start)
        there = sure.settle(sure.solution(start, near.noise, False))
        if np.subtract(*costs(there, near)) < 0.0:
            self._replace(effects, there)

    def _replace(self, effects: frozenset[str], better: Solution) -> None:
        if better is not self.solved[effects]:
            self.solved[effects] = better
            self.held_out.pop(effects, None)

    def price(self, parameters: int) -> float:
        """What so many parameters of the best of all candidates gain by chance."""
        tried = 2.0 * np.log(max(len(self.candidates), 1))
        return MARGIN + float(parameters * np.log(self.campaign.samples) + tried)

    def evidence(self, richer: Solution, simpler: Solution) -> float:
        """Evidence for the richer of two models.

        Where even the richer one leaves an error that is smooth, samples count for less.
        """
        gain = float(np.subtract(*costs(simpler, richer))) * independent(richer)
        return gain - self.price(richer.free - simpler.free)

    def loss(self, effects: frozenset[str], whole: Solution, near: Solution) -> float:
        """How much evidence is lost when these effects stand in place of those of `whole`."""

        def of(solution: Solution) -> float:
            lost = np.subtract(*costs(solution, whole))
            return float(lost) + self.price(solution.free) - self.price(whole.free)

        if self.trace(effects, near) <= TRACE:
            return of(near)
        first = of(self.screen(effects, near))
        if first >= CONTENDER:
            return first
        solution = self.solve(effects, near)
        # What is worth nothing beside the rest stands for nothing: it may fit the fewer samples of
        # which it is sure.
        return of(solution if self.evidence(solution, near) > 0.0 else near)

    def hold_out(self, effects: frozenset[str]) -> float:
        """RMS over runs left out of the fit one at a time, N."""
        if effects not in self.held_out:
            self.held_out[effects] = holdout_rms(self.problem(effects), self.solve(effects))
        return self.held_out[effects]

    def say(self, message: str, done: int, total: int) -> None:
        """Report progress."""
        if self.progress is not None:
            self.progress(message, done, total)


def many_peaks(effects: Iterable[str]) -> bool:
    """True where the likelihood of these effects has peak beside peak."""
    return any(find_effect(name).peaks for name in effects)


@dataclass
class Round:
    """One round of trials beside a model."""

    trials: list[Trial]
    leader: str | None
    ties: tuple[str, ...]


def try_all(search: Search, present: tuple[str, ...]) -> Round:
    """Fit every candidate beside the effects present, and say which should be added."""
    base = search.solve(frozenset(present))
    rivals = [c for c in search.candidates if c not in present]
    share = independent(base)
    first: dict[str, float] = {}
    for i, name in enumerate(rivals):
        search.say(f"trying {name}", i, len(rivals))
        effects = frozenset((*present, name))
        # Of a smooth error a sample tells less, and anything gains a little.
        if search.trace(effects, base) * share <= TRACE:
            first[name] = -np.inf
        else:
            first[name] = search.evidence(search.screen(effects, base), base)
    line = CLOSE * max(max(first.values(), default=0.0), 0.0) - CONTENDER
    found: list[tuple[float, str, Solution]] = []
    for name in rivals:
        effects = frozenset((*present, name))
        if first[name] == -np.inf:
            solution = base
        else:
            solution = search.screen(effects)
            problem = search.problem(effects)
            hope = first[name] + HOPE * next_step_gain(problem, solution) * share
            if first[name] > line and hope > 0.0:
                solution = search.solve(effects)
        # At its null an effect leaves the model as it was: no candidate is worse than that.
        least = -search.price(len(search.problem(effects).names) - base.free)
        found.append((max(search.evidence(solution, base), least), name, solution))
    found.sort(key=lambda t: -t[0])
    # One that might lead from a higher peak gets its chance.
    for i, (evidence, name, _) in enumerate(found):
        effects = frozenset((*present, name))
        if many_peaks(effects) and evidence > max(CHANCE * found[0][0], 0.0):
            search.look_again(effects)
            solution = search.solve(effects)
            found[i] = (search.evidence(solution, base), name, solution)
    found.sort(key=lambda t: -t[0])
    leader, best, ties, trials = None, 0.0, [], []
    bare = root_mean_square(base.residuals, base.campaign)
    before = search.hold_out(frozenset(present)) if found and found[0][0] > 0 else np.nan
    for evidence, name, solution in found:
        rms = min(root_mean_square(solution.residuals, solution.campaign), bare)
        outcome, reason = "useless", "gains no more than chance would"
        if evidence > 0 and leader is None:
            after = search.hold_out(frozenset((*present, name)))
            gained = (before**2 - after**2) / max(bare**2 - rms**2, 1e-300)
            if gained > (0.0 if evidence > DOUBT else LEAST_FORESEEN):
                leader, best = name, evidence
                outcome, reason = "added", f"largest evidence; left-out runs {after:.4g} N"
            else:
                outcome = "rejected"
                reason = f"fits better but predicts left-out runs no better ({after:.4g} N)"
        elif evidence > 0 and evidence > best - TIE:
            ties.append(name)
            outcome, reason = "ties", f"fits as well as {leader}"
        elif evidence > 0:
            outcome = "rejected"
            reason = f"{leader} leads by {best - evidence:.0f} in evidence"
        trials.append(Trial(name, rms, float(evidence), outcome, reason))
    return Round(trials, leader, tuple(ties))


def question(search: Search, present: tuple[str, ...]) -> tuple[str, ...]:
    """Take out effects that are no longer needed; exchange those that another replaces better."""
    current = present
    for name in present:
        if len(current) < 2 or name not in current:
            continue
        rest = tuple(e for e in current if e != name)
        search.look_again(frozenset(rest))
        search.come_down(frozenset(rest), search.solve(frozenset(current)))
        simpler = search.solve(frozenset(rest))
        if search.evidence(search.solve(frozenset(current)), simpler) < 0:
            current = rest
            continue
        whole = search.solve(frozenset(current))
        best, gain = name, TIE
        for other in search.candidates:
            if other in current:
                continue
            better = -search.loss(frozenset((*rest, other)), whole, simpler)
            if better > gain:
                best, gain = other, better
        if best != name:
            current = tuple(best if e == name else e for e in current)
    return current


def alternatives(search: Search, present: tuple[str, ...]) -> dict[str, tuple[str, ...]]:
    """For each effect, the candidates that would fit as well in its place."""
    whole = search.solve(frozenset(present))
    found: dict[str, tuple[str, ...]] = {}
    for name in present:
        rest = tuple(e for e in present if e != name)
        simpler = search.solve(frozenset(rest))
        equal = []
        for other in search.candidates:
            if other in present:
                continue
            if search.loss(frozenset((*rest, other)), whole, simpler) < TIE:
                equal.append(other)
        found[name] = tuple(equal)
    return found


@one_blas_thread
def diagnose(
    rig: Rig,
    runs: Sequence[Run],
    *,
    law: str = "journal",
    clock: str = "journal",
    limits: Limits | None = None,
    progress: Progress | None = None,
) -> Diagnosis:
    """Find which effect of the catalogue a law lacks to explain the runs; add it; repeat.

    Parameters
    ----------
    rig
        Bearing, lubricant and load; `Rig()` will do for a law in newtons.
    runs
        Recorded runs with friction; several different motions tell effects apart.
    law, clock
        Base law and its clock.
    limits
        What the rig may be asked to do in the next experiment; from the runs where not given.
    progress
        Called with a message, and how many of how many trials of the round are done.

    Returns
    -------
    Diagnosis
        Verdict, effects, ledger, alternatives, what remains, and the final model.

    Raises
    ------
    InputError
        A run lacks friction, or nothing moves in it.
    """
    begun = time.monotonic()
    check_rig(rig, law)
    search = Search(Campaign.prepare(rig, runs), law, clock, progress)
    campaign = search.campaign
    bare = finish(search.problem(()), search.solve(frozenset()))
    before = compare_prepared(bare.model, campaign)
    noise = before.noise_n

    present: tuple[str, ...] = ()
    steps: list[Step] = []

    def step(effects: tuple[str, ...], trials: Sequence[Trial]) -> Step:
        solution = search.solve(frozenset(effects))
        return Step(
            effects,
            root_mean_square(solution.residuals, solution.campaign),
            search.hold_out(frozenset(effects)),
            noise,
            tuple(trials),
        )

    visited = {frozenset[str]()}
    while True:
        round_ = try_all(search, present)
        steps.append(step(present, round_.trials))
        if round_.leader is None or len(present) >= MOST_EFFECTS:
            break
        search.look_again(frozenset((*present, round_.leader)))
        grown = question(search, (*present, round_.leader))
        if frozenset(grown) in visited:
            break
        visited.add(frozenset(grown))
        present = grown

    remains = _remainder(search, present)
    if round_.leader is None:
        remains = (*remains, *_refused(search, search.solve(frozenset(present))))
    if remains and present and not _stands(search, present, noise):
        present, steps = (), [_withdrawn(steps[0])]
        remains = _remainder(search, present) or remains
    equal = alternatives(search, present)
    fit = finish(search.problem(present), search.solve(frozenset(present)))
    after = compare_prepared(fit.model, campaign)
    tied = {name: others for name, others in equal.items() if others}
    if remains:
        verdict = "unexplained"
    elif tied:
        verdict = "ambiguous"
    else:
        verdict = "missing" if present else "adequate"
    hidden = () if remains else unseen(search, present)
    proposal: Experiment | str | None = None
    if verdict == "adequate" and hidden:
        proposal = propose_to_see(search, present, hidden, limits)
    if tied:
        proposal = propose(search, [_rivals(present, n, tied[n]) for n in tied], limits)
    return Diagnosis(
        verdict=verdict,
        effects=present,
        alternatives=equal,
        steps=tuple(steps),
        failures=before.failures,
        unexplained=remains,
        next_experiment=proposal.words if isinstance(proposal, Experiment) else proposal,
        experiment=proposal if isinstance(proposal, Experiment) else None,
        fit=fit,
        before=before,
        after=after,
        elapsed_s=time.monotonic() - begun,
        not_tried=search.not_tried,
        unseen=hidden,
    )


def _rivals(present: tuple[str, ...], name: str, others: tuple[str, ...]) -> list[tuple[str, ...]]:
    """The models that fit equally well: with this effect, or another in its place."""
    rest = tuple(e for e in present if e != name)
    return [present, *((*rest, other) for other in others)]


def _remainder(search: Search, present: tuple[str, ...]) -> tuple[Remainder, ...]:
    problem, solution = search.problem(present), search.solve(frozenset(present))
    return find_remainder(problem, solution)


def _refused(search: Search, base: Solution) -> list[Remainder]:
    """What a candidate saw that helps where it was fitted and not in runs left out."""
    found: list[tuple[float, str]] = []
    here = frozenset(base.effects)
    for effects, solution in search.solved.items():
        if len(effects) != len(here) + 1 or not here < effects:
            continue
        (name,) = effects - here
        if search.evidence(solution, base) > DOUBT:
            found.append((root_mean_square(solution.residuals, solution.campaign), name))
    if not found:
        return []
    rms, name = min(found)
    bare = root_mean_square(base.residuals, base.campaign)
    where = f"{name} fits {bare:.3g} N down to {rms:.3g} N but predicts runs left out no better"
    return [Remainder("run", where, max(1.0 - (rms / bare) ** 2, 0.0))]


def _stands(search: Search, present: tuple[str, ...], noise_n: float) -> bool:
    """True where effects are worth their names though structure remains: they took most of the
    bare law's excess over the noise, and far more than the runs still disagree by."""
    empty, whole = search.solve(frozenset()), search.solve(frozenset(present))
    bare = root_mean_square(empty.residuals, search.campaign) ** 2
    now = root_mean_square(whole.residuals, search.campaign) ** 2
    if (bare - now) / max(bare - noise_n**2, 1e-300) < LEAST_EXPLAINED:
        return False
    left = disagreement(search.problem(present), whole)
    if not left.beyond_chance:
        return True
    gain = float(np.subtract(*costs(empty, whole))) * independent(whole)
    return gain > CLEAR * (left.gain - left.degrees)


def _withdrawn(step: Step) -> Step:
    """The first step, when what was added in it turned out to be a stand-in."""
    reason = "explains part of the error, but structure remains that it does not touch"
    trials = tuple(
        replace(t, outcome="withdrawn", reason=reason) if t.outcome in ("added", "ties") else t
        for t in step.trials
    )
    return replace(step, trials=trials)
