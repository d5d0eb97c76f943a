"""Exclusion of samples that depend on an unrecorded state of the model.

A film, a contact or a load cell with backlash starts a run in an unknown state
(`uncertain_samples`). A film also depends on motion in a gap of the record. These samples do not
identify the friction law and are excluded for every model of the campaign. An InputError is raised
for a film that is too fast for the sampling rate of the records.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from jbf import _core
from jbf.arrays import Array, Mask
from jbf.errors import InputError
from jbf.estimation.approach import approach
from jbf.estimation.campaign import Campaign
from jbf.estimation.noise_floor import noise_floor
from jbf.estimation.prepared import Prepared
from jbf.estimation.problem import Problem
from jbf.estimation.samples import Samples
from jbf.estimation.solution import Solution
from jbf.estimation.uncertain_samples import initial_memories
from jbf.models.catalogue import find_effect, find_law
from jbf.models.chain import core_motion
from jbf.models.driven import Driven
from jbf.models.vocabulary import Clock
from jbf.records.findings.finding import Finding

EDGE = 1e-3
"""Fraction of a gap within which a simulated motion changes its speed."""
UNSETTLED = "was not at its initial state"
"""Clause on a film, contact or load cell whose initial state is unknown."""
DEFLECTED = "contact was deflected differently"
"""Clause on an elastic contact whose initial state is unknown."""
STATES = {
    "presliding": DEFLECTED,
    "dwell_stiction": "contact had rested for an unknown time",
    "sensor_hysteresis": f"load cell's hysteresis {UNSETTLED}",
}
"""Clause on the unknown initial state of an effect, by name."""
RANKING_EVALUATIONS = 8
"""Evaluations of a fit that is accurate enough to estimate the rate of the film."""


def check_film_rate(
    campaign: Campaign, law: str, clock: Clock, seed: Mapping[str, float] | None = None
) -> None:
    """Raise an InputError if the film of a law is too fast for the records at every start value.

    `seed` has starting values by name; the other parameters have those of the catalogue.
    """
    if not find_law(law).has_film:
        return
    problem = Problem(campaign, law, clock, ())
    seeded = {name: value for name, value in (seed or {}).items() if name in problem.names}
    rate = min(
        problem.chain.film_rate_1_s(start, campaign.motions) for start in problem.starts(seeded)
    )
    seconds = math.fsum(p.run.duration_s for p in campaign.prepared)
    steps = min(rate, _core.FASTEST_FILM_1_S) * seconds
    samples = sum(len(p.friction) for p in campaign.prepared)
    settings = campaign.settings.film
    if steps <= max(settings.max_steps * samples, settings.any_steps):
        return
    interval_s = float(np.median([p.step_s for p in campaign.prepared]))
    first = campaign.prepared[0].run
    raise InputError(
        file=first.path or first.name,
        column="time_s",
        problem=f"the film of the law {law} responds within {1.0 / rate:.1g} s, but "
        f"the sampling interval is {interval_s:.2g} s: it is not identifiable",
        remedy="check the unit of time, the bearing and the load, or use a law without a "
        "film, such as stribeck",
    )


def samples_affected_by_gaps(problem: Problem, values: Array, least_n: float) -> list[Mask]:
    """Mask of the samples at which a film still depends on motion in a gap, one per run.

    The parameter values are those of an approximate fit. A difference of the friction of `least_n`,
    N, is negligible.

    Notes
    -----
    The model interpolates the motion linearly over missing rows. If the shaft reversed or started
    in the gap, the simulated film state is wrong for some time after the gap. Two simulations bound
    this duration: in one, the speed changes at the end of the gap; in the other, at its beginning.
    """
    prepared = problem.campaign.prepared
    affected = [np.zeros(len(p.run), dtype=bool) for p in prepared]
    if not find_law(problem.law).has_film:
        return affected
    gap_steps = problem.campaign.settings.film.gap_steps
    gaps = [_gaps(p, gap_steps) for p in prepared]
    with_gaps = [i for i, indices in enumerate(gaps) if len(indices)]
    interpolated = problem.chain.predict(values, [prepared[i].core for i in with_gaps])
    for at_end in (False, True):
        motions = [_through(prepared[i], gaps[i], at_end=at_end) for i in with_gaps]
        predictions = problem.chain.predict(values, motions)
        for i, usual, changed in zip(with_gaps, interpolated, predictions, strict=True):
            affected[i] |= np.abs(changed - usual) > least_n
    return affected


def _gaps(p: Prepared, gap_steps: float) -> npt.NDArray[np.intp]:
    """Indices of the last sample before each gap of a run."""
    return np.flatnonzero(np.diff(p.run.time_s) > gap_steps * p.step_s)


def _through(p: Prepared, gaps: npt.NDArray[np.intp], *, at_end: bool) -> Driven:
    """Motion of a run whose speed changes at the end of each gap (`at_end`) or at its beginning."""
    time = p.run.time_s
    length = time[gaps + 1] - time[gaps]
    new = time[gaps + 1] - EDGE * length if at_end else time[gaps] + EDGE * length
    speed = p.motion.velocity[gaps if at_end else gaps + 1]
    instants = np.sort(np.concatenate([time, new]))
    motion = p.motion.at(time, instants)
    velocity, acceleration = motion.velocity.copy(), motion.acceleration.copy()
    index = np.searchsorted(instants, new)
    velocity[index], acceleration[index] = speed, 0.0
    motion = replace(motion, velocity=velocity, acceleration=acceleration)
    run = p.run.at(instants, np.interp(instants, time, p.friction))
    return Driven(core_motion(p.rig, run, motion).motion, np.searchsorted(instants, time))


def without_transients(campaign: Campaign, law: str, clock: Clock) -> Campaign:
    """Return the campaign without the initial-state transients, estimated with the base law.

    Raises
    ------
    InputError
        A film is too fast for these records.
    """
    if not initial_memories(law, ()):
        return campaign
    check_film_rate(campaign, law, clock)
    problem = Problem(campaign, law, clock, ())
    near = approach(problem, [[{}]], RANKING_EVALUATIONS)
    return _without_unrecorded(problem, near.values, near.residuals)


def without_further_transients(problem: Problem, solution: Solution) -> Campaign | None:
    """Return the campaign without the initial-state transients of a fitted model.

    Effects may change the film or have an initial state. The base law then gives a wrong duration
    of the transient, and more samples must be excluded. That of a bristle also depends on a delay
    of the force. The result is None if no significant number of further samples is excluded.
    """
    pages = [find_effect(name) for name in problem.effects]
    lasting = [
        page.name
        for page in pages
        if page.stage == "film" or page.unknown_start or page.erased_by_sliding
    ]
    if not (lasting or find_law(problem.law).has_bristle):
        return None
    if not initial_memories(problem.law, lasting):
        return None
    campaign = problem.campaign
    nested = Problem(campaign, problem.law, problem.clock, lasting)
    values_by_name = problem.values_by_name(solution.values)
    values = np.array([values_by_name[name] for name in nested.names])
    reduced = _without_unrecorded(nested, values, solution.residuals)
    excluded = campaign.samples.count - reduced.samples.count
    least = campaign.settings.transient.min_new_share
    return reduced if excluded > least * campaign.samples.count else None


def _without_unrecorded(problem: Problem, values: Array, residuals: Sequence[Array]) -> Campaign:
    """Return the campaign without the samples that depend on unrecorded states of a model."""
    campaign = problem.campaign
    noise_rms = noise_floor(campaign.prepared, campaign.samples)
    masks = problem.transient_samples(values, noise_rms)
    least_n = campaign.settings.transient.max_difference * noise_rms
    after_gaps = samples_affected_by_gaps(problem, values, least_n)
    if not any(m.any() for m in (*masks, *after_gaps)):
        return campaign
    kept = campaign.without(masks).without(after_gaps)
    state = _state(problem.law, problem.effects)
    return kept.with_findings(_findings(campaign, residuals, masks, kept.samples, state))


def _state(law: str, effects: Iterable[str]) -> str:
    """Clause on what is unknown about the initial state of a law with effects."""
    page = find_law(law)
    states = []
    if page.has_film:
        states.append(f"film {UNSETTLED}")
    elif page.has_memory:
        states.append(DEFLECTED if page.has_bristle else f"contact {UNSETTLED}")
    states += [STATES[name] for name in effects if name in STATES]
    return " or the ".join(dict.fromkeys(states))


def _findings(
    campaign: Campaign, residuals: Sequence[Array], masks: list[Mask], kept: Samples, state: str
) -> list[Finding]:
    """Findings for the runs whose start differs from that of a rested film or the first motion."""
    findings = []
    usual_rms = kept.rms(residuals)
    for p, r, mask, counted in zip(
        campaign.prepared, residuals, masks, campaign.samples.counted, strict=True
    ):
        transient = mask & counted
        if not transient.any():
            continue
        size = float(np.sqrt(np.mean(r[transient] ** 2)))
        if size < campaign.settings.transient.min_reported_ratio * usual_rms:
            continue
        span = float(p.run.time_s[mask][-1] - p.run.time_s[mask][0])
        words = (
            f"the {state} at the start of the run: residual {size:.2g} "
            f"{p.run.quantities.force} RMS for {span:.2g} s"
        )
        findings.append(
            Finding("unsettled_start", "friction_n", p.run.name, span, "s", "excluded", words)
        )
    return findings
