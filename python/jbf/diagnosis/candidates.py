"""Candidate models of a diagnosis (sets of effects added to a law) and the state of their fits.

Each set of effects passes through several states. Its score is tested, it is ranked by a few steps
of a fit, it converges, and further peaks of a multimodal likelihood are searched. Each state is
computed once and cached.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np

from jbf.arrays import Names
from jbf.diagnosis.confirmation import Confirmation
from jbf.diagnosis.directions import RichestResidual
from jbf.diagnosis.fit_state import MOTION, Fitted, Reached
from jbf.diagnosis.level import Level, calibrated, score_test, with_decoys
from jbf.diagnosis.policy import DEFAULT, Policy
from jbf.estimation.approach import Approach, approach, many_peaks
from jbf.estimation.campaign import Campaign
from jbf.estimation.held_out import (
    HeldOutPart,
    errors_by_run,
    held_out_halves,
    held_out_parts,
    indispensable_runs,
)
from jbf.estimation.held_out_comparison import ExtrapolatedRun, extrapolated_runs
from jbf.estimation.likelihood import effective_share, likelihood_gain
from jbf.estimation.minimum import polish, search_peaks, settle
from jbf.estimation.parallel_fits import fits_at_once, in_parallel
from jbf.estimation.problem import Problem
from jbf.estimation.search import NEAR_MINIMUM
from jbf.estimation.solution import Solution
from jbf.estimation.uncertain_samples import has_unknown_start, spreads_jumps
from jbf.models.catalogue import can_be_added, find_effect, reason_not_applicable
from jbf.models.catalogue import effects as catalogue
from jbf.models.vocabulary import Clock

Progress = Callable[[str, int, int], None]

RANKING_EVALUATIONS = 6
"""Maximum number of evaluations of the approximate fit by which a candidate is ranked. It limits
the computing time only: competitive candidates are fitted further."""


class Candidates:
    """Campaign with a base law, the effects that may be added to it, and every fit made so far.

    `clock` defines the time constant of the film (`journal` or `thesis`). The solutions of
    `earlier`, of an earlier form of the campaign, are starting values.
    """

    def __init__(
        self,
        campaign: Campaign,
        law: str,
        clock: Clock,
        policy: Policy = DEFAULT,
        progress: Progress | None = None,
        earlier: Candidates | None = None,
    ) -> None:
        self.campaign, self.law, self.clock = campaign, law, clock
        self.earlier = earlier
        self.policy, self.progress = policy, progress
        self.reached: Reached = Reached() if earlier is None else earlier.reached
        self._fitted: dict[frozenset[str], Fitted] = {}
        self._level: Level | None = None
        self._levels: dict[frozenset[str], tuple[Level, RichestResidual | None]] = {}
        self.residual: RichestResidual | None = None
        """Residual of the last calibrated model without all that candidates can explain."""

    def with_campaign(
        self, campaign: Campaign, effects: Names | None = None, solution: Solution | None = None
    ) -> Candidates:
        """Return the candidates of a changed campaign; their fits start from these solutions.

        The fit of the model `effects` starts from `solution`, if it is given. Changed errors of the
        motion are not estimated again with this model.
        """
        self.earlier = None
        again = Candidates(campaign, self.law, self.clock, self.policy, self.progress, self)
        # Valid until the level is calibrated for a model of the new campaign.
        again._level = self._level
        if effects is not None:
            fitted = again.fitted(effects)
            if campaign.samples.motion is not self.campaign.samples.motion:
                fitted.proposals[MOTION] = None
            if solution is not None:
                fitted.solution, fitted.state = solution, "ranked"
        return again

    @cached_property
    def names(self) -> list[str]:
        """Names of the effects that are compatible with the law and testable in these runs."""
        return [name for name, reason in self._missing_requirements.items() if reason is None]

    @cached_property
    def not_tried(self) -> dict[str, str]:
        """Effects that are compatible with the law but not testable in these runs, with reasons."""
        reasons = self._missing_requirements
        return {name: reason for name, reason in reasons.items() if reason is not None}

    @cached_property
    def _missing_requirements(self) -> dict[str, str | None]:
        """Why these runs cannot test an effect that the law allows, or None, by name."""
        pages = (e for e in catalogue().values() if reason_not_applicable(e, self.law) is None)
        return {e.name: self.campaign.missing_requirement(e) for e in pages}

    def addable(self, present: Collection[str]) -> list[str]:
        """Names of the effects that can be added to a model with the effects `present`."""
        return [n for n in self.names if n not in present and can_be_added(n, present)]

    def fitted(self, effects: Iterable[str]) -> Fitted:
        """Return the cached fit of a set of effects, or a new one whose `state` is `posed`."""
        key = frozenset(effects)
        if key not in self._fitted:
            problem = Problem(self.campaign, self.law, self.clock, tuple(key))
            self._fitted[key] = Fitted(problem)
        return self._fitted[key]

    def score_test(self, effects: Sequence[str], near: Solution) -> float:
        """Gain that a score test predicts for a model with effects added to that of `near`.

        It is the gain in twice the log likelihood that one Gauss-Newton step predicts from the null
        of the added effects, with the parameters of the law free; the maximum over all starting
        values. It is infinite where the null cannot be reached by a step, or where an effect shifts
        or smooths friction jumps or has a free initial state.
        """
        fitted = self.fitted(effects)
        if fitted.score is None:
            added = set(effects) - set(near.effects)
            nulls = {
                name: page.null
                for name, page in fitted.problem.parameters.items()
                if name.split(".")[0] in added and page.null is not None
            }
            reach = bool(nulls) and all(np.isfinite(null) for null in nulls.values())
            # A jump that moves by less than a sample changes no sample: the score is zero.
            if not reach or any(find_effect(name).moves_jumps for name in added):
                fitted.score = np.inf
            else:
                known = self.fitted(near.effects).problem.values_by_name(near.values) | nulls
                starts = fitted.problem.starts(known)
                fitted.score, fitted.directions, fitted.stepped = score_test(
                    fitted.problem, starts, near, added
                )
                # The score is also uninformative where jumps are spread, since the samples next to
                # them may be the most informative, and for a free initial state, whose gain is
                # obtained far from the null.
                if spreads_jumps(added) or has_unknown_start(added):
                    fitted.score = np.inf
        return fitted.score

    def independent_share(self, solution: Solution) -> float:
        """Effective number of independent samples of a solution divided by their number."""
        share = effective_share(solution)
        return share if self.residual is None else max(share, self.residual.share)

    @property
    def level(self) -> Level:
        """Acceptance threshold for the gain of an effect; before calibration that of the law."""
        if self._level is None:
            self._level = self._white_noise_level(())
        return self._level

    def price(self, parameters: int) -> float:
        """Acceptance threshold for the gain of a model with this number of added parameters."""
        return self.level.price(parameters, self.campaign.samples.count)

    def calibrate(self, present: Sequence[str]) -> None:
        """Calibrate `level`, the acceptance threshold, by the residual of the present model."""
        key = frozenset(present)
        if key not in self._levels:
            tested = [self.fitted((*present, name)) for name in self.names if name not in key]
            directions = [f.directions for f in tested if f.directions is not None]
            samples = self.fitted(present).problem.score_test_problem.campaign.samples
            self.residual = residual = RichestResidual.of(directions, samples)
            if residual is not None:
                directions = [replace(d, share=max(d.share, residual.share)) for d in directions]
            level = calibrated(self._white_noise_level(present), directions, residual)
            count = self.campaign.samples.count
            self._levels[key] = (with_decoys(level, directions, count), residual)
            for fitted in self._fitted.values():
                fitted.directions = None  # These arrays are as large as the records.
        self._level, self.residual = self._levels[key]

    def _white_noise_level(self, present: Sequence[str]) -> Level:
        """Acceptance threshold in white noise, for the residual of the model with these effects."""
        base = self.converge(present)
        samples = self.independent_share(base) * base.samples.count
        least = self.policy.least_effect_share(self.campaign.motion_share)
        return Level.in_white_noise(self.policy, len(self.names), samples, base.rms, least)

    # ---- fits -------------------------------------------------------------------------------

    def rank(self, effects: Sequence[str], near: Solution | None = None) -> Solution:
        """Fit a model approximately, from the solution `near` or of the most similar model."""
        fitted = self.fitted(effects)
        if fitted.state in ("posed", "looked"):
            near = self._most_similar(effects) if near is None else near
            way = fitted.approach or self._approach(fitted, effects, near)
            fitted.improve(way.follow(RANKING_EVALUATIONS, fitted.max_square))
            fitted.state, fitted.approach, fitted.promised = "ranked", None, np.inf
        return fitted.current_solution()

    def _most_similar(self, effects: Sequence[str]) -> Solution | None:
        """Solution of the fitted model that differs by the fewest effects; None without a fit."""
        wanted = frozenset(effects)
        fits = [(k, f) for k, f in self._fitted.items() if f.state in ("ranked", "converged")]
        # Of equally similar models, one with more effects has values of more parameters.
        fits.sort(key=lambda fit: (len(wanted ^ fit[0]), -len(fit[0]), sorted(fit[0])))
        return fits[0][1].current_solution() if fits else None

    def look(self, effects: Sequence[str], near: Solution) -> Fitted:
        """Fit a model with these effects by a few steps, from the solution of a smaller model."""
        fitted = self.fitted(effects)
        if fitted.state == "posed":
            fitted.approach = self._approach(fitted, effects, near)
            fitted.solution, fitted.promised = fitted.approach.look(near)
            fitted.state = "looked"
        return fitted

    def _approach(self, fitted: Fitted, effects: Sequence[str], near: Solution | None) -> Approach:
        """Create the unfinished search for the fit of these effects, with its starting values."""
        seeds: list[Sequence[Mapping[str, float]]] = [[{}]]
        many = near is not None and many_peaks(near.effects)
        earlier = None if self.earlier is None else self.earlier._fitted.get(frozenset(effects))
        if earlier is not None and earlier.state in ("ranked", "converged"):
            # Start from the solution before the sample weights changed.
            seeds = [[earlier.named_values()]]
        elif near is not None:
            near_values = self.fitted(near.effects).problem.values_by_name(near.values)
            # Law parameters that compensated for the missing effect are poor starting values; with
            # many peaks, those of the other effects are poor as well.
            of_effects = {n: v for n, v in near_values.items() if "." in n}
            others = self.fitted(near.effects).default_starts if many else [of_effects]
            seeds, fitted.started_from = [[near_values], others], frozenset(near.effects)
        if near is not None and set(near.effects) < set(effects):
            fitted.max_square = self._required_square(near)
        return Approach(fitted.problem, seeds, each=many, stepped=fitted.stepped)

    def rank_all(self, sets: Sequence[Sequence[str]], near: Solution) -> None:
        """Rank several sets of effects (`rank`), each from the solution of a smaller model."""
        self._each("trying", lambda effects: self.rank(effects, near), sets, near)

    def look_all(self, sets: Sequence[Sequence[str]], near: Solution) -> None:
        """Fit several sets of effects by a few steps (`look`) from a smaller model's solution."""
        self._each("looking at", lambda effects: self.look(effects, near), sets, near)

    def score_all(
        self, effects: Sequence[str], names: Iterable[str], near: Solution
    ) -> dict[str, float]:
        """Gain of each effect in `names` added to `effects`, by its score test (`score_test`)."""
        sets = {name: (*effects, name) for name in names}
        self._each("testing", lambda each: self.score_test(each, near), [*sets.values()], near)
        return {name: self.score_test(each, near) for name, each in sets.items()}

    def _each(
        self,
        doing: str,
        work: Callable[[Sequence[str]], object],
        sets: Sequence[Sequence[str]],
        near: Solution,
    ) -> None:
        """Apply a function to each set of effects in parallel threads and report progress."""
        if many_peaks(near.effects):
            _ = self.fitted(near.effects).default_starts  # computed before the threads start
        # The largest problems first.
        order = sorted(sets, key=lambda effects: -len(self.fitted(effects).problem.open))
        done = in_parallel(work, order, fits_at_once(self.campaign, self.law, self.names))
        for i, effects in enumerate(order):
            added = (name for name in effects if name not in near.effects)
            self.tell(f"{doing} {', '.join(added)}", i, len(sets))
            next(done)

    def converge(self, effects: Sequence[str], near: Solution | None = None) -> Solution:
        """Return the solution of the fit with these effects, converged to `NEAR_MINIMUM`."""
        fitted = self.fitted(effects)
        if fitted.state != "converged":
            ranked = self.rank(effects, near)
            fitted.solution = settle(fitted.problem, ranked, least_gain=NEAR_MINIMUM)
            fitted.state = "converged"
        return fitted.current_solution()

    def polish(self, effects: Sequence[str]) -> Solution:
        """Continue the fit of a final model; its held-out predictions hardly change."""
        fitted = self.fitted(effects)
        fitted.solution = polish(fitted.problem, self.converge(effects))
        return fitted.solution

    def search_peaks(self, effects: Sequence[str]) -> Solution:
        """Search for a higher maximum of the likelihood of a model with these effects.

        The fit of fewer effects may have converged to another maximum. Each set is searched once.
        """
        near, fitted = self.converge(effects), self.fitted(effects)
        if fitted.peaks_searched:
            return near
        fitted.peaks_searched = True
        highest = search_peaks(fitted.problem, near, NEAR_MINIMUM)
        if len(frozenset(effects)) > 1 and many_peaks(effects):
            # Repeat the fit from default values, without the earlier solutions.
            fresh = approach(fitted.problem, [fitted.default_starts], RANKING_EVALUATIONS)
            if likelihood_gain(fresh, highest) > -self.policy.search.rank_margin:
                fresh = settle(fitted.problem, fresh, least_gain=NEAR_MINIMUM)
                fresh = search_peaks(fitted.problem, fresh, NEAR_MINIMUM)
                highest = fresh if likelihood_gain(fresh, highest) > 0.0 else highest
        fitted.improve(highest)
        return highest

    def refit_from(self, effects: Sequence[str], richer: Sequence[str]) -> Solution:
        """Refit a smaller set of effects from the parameter values of a richer model.

        Its fit may have converged to a local minimum that the richer model avoided.
        """
        self.converge(richer)  # a new fit of the smaller model starts from it
        near, fitted = self.converge(effects), self.fitted(effects)
        if fitted.started_from == frozenset(richer):
            return near
        problem, richer_values = fitted.problem, self.fitted(richer).named_values()
        start = np.array([richer_values[name] for name in problem.names])
        samples = problem.samples_at(start)
        unconverged = problem.solution(start, samples, near.noise, False)
        refit = settle(problem, unconverged, samples, NEAR_MINIMUM)
        # With run-specific parameters, a wrong law can have a higher likelihood but a larger RMS.
        too_large = refit.rms > self.policy.selection.max_rms_ratio * near.rms
        if likelihood_gain(refit, near) > 0.0 and not too_large:
            fitted.improve(refit)
        return fitted.current_solution()

    def confirmation(self, present: Sequence[str], name: str) -> Confirmation:
        """Compare the held-out errors of a model with and without one added effect.

        A run that alone determines a parameter, or that is beyond the range of all others, is held
        out in two parts, in both fits.
        """
        richer = (*present, name)
        before, after = self.converge(present), self.converge(richer)
        halved = indispensable_runs(self.fitted(richer).problem, after)
        beyond = {run.run for run in self.beyond} - halved
        held_out, richer_held_out = (
            self.held_out_parts(effects, halved, beyond) for effects in (present, richer)
        )
        names = tuple(self.campaign.samples.runs[i] for i in sorted(halved | beyond))
        prepared = self.campaign.prepared
        return Confirmation.of(before, after, held_out, richer_held_out, names, prepared)

    def held_out_parts(
        self, effects: Sequence[str], halved: Collection[int] = (), alternate: Collection[int] = ()
    ) -> list[HeldOutPart]:
        """Held-out predictions of all runs, each from a fit to the other runs.

        Two parts of some runs (indices) are held out in turn instead of the complete run: the
        halves of the runs `halved`, and alternate sections of the runs `alternate`.
        """
        solution, fitted = self.converge(effects), self.fitted(effects)
        if not fitted.held_out:
            fitted.held_out = held_out_parts(fitted.problem, solution)
        split = {**dict.fromkeys(halved, False), **dict.fromkeys(alternate, True)}
        parts = [p for part in fitted.held_out if (p := part.without([*split])).runs]
        for run, alternating in sorted(split.items()):
            if (run, alternating) not in fitted.halves:
                predictions = held_out_halves(fitted.problem, solution, run, alternate=alternating)
                fitted.halves[run, alternating] = predictions
            parts += fitted.halves[run, alternating]
        return parts

    @cached_property
    def beyond(self) -> list[ExtrapolatedRun]:
        """Runs whose speed or load is beyond the range of all others; empty for a single run."""
        return extrapolated_runs(self.campaign)

    def held_out_within_range(self, effects: Sequence[str]) -> list[HeldOutPart]:
        """Held-out predictions, from fits that cover the range of each run.

        Alternate sections of a run are held out if it is beyond the range of all others.
        """
        return self.held_out_parts(effects, alternate=[b.run for b in self.beyond])

    def held_out_rms(self, effects: Sequence[str]) -> float:
        """Root mean square of the errors of `held_out_within_range`, N."""
        parts = self.held_out_within_range(effects)
        errors = np.concatenate(list(errors_by_run(self.converge(effects), parts).values()))
        return float(np.sqrt(np.mean(errors**2))) if len(errors) else 0.0

    def _required_square(self, near: Solution) -> float:
        """Sum of squares below which a model with more effects has a relevant gain, N^2."""
        samples, share = self.campaign.samples, self.policy.search.min_score_share
        shown = share * self.price(1) / samples.count
        return samples.square(near.residuals) * float(np.exp(-shown))

    def tell(self, message: str, done: int, total: int) -> None:
        """Report progress to the user's callback, if there is one."""
        if self.progress is not None:
            self.progress(message, done, total)
