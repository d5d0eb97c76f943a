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

from jbf.diagnosis.candidates import Candidates
from jbf.diagnosis.evidence import price_of
from jbf.diagnosis.terms.delays import delays, explained_by_delays
from jbf.diagnosis.terms.motion import errors_of_motion
from jbf.diagnosis.terms.noise_variance import heavy_tails, variance_by_force, variance_by_run
from jbf.diagnosis.terms.proposal import Model, Proposal, Term, accepted
from jbf.diagnosis.terms.quantiser import quantiser
from jbf.diagnosis.terms.random_effects import random_effect

Names = tuple[str, ...]

BETWEEN_RUNS: tuple[Term, ...] = (random_effect,)
"""Terms that compete with the effects: the same deviation in all samples of a run resembles an
effect of what differs between runs."""
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


def leading_term(
    candidates: Candidates, present: Names, least: float | None = None
) -> Proposal | None:
    """The term with the largest evidence beside a model; None if none is accepted.

    Parameters
    ----------
    least
        Evidence for the effect that is accepted, with which random effects between runs compete;
        None if no effect is.
    """
    before = candidates.converge(present)

    def model(effects: Names) -> Model:
        return Model(
            candidates.fitted(effects).problem,
            candidates.converge(effects),
            before,
            candidates.policy,
            price_of(candidates, 1),
        )

    whole = model(present)
    found = [(term(whole), whole) for term in (TERMS if least is None else BETWEEN_RUNS)]
    explained = explained_by_delays(present)
    if explained and least is None:
        rest = model(tuple(name for name in present if name not in explained))
        found.append((delays(rest), rest))
    proposals = [(p, m) for p, m in found if p is not None]
    proposals.sort(key=lambda pair: -pair[0].evidence)
    return next((p for p, beside in proposals if accepted(p, beside, least or 0.0)), None)
