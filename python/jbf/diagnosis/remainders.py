"""Reports of a selection: residual structure, and candidates that were not confirmed."""

from __future__ import annotations

from dataclasses import replace

from jbf.arrays import Names
from jbf.diagnosis.candidates import Candidates
from jbf.diagnosis.evidence import evidence_on_common_samples
from jbf.diagnosis.ledger import Remainder
from jbf.diagnosis.residual_structure import find_residual_structure
from jbf.diagnosis.selection import OF_SMOOTHING, Round
from jbf.estimation.samples import common_samples
from jbf.models.delayed_reading import DELAY


def remainder_of(candidates: Candidates, present: Names) -> tuple[Remainder, ...]:
    """Residual structure of the model with the present effects."""
    problem, solution = candidates.fitted(present).problem, candidates.converge(present)
    return find_residual_structure(problem, solution, candidates.policy)


def remainders_of_selection(
    candidates: Candidates, present: Names, trial_round: Round
) -> tuple[Remainder, ...]:
    """Report a leading effect beyond the limit on their number, or an unconfirmed candidate."""
    most = candidates.policy.selection.max_effects
    if trial_round.leader is not None and len(present) >= most:
        return (_effect_limit_reached(candidates, present, trial_round.leader),)
    return _unconfirmed_candidate(candidates, present, trial_round)


def _effect_limit_reached(candidates: Candidates, present: Names, leader: str) -> Remainder:
    """Report that the largest number of effects is reached although `leader` would be added."""
    base, richer = candidates.converge(present), candidates.converge((*present, leader))
    unit = candidates.campaign.rig.quantities.force
    where = (
        f"effect limit ({len(present)}) reached; {leader} would reduce the RMS from "
        f"{base.rms:.3g} to {richer.rms:.3g} {unit}"
    )
    return Remainder("effects", where, max(1.0 - (richer.rms / base.rms) ** 2, 0.0))


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
