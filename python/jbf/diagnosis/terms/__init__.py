"""Terms of the observation model: differences between recording and model output.

Each module estimates one kind of term for a given model and returns it as a `Proposal`, whose
evidence is comparable with that of an effect. The selection (`jbf.diagnosis.rounds`) adds the term
with the largest evidence if no effect is accepted; errors of the motion and random effects also
compete with the effects.

| module | terms |
| --- | --- |
| `random_effects` | offset, drift and gain by run, temperature of the oil by run |
| `delays` | delay of the force by run, drift of its clock |
| `quantiser` | mean reading of a converter with coarse quantisation |
| `noise_variance` | variance by force and by run, heavy tails |
| `motion` | errors of the estimated motion |
"""

from __future__ import annotations

from typing import NamedTuple

from jbf.arrays import Names
from jbf.diagnosis.candidates import Candidates
from jbf.diagnosis.evidence import may_describe_motion_errors
from jbf.diagnosis.fit_state import INSTEAD_OF_ERRORS, MOTION
from jbf.diagnosis.residual_structure import find_residual_structure
from jbf.diagnosis.terms.delays import delays, explained_by_delays
from jbf.diagnosis.terms.motion import errors_of_motion
from jbf.diagnosis.terms.noise_variance import heavy_tails, variance_by_force, variance_by_run
from jbf.diagnosis.terms.proposal import Model, Proposal, Term, is_accepted
from jbf.diagnosis.terms.quantiser import quantiser
from jbf.diagnosis.terms.random_effects import random_effect, without_random_effect
from jbf.diagnosis.terms.shifts import without_delay
from jbf.estimation.campaign import DISTORTS_FORCE, Campaign
from jbf.estimation.generalised_least_squares import fit_without_motion_corrections
from jbf.estimation.posterior_motions import corrected_delay_s
from jbf.estimation.solution import Solution
from jbf.models.delayed_reading import DELAY

TERMS: tuple[Term, ...] = (
    errors_of_motion,
    random_effect,
    delays,
    quantiser,
    variance_by_force,
    variance_by_run,
    heavy_tails,
)
"""All terms, in order of preference at equal evidence.

The error of a model with a missing effect resembles most of them. They are therefore estimated only
if no effect is accepted. Errors of the motion compete with an accepted effect, since effects that
filter a force or a motion can explain these errors, and so do random effects.
"""


class Leader(NamedTuple):
    """Accepted effect, which is not yet a part of the model, and its evidence."""

    effect: str
    evidence: float


class Update(NamedTuple):
    """Change of the observation model.

    Attributes
    ----------
    campaign
        The campaign with the changed term.
    effects
        Effects of the model that the term was estimated with.
    solution
        Its fit with the changed term; None if the term was removed.
    """

    campaign: Campaign
    effects: Names
    solution: Solution | None


def best_term_update(
    candidates: Candidates, present: Names, leader: Leader | None = None
) -> Update | None:
    """Add the term of the observation model with the largest evidence, or remove a random effect.

    With a leader, only errors of the motion and random effects are tried, and an effect in place of
    a delay of more than a sampling interval. Each must have more evidence than the leader.

    Without a leader, all terms are tried, a random effect that is no longer significant is removed,
    and an effect may replace errors of the motion. None if no term changes.
    """
    full = _model(candidates, present, present)
    estimates = [(_errors_of_motion(candidates, present), full)]
    if leader is None:
        estimates += [(term(full), full) for term in TERMS if term is not errors_of_motion]
    else:
        estimates.append((_random_effect_before(candidates, present, leader), full))
    explained = explained_by_delays(present)
    if explained and leader is None:
        reduced = _model(candidates, tuple(n for n in present if n not in explained), present)
        estimates.append((delays(reduced), reduced))
    if leader is None or _delay_in_steps(candidates.campaign) > 1.0:
        estimates.append((_effect_instead_of_errors(candidates, present), full))
    proposals = [(p, model) for p, model in estimates if p is not None]
    proposals.sort(key=lambda pair: -pair[0].evidence)
    for proposal, model in proposals:
        if is_accepted(proposal, model, 0.0 if leader is None else leader.evidence):
            return Update(proposal.campaign, proposal.problem.effects, proposal.solution)
    fewer = without_random_effect(full) if leader is None else None
    return None if fewer is None else Update(fewer, present, None)


