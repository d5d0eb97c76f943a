"""Terms of the observation model: what the recording adds to the output of a model.

Each module estimates one kind of term beside a model and returns it as a `Proposal`, whose evidence
is comparable with that of an effect. The selection (`jbf.diagnosis.rounds`) adds whichever has the
larger evidence.

| module | terms |
| --- | --- |
| `random_effects` | offset, drift and gain by run, temperature of the oil by run |
| `delays` | delay of the force by run, drift of its clock |
| `quantiser` | mean reading of a converter with coarse steps |
| `noise_variance` | variance by force and by run, heavy tails |
| `motion` | errors of the estimated motion |
"""

from __future__ import annotations

from dataclasses import dataclass

from jbf.diagnosis.candidates import Candidates
from jbf.diagnosis.evidence import price_of
from jbf.diagnosis.terms.delays import delays, explained_by_delays
from jbf.diagnosis.terms.motion import errors_of_motion
from jbf.diagnosis.terms.noise_variance import heavy_tails, variance_by_force, variance_by_run
from jbf.diagnosis.terms.proposal import Model, Term, accepted
from jbf.diagnosis.terms.quantiser import quantiser
from jbf.diagnosis.terms.random_effects import random_effect, without_random_effect
from jbf.estimation.campaign import Campaign

Names = tuple[str, ...]

COMPETING: tuple[Term, ...] = (errors_of_motion, random_effect)
"""Terms that compete with the effects: errors of the motion, since effects that filter a force or a
motion explain them; random effects, since an effect of what differs between runs resembles one."""
TERMS: tuple[Term, ...] = (
    errors_of_motion,
    random_effect,
    delays,
    quantiser,
    variance_by_force,
    variance_by_run,
    heavy_tails,
)
"""All terms, in the order in which they are preferred at equal evidence. The error of a model that
lacks an effect resembles most of them: they are estimated where no effect is accepted."""


@dataclass(frozen=True)
class Changed:
    """A campaign with other terms, and the effects that remain beside them."""

    campaign: Campaign
    effects: Names


def changed_terms(
    candidates: Candidates, present: Names, least: float | None = None
) -> Changed | None:
    """The campaign with the term that has the largest evidence beside a model, or without a random
    effect that the model no longer needs; None if no term changes.

    Parameters
    ----------
    least
        Evidence for the effect that is accepted, with which some terms compete; None if no effect
        is.
    """
    whole = _model(candidates, present, present)
    found = [(term(whole), whole) for term in (TERMS if least is None else COMPETING)]
    explained = explained_by_delays(present)
    if explained and least is None:
        rest = _model(candidates, tuple(n for n in present if n not in explained), present)
        found.append((delays(rest), rest))
    proposals = [(p, m) for p, m in found if p is not None]
    proposals.sort(key=lambda pair: -pair[0].evidence)
    for proposal, beside in proposals:
        if accepted(proposal, beside, least or 0.0):
            return Changed(proposal.campaign, proposal.problem.effects)
    fewer = without_random_effect(whole) if least is None else None
    return None if fewer is None else Changed(fewer, present)


def _model(candidates: Candidates, effects: Names, present: Names) -> Model:
    return Model(
        candidates.fitted(effects).problem,
        candidates.converge(effects),
        candidates.converge(present),
        candidates.policy,
        price_of(candidates, 1),
    )
