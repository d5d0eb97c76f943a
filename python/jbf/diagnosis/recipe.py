"""Main procedure of a diagnosis: rounds of selection, residual structure, and verdict."""

from __future__ import annotations

import time
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace

from jbf.arrays import Names
from jbf.comparison.comparison import Comparison, compare_prepared
from jbf.diagnosis.budget import (
    ALTERNATIVES,
    NEXT_EXPERIMENT,
    POWER,
    SIMPLER_LAWS,
    OptionalParts,
    sufficient_time_s,
)
from jbf.diagnosis.candidates import Candidates, Progress
from jbf.diagnosis.compared_diagnoses import may_predict_better, replaces
from jbf.diagnosis.experiment_design.excitations import Limits
from jbf.diagnosis.experiment_design.next_run import (
    Experiment,
    propose,
    propose_detection_run,
    undetectable_effects,
)
from jbf.diagnosis.fit_state import MOTION, Reached
from jbf.diagnosis.ledger import SEARCH, Remainder, with_final_outcomes
from jbf.diagnosis.policy import DEFAULT, Policy
from jbf.diagnosis.power import Power, power
from jbf.diagnosis.remainders import remainder_of
from jbf.diagnosis.result import Diagnosis
from jbf.diagnosis.review import (
    machine_of,
    start_model,
    weights,
    with_errors_of_motion,
)
from jbf.diagnosis.rounds import select, step
from jbf.diagnosis.verdict import (
    best_predicting,
    confounders,
    effects_without_estimate,
    formula_corrections,
    limitations,
    verdict,
)
from jbf.diagnosis.which_law import (
    SIMPLEST,
    LawTried,
    followed,
    laws_to_diagnose,
    simpler_law,
    simplest_law_suffices,
    which_law,
)
from jbf.errors import Stopped, Unfinished
from jbf.estimation.campaign import Campaign
from jbf.estimation.fit import finish
from jbf.estimation.transients import without_transients
from jbf.estimation.work import TimeLimit
from jbf.models.catalogue import find_clock
from jbf.models.chain import check_rig, default_law_of_diagnosis
from jbf.models.vocabulary import AUTO, Clock
from jbf.records.arguments import check_callable, list_of_runs, of_kind
from jbf.records.rig import Rig
from jbf.records.run import Run
from jbf.threads import one_blas_thread


@one_blas_thread
def diagnose(
    rig: Rig,
    runs: Sequence[Run],
    *,
    law: str | None = None,
    clock: Clock = "journal",
    limits: Limits | None = None,
    policy: Policy = DEFAULT,
    progress: Progress | None = None,
    time_limit_s: float | TimeLimit | None = None,
) -> Diagnosis:
    """Find the effects of the catalogue that are missing from a law.

    The effect with the largest evidence is added to the model, and the search is repeated.

    Parameters
    ----------
    rig
        Bearing, lubricant and load; `Rig()` is sufficient for a law in newtons.
    runs
        Recorded runs with friction; several different motions help to distinguish effects.
    law, clock
        Base law, and the definition of the time constant of its film (`journal` or `thesis`). The
        law `auto` selects, among the laws that the rig allows, the simplest of those with the
        smallest held-out errors. The default is `journal` for a bearing, otherwise `auto`.
    limits
        Limits of the rig for the next experiment; by default those of the runs.
    policy
        Thresholds and settings that determine the verdict.
    progress
        Called with a message, the number of finished trials of the round and the total number.
    time_limit_s
        Duration after which the diagnosis ends with the best model so far, s; None for no limit.
        `not_tried` lists the tests omitted. Such a result may differ between machines.

    Returns
    -------
    Diagnosis
        Verdict, effects, ledger, alternatives, residual structure, and the final model.

    Raises
    ------
    InputError
        A run has no friction record, or no motion.
    Stopped
        The diagnosis was interrupted; the exception holds the model at the start of the last round.
    Unfinished
        The computing budget or the time limit was exceeded before the first round of tests ended;
        the exception holds the same model.

    Notes
    -----
    Each candidate is fitted with the present model. It is accepted if twice its log-likelihood gain
    exceeds a threshold, and if the held-out runs confirm it. The threshold limits the family-wise
    false-alarm rate and includes an artefact margin (docs/diagnosis.md).

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(0.0, 4.0, 0.02)
    >>> v = 0.1 * np.sin(3.0 * t)
    >>> noise = 0.2 * np.random.default_rng(0).standard_normal(len(t))
    >>> run = jbf.Run.from_arrays(t, v, 5.0 * np.sign(v) + 20.0 * v + noise)
    >>> diagnosis = jbf.diagnose(jbf.Rig(), [run], law="coulomb")
    >>> diagnosis.verdict, diagnosis.effects
    ('adequate', ())
    """
    law = default_law_of_diagnosis(rig) if law is None else law
    reached, time_limit = Reached(), TimeLimit.of(time_limit_s)
    try:
        return _diagnose(rig, runs, law, clock, limits, policy, progress, time_limit, reached)
    except KeyboardInterrupt:
        fitted = reached.fit()
        if fitted is None:
            raise
        raise Stopped(fitted) from None
    except Unfinished as stop:
        if not reached.runs:
            raise
        sufficient_s = None
        if time_limit is not None:
            sufficient_s = sufficient_time_s(reached, law, clock, time_limit)
        first = reached.runs[0]
        named = str(first.path or first.name)
        raise stop.with_fit(reached.fit(), named, sufficient_s) from None


