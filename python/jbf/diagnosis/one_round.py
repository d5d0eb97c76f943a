"""One round by hand: a model with named effects, and what each other effect would bring.

Where `diagnose` decides, this leaves the choice to whoever looks on.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from jbf.comparison.comparison import Comparison, compare_prepared
from jbf.diagnosis.candidates import Candidates, Progress
from jbf.diagnosis.ledger import Step
from jbf.diagnosis.policy import DEFAULT, Policy
from jbf.diagnosis.power import Power, power
from jbf.diagnosis.rounds import step
from jbf.diagnosis.selection import try_candidates
from jbf.errors import Stopped, Unfinished
from jbf.estimation.campaign import Campaign
from jbf.estimation.fit import Fit, fit
from jbf.estimation.run_start import settled_again, settled_campaign
from jbf.models.vocabulary import Clock
from jbf.records.rig import Rig
from jbf.records.run import Run
from jbf.threads import one_blas_thread


@dataclass(frozen=True)
class OneRound:
    """A fit, its line of the ledger with the candidates tried beside it, where it fails, and how
    strong each of them must be for these runs to show it beside this model."""

    fit: Fit
    step: Step
    comparison: Comparison
    power: tuple[Power, ...]


@one_blas_thread
def one_round(
    rig: Rig,
    runs: Sequence[Run],
    effects: Sequence[str] = (),
    *,
    law: str = "journal",
    clock: Clock = "journal",
    policy: Policy = DEFAULT,
    progress: Progress | None = None,
    fitted_as: Callable[[Fit, Comparison], None] | None = None,
) -> OneRound:
    """Fit a law with named effects, and try every other effect beside them.

    Parameters
    ----------
    rig, runs
        What was recorded, and on what.
    effects
        Effects that the model is to have.
    law, clock
        The base law and its clock.
    policy
        The numbers by which a candidate is judged.
    progress
        Called with a message, and how many of how many candidates have been tried.
    fitted_as
        Called with the fit and where it fails, before any candidate is tried.

    Raises
    ------
    InputError
        An unknown name, a missing column, or runs in which nothing moves.
    Stopped
        It was interrupted; it has the fit, or the best so far.
    """
    if progress is not None:
        progress("fitting", 0, 0)
    # The model is that of `fit`, to the last digit: who repeats the step by hand gets the same.
    fitted = fit(rig, runs, effects, law=law, clock=clock)
    chosen, campaign = fitted.model.effects, Campaign.prepare(rig, runs)
    comparison = compare_prepared(fitted.model, campaign)
    if fitted_as is not None:
        fitted_as(fitted, comparison)
    candidates = Candidates(settled_campaign(campaign, law, clock), law, clock, policy, progress)
    try:
        settled = settled_again(candidates.fitted(chosen).problem, candidates.converge(chosen))
        if settled is not None:
            candidates = candidates.of(settled)
        trials = try_candidates(candidates, chosen).trials
        if progress is not None:
            progress("how strong each would have to be", 0, 0)
        strengths = power(candidates, chosen)
    except KeyboardInterrupt:
        raise Stopped(fitted) from None
    except Unfinished as stop:
        raise Unfinished(steps=stop.steps, fit=fitted, file=campaign.named) from None
    ledger = replace(
        step(candidates, chosen, trials), rms_n=comparison.rms_n, noise_n=comparison.noise_n
    )
    return OneRound(fitted, ledger, comparison, strengths)
