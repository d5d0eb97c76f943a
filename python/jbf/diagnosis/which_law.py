"""Which law at all: every law that a rig allows, by the runs that it was not fitted to.

Beside each stand the nuisances of any machine, a zero, the mass that is moved and a weight: they
are no friction, and a law that has to make up for them is not the law. The left-out error charges a
parameter what it costs. Laws that predict equally well, as far as the scatter between stretches of
the records tells, are tied; of these the one with fewest parameters is taken.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from jbf.diagnosis.candidates import Candidates, Progress
from jbf.diagnosis.machine import TERMS
from jbf.diagnosis.policy import Policy
from jbf.errors import InputError, Unfinished
from jbf.estimation.campaign import Campaign
from jbf.estimation.film_rate import check_film
from jbf.estimation.initial_state import memories
from jbf.estimation.left_out import left_out_by_run
from jbf.estimation.run_start import settled_campaign
from jbf.models.catalogue import find_law, laws
from jbf.models.chain import check_rig
from jbf.models.vocabulary import Clock
from jbf.records.rig import Rig

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

LAW_SHARE = 0.25
"""Of the work of a diagnosis, what one law may take to be compared."""
STRETCHES = 40
"""Parts of a campaign whose mean squares are compared."""


@dataclass(frozen=True)
class LawTried:
    """A law, as far as it predicts beside what is no friction.

    Attributes
    ----------
    law, parameters
        Its name, and how many parameters it has.
    left_out_rms_n
        RMS over runs left out of its fit, N, at the samples that count for every law.
    tied
        True where it predicts as well as the best, as far as chance tells.
    """

    law: str
    parameters: int
    left_out_rms_n: float
    tied: bool

    def to_dict(self) -> dict[str, Any]:
        """For JSON."""
        return {
            "law": self.law,
            "parameters": self.parameters,
            "left_out_rms_n": self.left_out_rms_n,
            "tied": self.tied,
        }


def allowed(rig: Rig) -> list[str]:
    """The laws for which a rig has all that they need."""
    found = []
    for name in laws():
        try:
            check_rig(rig, name)
        except InputError:
            continue
        found.append(name)
    return found


def followed(campaign: Campaign, clock: Clock) -> tuple[list[str], dict[str, str]]:
    """Those of them whose film, where they have one, is not too fast for the records, and why not
    the others."""
    found, refused = [], {}
    for name in allowed(campaign.rig):
        try:
            check_film(campaign, name, clock)
        except InputError as error:
            refused[f"law {name}"] = error.problem
            continue
        if campaign.steady and memories(name, ()):
            refused[f"law {name}"] = "steady states do not show its memory"
            continue
        found.append(name)
    return found, refused


def which_law(
    campaign: Campaign, clock: Clock, policy: Policy, progress: Progress | None = None
) -> tuple[tuple[LawTried, ...], dict[str, str]]:
    """The laws that the rig allows, the one to take first, then by their left-out error; and those
    that were not tried to their end, each with the reason."""
    names, refused = followed(campaign, clock)
    left: dict[str, list[Array]] = {}
    for i, name in enumerate(names):
        if progress is not None:
            progress(f"trying the law {name}", i, len(names))
        errors = _within(campaign, name, clock)
        if errors is None:
            refused[f"law {name}"] = "takes too long to follow along these records"
        else:
            left[name] = errors
    if not left:
        raise Unfinished(steps=campaign.work.most, file=campaign.named)
    counts = [len(find_law(name).parameters) for name in left]
    tried = compared(list(left), counts, list(left.values()), policy)
    first = min((t for t in tried if t.tied), key=lambda t: t.parameters)
    return (first, *(t for t in tried if t is not first)), refused


def _within(campaign: Campaign, law: str, clock: Clock) -> list[Array] | None:
    """Left-out errors of a law beside what is no friction; None where its share of the work is not
    enough for them."""
    own = replace(campaign, work=campaign.work.part(LAW_SHARE))
    try:
        candidates = Candidates(settled_campaign(own, law, clock), law, clock)
        beside = tuple(effect for effect in TERMS if effect in candidates.names)
        return left_out(candidates, beside)
    except Unfinished:
        return None


def left_out(candidates: Candidates, effects: tuple[str, ...]) -> list[Array]:
    """Errors of prediction of every run by a fit to the others, one row a run, N; NaN at samples
    that do not count."""
    solution, problem = candidates.converge(effects), candidates.fitted(effects).problem
    rows = []
    pairs = zip(left_out_by_run(problem, solution), solution.samples.counted, strict=True)
    for errors, counted in pairs:
        row = np.full(len(counted), np.nan)
        row[counted] = errors
        rows.append(row)
    return rows


def compared(
    names: Sequence[str],
    parameters: Sequence[int],
    left: Sequence[Sequence[Array]],
    policy: Policy,
) -> list[LawTried]:
    """Models by their left-out errors, best first, and which of them are tied with the best."""
    squares = np.array([np.concatenate(rows) ** 2 for rows in left])
    squares = squares[:, np.isfinite(squares).all(axis=0)]
    # Neighbouring samples err together: stretches are what is independent.
    parts = np.array_split(squares, min(STRETCHES, squares.shape[1]), axis=1)
    means = np.array([part.mean(axis=1) for part in parts]).T
    rms = np.sqrt(squares.mean(axis=1))
    best = int(np.argmin(rms))
    worse = means - means[best]
    chance = policy.law_tie * worse.std(axis=1) / np.sqrt(worse.shape[1])
    same = (policy.law_same**2 - 1.0) * rms[best] ** 2
    tied = worse.mean(axis=1) <= np.maximum(chance, same)
    order = np.argsort(rms, kind="stable")
    return [LawTried(names[i], parameters[i], float(rms[i]), bool(tied[i])) for i in order]


def simpler_law(candidates: Candidates, effects: tuple[str, ...], clock: Clock) -> LawTried | None:
    """Another law that predicts no worse than a model with effects, and has no more parameters;
    None where there is none. What several effects mend, one law may say; those that are no friction
    stay beside it."""
    policy, whole = candidates.policy, candidates.campaign
    kept = tuple(effect for effect in effects if effect in TERMS)
    most = len(candidates.fitted(effects).problem.open)
    left, names, counts = [left_out(candidates, effects)], [""], [most]
    for name in followed(whole, clock)[0]:
        own = replace(whole, work=whole.work.part(LAW_SHARE))
        other = Candidates(own, name, clock, policy)
        count = len(other.fitted(kept).problem.open)
        if name == candidates.law or count > most:
            continue
        # Far off in the fit is far off elsewhere.
        far = policy.leader_rms * candidates.converge(effects).rms_n
        try:
            errors = left_out(other, kept) if other.converge(kept).rms_n < far else None
        except Unfinished:
            continue
        if errors is not None:
            left.append(errors)
            names.append(name)
            counts.append(count)
    tried = compared(names, counts, left, policy)
    here = next(t for t in tried if t.law == "")
    others = [t for t in tried if t.law and t.tied]
    # Of two that say the same the one with fewer parameters, whichever comes out ahead by chance.
    better = [t for t in others if t.parameters < most or t.left_out_rms_n <= here.left_out_rms_n]
    return min(better, key=lambda t: t.parameters, default=None)