def _diagnose(
    rig: Rig,
    runs: Sequence[Run],
    law: str,
    clock: Clock,
    limits: Limits | None,
    policy: Policy,
    progress: Progress | None,
    time_limit: TimeLimit | None,
    reached: Reached,
) -> Diagnosis:
    """Implement `diagnose`; `reached` is updated after each round."""
    begun = time.monotonic()
    if law != AUTO:
        check_rig(rig, law)
    clock = find_clock(clock)
    check_callable(progress, "progress")
    if limits is not None:
        of_kind(limits, Limits, "limits", "give a jbf.Limits, or None")
    reached.runs = list_of_runs(runs)
    recorded = Campaign.prepare(rig, reached.runs, policy.estimation, time_limit)
    reached.campaign = recorded
    laws: tuple[LawTried, ...] = ()
    no_law: dict[str, str] = {}
    names: tuple[str, ...] = (law,)
    margin = policy.held_out.no_worse_ratio
    prepared: dict[str, Candidates] = {}
    if law == AUTO:
        # All laws are compared with the same errors of the motion.
        compared = recorded
        if rig.bearing is None:
            with suppress(Unfinished):
                simplest_law = _candidates(recorded, SIMPLEST, clock, policy, progress, reached)
                prepared[SIMPLEST], compared = simplest_law, simplest_law.campaign
        laws, no_law = which_law(compared, clock, policy, progress)
        names = laws_to_diagnose(laws)
        margin = max(margin, (1.0 + policy.least_effect_share(compared.motion_share)) ** 0.5)
    best: Diagnosis | None = None
    queue, evaluated, diagnosed = list(names), {t.law for t in laws}, set[str]()
    while queue:
        name = queue.pop(0)
        diagnosed.add(name)
        # The simplest law follows another one only if it predicts as well with the same effects.
        simplest = best is not None and name == SIMPLEST
        if not (best is None or simplest or may_predict_better(name, best, laws, margin)):
            continue
        try:
            answer, simplest_suffices = _with_law(
                prepared.pop(name)
                if name in prepared
                else _candidates(recorded, name, clock, policy, progress, reached),
                recorded,
                limits,
                given=law != AUTO,
            )
        except Unfinished as stop:
            if best is None and not queue:
                raise
            no_law[f"law {name}"] = stop.reason
            continue
        except KeyboardInterrupt:
            if best is None:
                raise
            raise Stopped(best.fit) from None
        if best is None or replaces(answer, best, recorded, margin, simplest=simplest):
            best = answer
            if simplest_suffices and SIMPLEST in evaluated - diagnosed:
                queue.insert(0, SIMPLEST)
    assert best is not None
    unfit = followed(recorded, clock)[1] if no_law else {}
    first = [t for t in laws if t.law == best.model.law]
    return replace(
        best,
        laws=(*first, *(t for t in laws if t not in first)),
        not_tried=no_law | best.not_tried,
        unfinished=(*(name for name in no_law if name not in unfit), *best.unfinished),
        elapsed_s=time.monotonic() - begun,
    )


def _candidates(
    recorded: Campaign,
    law: str,
    clock: Clock,
    policy: Policy,
    progress: Progress | None,
    reached: Reached,
) -> Candidates:
    """Candidates of a law without its initial-state transients, with errors of the motion."""
    campaign = replace(recorded, work=recorded.work.part(1.0))
    campaign = without_transients(campaign, law, clock)
    candidates = Candidates(campaign, law, clock, policy, progress)
    candidates.reached = reached
    return with_errors_of_motion(candidates)


