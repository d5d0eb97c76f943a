"""Exclusion of the initial-state transient at the start of a run.

The samples still depend on the unknown initial state (`initial_state`) and do not identify the
friction law. They are excluded for every model of the campaign.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
import numpy.typing as npt

from jbf.estimation.approach import approach
from jbf.estimation.campaign import Campaign
from jbf.estimation.film_gaps import samples_affected_by_gaps
from jbf.estimation.film_rate import check_film
from jbf.estimation.initial_state import has_unknown_start, memories, remembering
from jbf.estimation.noise_floor import noise_floor
from jbf.estimation.problem import Problem
from jbf.estimation.samples import Samples
from jbf.estimation.solution import Solution
from jbf.models.catalogue import find_effect, find_law
from jbf.models.vocabulary import Clock
from jbf.records.findings.finding import Finding

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

RANKING_EVALUATIONS = 8
"""Evaluations of a fit that is accurate enough to estimate the rate of the film.

It limits the effort only.
"""


def unsettled(problem: Problem, values: Array, noise_rms: float) -> list[Mask]:
    """Mask of the samples at which a run still remembers its initial state, one a run.

    Parameters
    ----------
    values
        Parameters of a model that fits roughly.
    noise_rms
        Noise on the friction, N.
    """
    prepared, settings = problem.campaign.prepared, problem.campaign.settings.transient
    found = [np.zeros(len(p.run), dtype=bool) for p in prepared]
    for memory in memories(problem.law, problem.effects, settings):
        more = remembering(problem.chain, values, prepared, memory, noise_rms, settings)
        found = [before | mask for before, mask in zip(found, more, strict=True)]
    return found


def settled_campaign(campaign: Campaign, law: str, clock: Clock) -> Campaign:
    """Return the campaign without the initial-state transients, estimated with the bare law.

    Raises
    ------
    InputError
        A film is too fast for these records.
    """
    if not memories(law, ()):
        return campaign
    check_film(campaign, law, clock)
    problem = Problem(campaign, law, clock, ())
    near = approach(problem, [{}], RANKING_EVALUATIONS)
    return _settled(problem, near.values, near.residuals)


def settled_again(problem: Problem, solution: Solution) -> Campaign | None:
    """Return the campaign without the initial-state transients of a model with effects.

    This applies if the effects change the film or have an initial state of their own. The result is
    None if no significant number of further samples is excluded. A law that lacks an effect, such
    as the load, fits badly, and so gives a wrong duration of the film's memory.
    """
    pages = [find_effect(name) for name in problem.effects]
    lasting = [page.name for page in pages if page.stage == "film" or page.unknown_start]
    if not lasting or not memories(problem.law, lasting):
        return None
    campaign = problem.campaign
    less = Problem(campaign, problem.law, problem.clock, lasting)
    known = dict(zip(problem.names, solution.values.tolist(), strict=True))
    values = np.array([known[name] for name in less.names])
    found = _settled(less, values, solution.residuals)
    gone = campaign.samples.count - found.samples.count
    least = campaign.settings.transient.min_new_share
    return found if gone > least * campaign.samples.count else None


def _settled(problem: Problem, values: Array, residuals: Sequence[Array]) -> Campaign:
    """Return the campaign without the samples at which a model remembers unrecorded states."""
    campaign = problem.campaign
    noise_rms = noise_floor(campaign.prepared, campaign.samples)
    masks = unsettled(problem, values, noise_rms)
    least_n = campaign.settings.transient.max_difference * noise_rms
    behind = samples_affected_by_gaps(problem, values, least_n)
    if not any(m.any() for m in (*masks, *behind)):
        return campaign
    kept = campaign.without(masks).without(behind)
    what = _what(problem.law, problem.effects)
    return kept.with_findings(_findings(campaign, residuals, masks, kept.samples, what))


def _what(law: str, effects: Iterable[str]) -> str:
    """Text for the state that differed from that of the model when a run began."""
    page = find_law(law)
    cell = has_unknown_start(effects)
    if page.has_film:
        return "film, or the cell in its play, was not settled" if cell else "film was not settled"
    if page.has_bristle:
        return "contact was bent another way"
    return "contact was not settled" if page.has_memory else "cell was elsewhere in its play"


def _findings(
    campaign: Campaign, residuals: Sequence[Array], masks: list[Mask], kept: Samples, what: str
) -> list[Finding]:
    """Findings for the runs whose start differs from that of a rested film or the first motion."""
    found = []
    whole = zip(campaign.prepared, residuals, masks, campaign.samples.counted, strict=True)
    usual = kept.rms(residuals)
    for p, r, mask, counted in whole:
        begun = mask & counted
        if not begun.any():
            continue
        size = float(np.sqrt(np.mean(r[begun] ** 2)))
        if size < campaign.settings.transient.min_reported_ratio * usual:
            continue
        span = float(p.run.time_s[mask][-1] - p.run.time_s[mask][0])
        words = f"the {what} when the run began: {span:.2g} s, off by {size:.2g} N"
        found.append(
            Finding("unsettled_start", "friction_n", p.run.name, span, "s", "set aside", words)
        )
    return found
