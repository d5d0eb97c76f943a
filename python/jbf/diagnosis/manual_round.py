"""Manual round: a model with the effects chosen by the user, and the gain of each other effect.

`diagnose` decides automatically; this function leaves the choice to the user.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from jbf.comparison.comparison import Comparison, compare_prepared
from jbf.diagnosis.candidates import Candidates, Progress
from jbf.diagnosis.ledger import Step
from jbf.diagnosis.policy import DEFAULT
from jbf.diagnosis.power import Power, power
from jbf.diagnosis.rounds import step
from jbf.diagnosis.selection import try_candidates
from jbf.errors import Stopped, Unfinished
from jbf.estimation.campaign import Campaign
from jbf.estimation.fit import Fit, fit
from jbf.estimation.transients import without_further_transients, without_transients
from jbf.models.chain import default_law
from jbf.models.vocabulary import Clock
from jbf.records.rig import Rig
from jbf.records.run import Run
from jbf.threads import one_blas_thread


@dataclass(frozen=True)
class ManualRound:
    """Result of a manual round.

    Attributes
    ----------
    fit
        The fit of the model.
    step
        Step of the ledger for this model, with the candidates tried.
    comparison
        Comparison of the model with the records.
    power
        Detection limit of each candidate in these runs, in addition to the model.
    """

    fit: Fit
    step: Step
    comparison: Comparison
    power: tuple[Power, ...]


@one_blas_thread
def manual_round(
    rig: Rig,
    runs: Sequence[Run],
    effects: Sequence[str] = (),
    *,
    law: str | None = None,
    clock: Clock = "journal",
    progress: Progress | None = None,
    fitted_as: Callable[[Fit, Comparison], None] | None = None,
) -> ManualRound:
    """Fit a law with the given effects, and test each other effect in addition to them.

    `law` is by default `journal` for a bearing, otherwise `coulomb`. `clock` and `progress`
    are those of `diagnose`. `fitted_as` is called with the fit and its comparison before any
    candidate is tried.

    Raises
    ------
    InputError
        An unknown name, a missing column, or runs without motion.
    Stopped
        The computation was interrupted; the exception holds the fit, or the best solution so far.
    """
    law = default_law(rig) if law is None else law
    if progress is not None:
        progress("fitting", 0, 0)
    # Use the model of `fit`, so that the user can reproduce the step.
    fitted = fit(rig, runs, effects, law=law, clock=clock)
    chosen, campaign = fitted.model.effects, Campaign.prepare(rig, runs, DEFAULT.estimation)
    comparison = compare_prepared(fitted.model, campaign)
    if fitted_as is not None:
        fitted_as(fitted, comparison)
    settled = without_transients(campaign, law, clock)
    candidates = Candidates(settled, law, clock, DEFAULT, progress)
    try:
        further = without_further_transients(
            candidates.fitted(chosen).problem, candidates.converge(chosen)
        )
        if further is not None:
            candidates = candidates.with_campaign(further)
        trials = try_candidates(candidates, chosen).trials
        if progress is not None:
            progress("computing detection limits", 0, 0)
        strengths = power(candidates, chosen)
    except KeyboardInterrupt:
        raise Stopped(fitted) from None
    except Unfinished as stop:
        raise Unfinished(steps=stop.steps, fit=fitted, file=campaign.named) from None
    ledger = replace(
        step(candidates, chosen, trials), rms=comparison.rms, noise_rms=comparison.noise_rms
    )
    return ManualRound(fitted, ledger, comparison, strengths)