def _with_law(
    candidates: Candidates, recorded: Campaign, limits: Limits | None, *, given: bool
) -> tuple[Diagnosis, bool]:
    """Diagnose the runs with one law; if the user chose it (`given`), also find a simpler one.

    Also returns whether the simplest law with the same effects predicts held-out runs as well;
    False for a given law.
    """
    begun = time.monotonic()
    clock, policy = candidates.clock, candidates.policy
    if candidates.campaign.samples.motion is not None:
        # Errors estimated with all machine terms are not estimated again with the needed ones.
        candidates.fitted(start_model(candidates)).proposals[MOTION] = None
    selected = select(candidates)
    candidates, campaign = selected.candidates, selected.candidates.campaign
    present, steps, of_selection = selected.present, selected.steps, selected.remainders
    # Effects that are not named, and the final model: with or without them, whichever predicts
    # better.
    with campaign.work.untimed():
        before = _before(candidates)
        remains = (*remainder_of(candidates, present), *of_selection)
        of_formulas = formula_corrections(candidates, present)
        of_structure = confounders(candidates, present, remains) if remains else ()
        doubted = tuple(dict.fromkeys((*of_formulas, *of_structure)))
        machine = machine_of(candidates.campaign.rig, present)
        named = tuple(name for name in present if name not in doubted)
        if doubted and not remainder_of(candidates, named):
            # The model without these effects has no residual structure: remove them.
            present, remains = named, of_selection
        missing = tuple(name for name in named if name not in machine)
        kept = best_predicting(candidates, present, named)
        final = candidates.polish(kept)
        if kept != steps[-1].effects:
            steps.append(step(candidates, kept, ()))
        steps[-1] = replace(steps[-1], rms=final.rms)
        # The residual contains the noise, and limits its estimate from the records.
        steps = [replace(s, noise_rms=min(s.noise_rms, final.rms)) for s in steps]
        fit = finish(candidates.fitted(kept).problem, final)
    uncertain = effects_without_estimate(fit.parameters, missing, policy)
    doubted, missing = (*doubted, *uncertain), tuple(e for e in missing if e not in uncertain)
    steps = with_final_outcomes(steps, present, doubted)
    # Alternatives to the named effects and the machine terms, and the verdict.
    optional = OptionalParts(candidates.tell)
    all_weights: dict[str, dict[str, float]] = optional.of(
        ALTERNATIVES, lambda: weights(candidates, named), {}
    )
    if missing and not selected.not_tried and ALTERNATIVES in optional.omitted:
        where = f"{optional.omitted[ALTERNATIVES]}; alternatives to the effects were not tested"
        remains = (*remains, Remainder(SEARCH, where, 0.0))
    posterior = {
        name: of_name
        for name, of_name in all_weights.items()
        if name in missing or (name in machine and len(of_name) > 1)
    }
    alternatives = {name: tuple(w)[1:] for name, w in posterior.items()}
    tied = {name: others for name, others in alternatives.items() if others and name in missing}
    answer = verdict(effects=len(missing), alternatives=len(tied), remains=bool(remains))
    # Detection limits, a simpler law and the next experiment.
    limits_of_runs: tuple[tuple[Power, ...], Names] = ((), ())
    if not remains:
        limits_of_runs = optional.of(POWER, lambda: _power(candidates, present), limits_of_runs)
    elif all(remainder.unfinished for remainder in remains):
        optional.omitted[POWER] = next(iter((selected.not_tried | optional.omitted).values()))
    strengths, undetectable = limits_of_runs
    simpler = None
    if given and (len(missing) > 1 or remains):
        simpler = optional.of(SIMPLER_LAWS, lambda: simpler_law(candidates, kept, clock), None)
    simplest_suffices = False
    if not given and set(kept) - set(machine):
        simplest_suffices = optional.of(
            SIMPLER_LAWS, lambda: simplest_law_suffices(candidates, kept, clock), False
        )
    proposal: Experiment | str | None = None
    if answer == "adequate" and undetectable:
        proposal = optional.of(
            NEXT_EXPERIMENT,
            lambda: propose_detection_run(candidates, present, undetectable, limits),
            None,
        )
    if tied:
        rivals = [_rivals(named, name, others) for name, others in tied.items()]
        proposal = optional.of(NEXT_EXPERIMENT, lambda: propose(candidates, rivals, limits), None)
    diagnosis = Diagnosis(
        verdict=answer,
        effects=missing,
        machine=machine_of(candidates.campaign.rig, kept),
        alternatives=alternatives,
        weights=posterior,
        steps=tuple(steps),
        failures=before.failures,
        residual_structure=remains,
        next_experiment=proposal.words if isinstance(proposal, Experiment) else proposal,
        experiment=proposal if isinstance(proposal, Experiment) else None,
        fit=fit,
        before=before,
        after=compare_prepared(fit.model, campaign),
        elapsed_s=time.monotonic() - begun,
        level=candidates.level,
        not_tried=candidates.not_tried | selected.not_tried | optional.omitted,
        unfinished=(*selected.not_tried, *optional.omitted),
        not_detectable=undetectable,
        policy=policy,
        findings=candidates.campaign.findings,
        confounders=tuple(name for name in doubted if name in kept),
        simpler_law=simpler,
        power=strengths,
        limitations=limitations(recorded, fit.params, policy),
    )
    return diagnosis, simplest_suffices


def _power(candidates: Candidates, present: Names) -> tuple[tuple[Power, ...], Names]:
    """Power for each effect, and the effects that are not detectable in these runs."""
    strengths = power(candidates, present)
    return strengths, undetectable_effects(candidates, present, strengths)


def _before(candidates: Candidates) -> Comparison:
    """Compare the base law, including the machine terms, with the records."""
    base = start_model(candidates)
    bare = finish(candidates.fitted(base).problem, candidates.polish(base))
    return compare_prepared(bare.model, candidates.campaign)


def _rivals(present: Names, name: str, others: Names) -> list[Names]:
    """Models that fit equally well: the present one, and those with an effect replaced."""
    rest = tuple(e for e in present if e != name)
    return [present, *((*rest, other) for other in others)]