def _random_effect_before(
    candidates: Candidates, present: Names, leader: Leader
) -> Proposal | None:
    """Propose a random effect that has more evidence than the leader.

    None if held-out runs confirm the leader, since a random effect of a run cannot be predicted
    from other runs: the leader explains why the runs differ, or another part of the error.
    """
    proposal = random_effect(_model(candidates, present, present))
    if proposal is None or proposal.evidence <= leader.evidence:
        return None
    campaign = candidates.campaign
    if len(campaign.prepared) < campaign.settings.held_out.min_units:
        return proposal
    confirmed = candidates.confirmation(present, leader.effect).units_confirm(candidates.level)
    return None if confirmed else proposal


def re_estimated_motion(candidates: Candidates, present: Names) -> Update | None:
    """Estimate the errors of the motion again; None if they are not accepted."""
    proposal = _errors_of_motion(candidates, present)
    if proposal is None or not is_accepted(proposal, _model(candidates, present, present)):
        return None
    return Update(proposal.campaign, proposal.problem.effects, proposal.solution)


def _effect_instead_of_errors(candidates: Candidates, present: Names) -> Proposal | None:
    """Propose the effect that best explains what is attributed to errors of the motion.

    A lag of the sensor, play or compliance delays the force. With a delay corrected, or with large
    errors of the acceleration, little of their influence remains. The effect that fits best without
    these is proposed with errors estimated again. None if the errors are small without a delay, if
    no residual structure remains with a delay of at most one sampling interval, or if the effect
    leaves a part of the delay and may describe errors of the motion only.
    """
    fitted, campaign = candidates.fitted(present), candidates.campaign
    if INSTEAD_OF_ERRORS not in fitted.proposals:
        proposal, full = None, _model(candidates, present, present)
        rest, most = without_delay(present), full.policy.selection.max_effects
        names = set(candidates.addable(rest)) & DISTORTS_FORCE - {DELAY}
        largest_share = campaign.settings.motion.max_small_share
        large = corrected_delay_s(campaign) != 0.0 or campaign.motion_share > largest_share
        if (large and names and len(rest) < most) and (
            _delay_in_steps(campaign) > 1.0
            or find_residual_structure(full.problem, full.solution, full.policy)
        ):
            models = [_model(candidates, (*rest, name), present) for name in sorted(names)]
            proposal = errors_of_motion(min(models, key=_rms_without_correction))
        if proposal is not None and not _explains_delay(proposal, campaign):
            samples, added = proposal.campaign.samples, set(proposal.problem.effects) - set(rest)
            rms, rms_without = proposal.solution.rms, full.solution.rms
            if may_describe_motion_errors(candidates, added, rms, rms_without, samples):
                proposal = None
        fitted.proposals[INSTEAD_OF_ERRORS] = proposal
    return fitted.proposals[INSTEAD_OF_ERRORS]


def _delay_in_steps(campaign: Campaign) -> float:
    """Size of the corrected delay common to all runs, in units of the longest sampling interval."""
    return abs(corrected_delay_s(campaign)) / max(campaign.samples.steps_s)


def _explains_delay(proposal: Proposal, campaign: Campaign) -> bool:
    """Whether the effect explains all of a corrected delay longer than one sampling interval.

    A smaller delay in the other direction compensates for a wrong shape of the effect.
    """
    before_s, after_s = corrected_delay_s(campaign), corrected_delay_s(proposal.campaign)
    return _delay_in_steps(campaign) > 1.0 and -1.0 < after_s / before_s <= 0.0


def _rms_without_correction(model: Model) -> float:
    """RMS of an ordinary fit of the model, without the correction of a common delay, N."""
    return fit_without_motion_corrections(model.problem, model.solution)[1].rms


def _errors_of_motion(candidates: Candidates, present: Names) -> Proposal | None:
    """Estimate the errors of the motion, once for each set of effects.

    The effect `time_delay` is omitted, since a common delay is estimated with the errors.
    """
    fitted = candidates.fitted(present)
    if MOTION not in fitted.proposals and candidates.campaign.rig.bearing is None:
        model = _model(candidates, without_delay(present), present)
        fitted.proposals[MOTION] = errors_of_motion(model)
    return fitted.proposals.get(MOTION)


def _model(candidates: Candidates, effects: Names, present: Names) -> Model:
    """Input of the term estimators: the fit of `effects`, compared with that of `present`."""
    return Model(
        candidates.fitted(effects).problem,
        candidates.converge(effects),
        candidates.fitted(present).problem,
        candidates.converge(present),
        candidates.policy,
        candidates.price(1),
    )
