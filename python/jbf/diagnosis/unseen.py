"""Effects that are not detectable in the present runs, and the run that would show most of them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
import numpy.typing as npt
from scipy import special

from jbf.diagnosis.candidates import Candidates
from jbf.diagnosis.evidence import price_of
from jbf.diagnosis.excitations import Excitation, Limits
from jbf.diagnosis.experiment import Experiment
from jbf.diagnosis.power import Power
from jbf.diagnosis.separation import (
    SIMULATED,
    Rival,
    filled_limits,
    motions,
)
from jbf.estimation.problem import Problem
from jbf.models.catalogue import find_effect
from jbf.records.run import Run

Array = npt.NDArray[np.float64]
Names = tuple[str, ...]


def undetectable_effects(candidates: Candidates, present: Names, powers: Iterable[Power]) -> Names:
    """Candidates that are not detectable in these runs at their usual strength.

    The law's own parameters can absorb them, the noise covers them, or they show only in samples
    that are not counted.
    """
    hidden = {p.effect for p in powers if p.hidden}
    found = []
    for name in candidates.names:
        page = find_effect(name)
        if name not in hidden or set(page.columns) - SIMULATED:
            continue
        if "transmitted" in page.needs and not _changes(candidates, present, name):
            # It has no influence in this model, whatever the motion.
            continue
        found.append(name)
    return tuple(found)


def _changes(candidates: Candidates, present: Names, name: str) -> bool:
    """Whether an effect at its usual strength changes any prediction of these runs."""
    now = candidates.fitted(present).problem.predict(candidates.converge(present).values)
    richer, values = _with_usual(candidates, present, name)
    there = richer.predict(values)
    return any(bool(np.any(a != b)) for a, b in zip(there, now, strict=True))


def propose_detection_run(
    candidates: Candidates, present: Names, hidden: Sequence[str], limits: Limits | None = None
) -> Experiment | str:
    """Propose the run that would show most of the effects not detectable in the present runs."""
    limits, step_s = filled_limits(candidates, limits)
    candidates.converge(present)
    base = Rival(candidates.fitted(present))
    richer = {name: _with_usual(candidates, present, name) for name in hidden}
    prices = {
        name: price_of(candidates, len(problem.open) - base.solution.free)
        for name, (problem, _) in richer.items()
    }
    strengths = candidates.policy.experiments.strengths
    best: tuple[float, float] = (0.0, 0.0)
    chosen: tuple[Excitation, Run, dict[str, float]] | None = None
    for excitation, run, motion in motions(candidates, limits, step_s):
        own = base.at(motion)
        shown = {
            name: base.separation(own, (problem.chain.predict(values, [motion])[0], own[1]), step_s)
            for name, (problem, values) in richer.items()
        }
        chances = sum(
            mean_detection_probability(shown[name], prices[name], strengths) for name in hidden
        )
        rank = (round(chances, 2), sum(np.log1p(evidence) for evidence in shown.values()))
        if rank > best:
            best, chosen = rank, (excitation, run, shown)
    listed = ", ".join(hidden)
    clear = {}
    if chosen is not None:
        least = 2.0 * candidates.policy.experiments.min_evidence
        clear = {name: evidence for name, evidence in chosen[2].items() if evidence > least}
    if chosen is None or not clear:
        return (
            f"these runs could not show {listed} at a usual strength, nor could any motion within "
            "the limits"
        )
    excitation, run, _ = chosen
    which = "them" if len(clear) == len(hidden) else ", ".join(clear)
    words = (
        f"these runs could not show {listed} at a usual strength: record {excitation.words} for "
        f"{limits.duration_s:g} s, which would show {which}"
    )
    usual = float(np.exp(np.mean(np.log(list(clear.values())))))
    sigma = float(np.sqrt(usual / len(run)))
    return Experiment(words, run, sigma * base.noise_rms, sigma, usual)


def mean_detection_probability(evidence: float, price: float, strengths: Sequence[float]) -> float:
    """Probability of detecting an effect of uncertain strength.

    Parameters
    ----------
    evidence
        Non-centrality at the usual strength.
    price
        Threshold for the gain.
    strengths
        Multiples of the usual strength, equally likely.
    """
    missed = special.chndtr(price, 1.0, np.array(strengths) ** 2 * evidence)
    return float(np.mean(1.0 - missed))


def _with_usual(candidates: Candidates, present: Names, name: str) -> tuple[Problem, Array]:
    """A model with one additional effect, at the first of its starting values."""
    candidates.converge(present)
    base = candidates.fitted(present).named_values()
    problem = candidates.fitted((*present, name)).problem
    return problem, next(iter(problem.starts(base)))
