"""Selection of the base law by the held-out errors of all laws that a rig allows.

Each law is fitted together with the machine terms offset, moved mass and weight, so that it does
not compensate for them. The held-out error penalises superfluous parameters. Laws whose errors
differ by no more than the scatter between sections of the records are tied. The tied law with the
fewest parameters is selected.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from jbf.arrays import Array, Mask
from jbf.diagnosis.candidates import Candidates, Progress
from jbf.diagnosis.policy import Policy
from jbf.diagnosis.review import MACHINE_TERMS
from jbf.errors import InputError, Unfinished
from jbf.estimation.campaign import Campaign
from jbf.estimation.samples import Samples
from jbf.estimation.transients import check_film_rate, without_transients
from jbf.estimation.uncertain_samples import initial_memories
from jbf.models.catalogue import find_law, laws
from jbf.models.chain import check_rig
from jbf.models.vocabulary import Clock

SIMPLEST = "coulomb"
"""The simplest law of dry friction."""
ON_REQUEST = frozenset({"rate_and_state"})
"""Laws that are not part of the automatic selection.

On records without velocity steps of several slip distances, the parameters of `rate_and_state` are
not identifiable, and it predicts no better than `stribeck`.
"""


@dataclass(frozen=True)
class LawTried:
    """Held-out error of a law that is fitted together with the machine terms.

    Attributes
    ----------
    law, parameters
        Name and number of parameters of the law.
    held_out_rms
        Held-out RMS on the samples common to all laws, N.
    tied
        Whether the error is not significantly larger than that of the best law.
    static_below_kinetic
        Whether the fitted static friction F_s is below the kinetic friction F_c.
    """

    law: str
    parameters: int
    held_out_rms: float
    tied: bool
    static_below_kinetic: bool = False

    def to_dict(self) -> dict[str, Any]:
        """Return a JSON-serialisable dict."""
        return {
            "law": self.law,
            "parameters": self.parameters,
            "held_out_rms": self.held_out_rms,
            "tied": self.tied,
        }


@dataclass(frozen=True, eq=False)
class HeldOut:
    """Held-out prediction errors of one law.

    Attributes
    ----------
    errors
        Record minus prediction, N, one array per run; NaN at excluded samples.
    white
        Errors whitened with the covariance of the motion errors, if it is known.
    static_below_kinetic
        Whether the fitted static friction F_s is below the kinetic friction F_c.
    """

    errors: list[Array]
    white: list[Array]
    static_below_kinetic: bool = False


def followed(campaign: Campaign, clock: Clock) -> tuple[list[str], dict[str, str]]:
    """Laws that the rig allows and the records can resolve; reasons for excluding others, by name.

    A law is not allowed if the rig lacks a quantity that it requires. It is excluded with a reason
    if its film is too fast for the records, or if it has memory and the records contain steady
    states only.
    """
    resolved, refused = [], {}
    for name in laws():
        if name in ON_REQUEST:
            continue
        try:
            check_rig(campaign.rig, name)
        except InputError:
            continue
        try:
            check_film_rate(campaign, name, clock)
        except InputError as error:
            refused[f"law {name}"] = error.problem
            continue
        if campaign.steady and initial_memories(name, ()):
            refused[f"law {name}"] = "steady states do not show its memory"
            continue
        resolved.append(name)
    return resolved, refused


def which_law(
    campaign: Campaign, clock: Clock, policy: Policy, progress: Progress | None = None
) -> tuple[tuple[LawTried, ...], dict[str, str]]:
    """Compare the laws that the rig allows by their held-out errors.

    Returns the laws, the selected one first and the others by held-out error; and the laws that
    were not evaluated, with the reasons.
    """
    names, refused = followed(campaign, clock)
    held_out: dict[str, HeldOut] = {}
    time_limit = campaign.work.time_limit
    if time_limit is not None:
        time_limit = time_limit.part(policy.laws.time_share)
        campaign = replace(campaign, work=replace(campaign.work, time_limit=time_limit))
    for i, name in enumerate(names):
        if progress is not None:
            progress(f"trying the law {name}", i, len(names))
        try:
            held_out[name] = _within(campaign, name, clock, policy)
        except Unfinished as stop:
            refused[f"law {name}"] = stop.reason
    if not held_out:
        limit_s = None if time_limit is None else time_limit.seconds
        raise Unfinished(steps=campaign.work.most, file=campaign.named, time_limit_s=limit_s)
    entries = {name: (len(find_law(name).parameters), errors) for name, errors in held_out.items()}
    tried = compared(entries, policy, policy.least_effect_share(campaign.motion_share))
    first = min((t for t in tried if t.tied), key=lambda t: t.parameters)
    return (first, *(t for t in tried if t is not first)), refused


def laws_to_diagnose(laws: Sequence[LawTried]) -> tuple[str, ...]:
    """Names of the laws to diagnose, the selected one last.

    An elastic law is preceded by the best law without memory. If the static friction of the law
    without memory is below its kinetic friction, the simplest law precedes it: a missing effect may
    be the cause, such as viscous friction that is less than proportional to speed. A later law
    replaces an earlier one only if it predicts better by a margin (`diagnose`).
    """
    selected = laws[0]
    memoryless = [t for t in laws if not initial_memories(t.law, ())]
    names = [selected.law]
    if find_law(selected.law).has_bristle:
        names = [*(t.law for t in memoryless[:1]), selected.law]
    if any(t.static_below_kinetic for t in memoryless if t.law in names):
        names.insert(0, SIMPLEST)
    evaluated = {t.law for t in laws}
    return tuple(name for name in dict.fromkeys(names) if name in evaluated)


def _within(campaign: Campaign, law: str, clock: Clock, policy: Policy) -> HeldOut:
    """Held-out errors of a law with the machine terms, within its share of the budget."""
    limited = replace(campaign, work=campaign.work.part(policy.laws.budget_share))
    candidates = Candidates(without_transients(limited, law, clock), law, clock, policy)
    terms = tuple(effect for effect in MACHINE_TERMS if effect in candidates.names)
    return held_out_errors(candidates, terms)


def held_out_errors(candidates: Candidates, effects: tuple[str, ...]) -> HeldOut:
    """Prediction errors of each run or section by a model fitted to the other ones.

    For a bristle law the errors include the samples of the initial-state transient: other laws
    predict these samples, and in an application the initial state is unknown.
    """
    solution, problem = candidates.converge(effects), candidates.fitted(effects).problem
    samples = solution.samples
    if find_law(problem.law).has_bristle:
        samples = _with_starts(samples, [p.selectable for p in problem.campaign.prepared])
    every = [np.zeros(len(c)) for c in samples.counted]
    for part in candidates.held_out_within_range(effects):
        for i, held_out, residual in zip(part.runs, part.masks, part.residuals, strict=True):
            every[i][held_out] = residual[held_out]
    white = every if samples.motion is None else samples.innovations(every, solution.noise)
    errors, white = (
        [np.where(c, e, np.nan) for e, c in zip(rows, samples.counted, strict=True)]
        for rows in (every, white)
    )
    values = problem.values_by_name(solution.values)
    static_below_kinetic = values.get("F_s", np.inf) < values.get("F_c", 0.0)
    return HeldOut(errors, white, static_below_kinetic)


def _with_starts(samples: Samples, every: Sequence[Mask]) -> Samples:
    """Add to a selection the samples of `every` before the first selected sample of each run."""
    counted = []
    for selected, other in zip(samples.counted, every, strict=True):
        start = int(np.argmax(selected)) if selected.any() else 0
        counted.append(selected | (other & (np.arange(len(selected)) < start)))
    weight = [np.where(w > 0.0, w, c) for w, c in zip(samples.weight, counted, strict=True)]
    return replace(samples, counted=tuple(counted), weight=tuple(weight))


def compared(
    entries: Mapping[str, tuple[int, HeldOut]], policy: Policy, least_share: float = 0.0
) -> list[LawTried]:
    """Rank models by their held-out errors, best first, and mark those tied with the best.

    `entries` has the number of parameters and the held-out errors of each model, by name. The
    errors whitened for the errors of the motion determine the ranking, since an elastic law would
    smooth acceleration errors next to a reversal. A model is tied with the best if its
    mean square is larger by less than chance, than `laws.same_ratio` of the policy allows, or than
    `least_share` of the best.
    """
    plain, decisive = (
        np.array([np.concatenate(rows) ** 2 for rows in kind])
        for kind in zip(*((h.errors, h.white) for _, h in entries.values()), strict=True)
    )
    shared = np.isfinite(plain).all(axis=0)
    names = list(entries)

    def law_tried(i: int, rms: float, tied: bool) -> LawTried:
        """Result of the i-th model."""
        parameters, held_out = entries[names[i]]
        return LawTried(names[i], parameters, rms, tied, held_out.static_below_kinetic)

    if not shared.any():
        return [law_tried(i, float(np.sqrt(np.nanmean(e))), True) for i, e in enumerate(plain)]
    rms, decisive = np.sqrt(plain[:, shared].mean(axis=1)), decisive[:, shared]
    # Errors of neighbouring samples are correlated; sections are nearly independent.
    parts = np.array_split(decisive, min(policy.laws.sections, decisive.shape[1]), axis=1)
    means = np.array([part.mean(axis=1) for part in parts]).T
    level = decisive.mean(axis=1)
    best = int(np.argmin(level))
    worse = means - means[best]
    chance = policy.laws.tie_sigma * worse.std(axis=1) / np.sqrt(worse.shape[1])
    same = max(policy.laws.same_ratio**2 - 1.0, least_share) * level[best]
    tied = worse.mean(axis=1) <= np.maximum(chance, same)
    order = np.argsort(level, kind="stable")
    return [law_tried(i, float(rms[i]), bool(tied[i])) for i in order]


def simplest_law_suffices(candidates: Candidates, effects: tuple[str, ...], clock: Clock) -> bool:
    """Whether the simplest law with the same effects predicts held-out runs as well.

    A law with more parameters may have been selected because it partly described a missing effect.
    False if this law is the simplest one, or if the budget is too small for the comparison.

    Raises
    ------
    Unfinished
        The time limit is reached.
    """
    policy, campaign = candidates.policy, candidates.campaign
    limited = replace(campaign, work=campaign.work.part(policy.laws.budget_share))
    simplest = Candidates(limited, SIMPLEST, clock, policy, candidates.progress)
    if candidates.law == SIMPLEST or not set(effects) <= set(simplest.names):
        return False
    try:
        entries = {
            each.law: (len(find_law(each.law).parameters), held_out_errors(each, effects))
            for each in (candidates, simplest)
        }
    except Unfinished:
        campaign.work.check()  # the law exceeded its share; at the time limit, stop
        return False
    tried = compared(entries, policy, policy.least_effect_share(campaign.motion_share))
    return next(t.tied for t in tried if t.law == SIMPLEST)


def simpler_law(candidates: Candidates, effects: tuple[str, ...], clock: Clock) -> LawTried | None:
    """Find a law that predicts no worse than a model with effects and has no more parameters.

    One law may replace several effects. The machine terms are kept. None if no such law exists.

    Raises
    ------
    Unfinished
        The time limit is reached.
    """
    policy, campaign = candidates.policy, candidates.campaign
    kept = tuple(effect for effect in effects if effect in MACHINE_TERMS)
    most = len(candidates.fitted(effects).problem.open)
    entries = {"": (most, held_out_errors(candidates, effects))}
    for name in followed(campaign, clock)[0]:
        limited = replace(campaign, work=campaign.work.part(policy.laws.budget_share))
        other = Candidates(limited, name, clock, policy)
        count = len(other.fitted(kept).problem.open)
        if name == candidates.law or count > most:
            continue
        # A law with a much larger fit RMS does not predict better.
        max_rms = policy.selection.max_rms_ratio * candidates.converge(effects).rms
        try:
            errors = held_out_errors(other, kept) if other.converge(kept).rms < max_rms else None
        except Unfinished:
            campaign.work.check()  # the law exceeded its share; at the time limit, stop
            continue
        if errors is not None:
            entries[name] = count, errors
    tried = compared(entries, policy, policy.least_effect_share(campaign.motion_share))
    present = next(t for t in tried if t.law == "")
    others = [t for t in tried if t.law and t.tied]
    # Of tied laws prefer the one with the fewest parameters: their order is due to chance.
    better = [t for t in others if t.parameters < most or t.held_out_rms <= present.held_out_rms]
    return min(better, key=lambda t: t.parameters, default=None)
